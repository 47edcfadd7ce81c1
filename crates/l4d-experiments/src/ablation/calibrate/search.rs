//! Bisection on the share of swapped views. Knows numbers alone.

/// Halvings of the interval that holds the share: 1/128 is left.
pub(super) const HALVINGS: usize = 7;

/// The search for one share.
#[derive(Debug)]
pub(super) struct Search {
    /// mIoU, percent.
    pub(super) target: f64,
    /// Shares between which it lies.
    low: f64,
    high: f64,
    /// To be tried.
    pub(super) next: f64,
    tried: Vec<(f64, f64)>,
}

impl Search {
    pub(super) fn new(target: f64) -> Self {
        Self { target, low: 0.0, high: 1.0, next: 0.0, tried: Vec::new() }
    }

    /// Fewer swaps where the result is worse than wanted, more where it is better. What is too bad without any swap
    /// stays at none.
    pub(super) fn hear(&mut self, miou: f64) {
        self.tried.push((self.next, miou));
        if miou <= self.target {
            self.high = self.next;
        } else {
            self.low = self.next;
        }
        self.next = (self.low + self.high) / 2.0;
    }

    /// Whether there is nothing left to try: the target lies beyond what can be had without any swap.
    pub(super) fn is_settled(&self) -> bool {
        self.high == 0.0
    }

    /// What came closest: share and mIoU. Of equals the first.
    pub(super) fn closest(&self) -> Option<(f64, f64)> {
        let off = |&(_, miou): &(f64, f64)| (miou - self.target).abs();
        self.tried.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hears what a response says until all halvings are done.
    fn searched(target: f64, response: impl Fn(f64) -> f64) -> Search {
        let mut search = Search::new(target);
        for _ in 0..=HALVINGS {
            search.hear(response(search.next));
        }
        search
    }

    #[test]
    fn the_share_is_found_where_the_response_meets_the_target() {
        let search = searched(60.0, |swap| 90.0 - 80.0 * swap);
        let (swap, miou) = search.closest().unwrap();
        assert!((swap - 0.375).abs() < 1e-12 && (miou - 60.0).abs() < 1e-9, "{search:?}");
        // A step: no share gives the target, the nearer side of it is taken.
        let step = searched(60.0, |swap| if swap < 0.3 { 65.0 } else { 20.0 });
        let (swap, miou) = step.closest().unwrap();
        assert!(swap < 0.3 && miou == 65.0, "{step:?}");
    }

    #[test]
    fn what_is_too_bad_without_errors_gets_none() {
        let search = searched(60.0, |swap| 50.0 - swap);
        assert_eq!(search.closest().unwrap().0, 0.0);
        assert!(search.tried.iter().all(|&(swap, _)| swap == 0.0));
    }

    #[test]
    fn what_never_gets_that_bad_comes_as_near_as_it_can() {
        let search = searched(10.0, |_| 80.0);
        // All are equally far off: the first, without errors, says the least.
        assert_eq!(search.closest().unwrap().0, 0.0);
        let falling = searched(10.0, |swap| 80.0 - swap);
        assert!(falling.closest().unwrap().0 > 0.98);
    }
}
