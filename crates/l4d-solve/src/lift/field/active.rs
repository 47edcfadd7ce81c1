//! Which Gaussians a picture needs.
//!
//! Those with no blend weight in it change neither its loss nor any derivative, so that leaving them out is exact;
//! leaving out those with the least weight as well is the bounded approximation of [`super::FieldSettings::left_out`].

/// Gaussians that show in a picture, ascending; `weights` holds the sum of each one's blend weights over its pixels.
/// Those that show least are left out until their weights add up to `left_out` of all.
pub(super) fn visible(weights: &[f32], left_out: f64) -> Vec<u32> {
    let mut rows: Vec<u32> = (0..weights.len() as u32).filter(|&row| weights[row as usize] > 0.0).collect();
    if left_out > 0.0 {
        let weight = |row: u32| weights[row as usize];
        rows.sort_unstable_by(|&a, &b| weight(a).total_cmp(&weight(b)).then(a.cmp(&b)));
        let budget = left_out * rows.iter().map(|&row| f64::from(weight(row))).sum::<f64>();
        let mut spent = 0.0;
        let dropped = rows.iter().take_while(|&&row| {
            spent += f64::from(weight(row));
            spent <= budget
        });
        let dropped = dropped.count();
        rows.drain(..dropped);
        rows.sort_unstable();
    }
    rows
}

/// Rows of one step without repetition, and where each Gaussian stands among them.
#[derive(Debug)]
pub(super) struct Rows {
    /// The Gaussians, in the order in which they were first asked for.
    pub(super) list: Vec<u32>,
    places: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Rows {
    pub(super) fn new(gaussians: usize) -> Self {
        Self { list: Vec::new(), places: vec![ABSENT; gaussians] }
    }

    pub(super) fn clear(&mut self) {
        for &row in &self.list {
            self.places[row as usize] = ABSENT;
        }
        self.list.clear();
    }

    /// Where a Gaussian stands; a new one is added.
    pub(super) fn place(&mut self, gaussian: u32) -> usize {
        let place = &mut self.places[gaussian as usize];
        if *place == ABSENT {
            *place = self.list.len() as u32;
            self.list.push(gaussian);
        }
        *place as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_allowance_only_the_invisible_are_left_out() {
        assert_eq!(visible(&[0.0, 3.0, 1e-9, 0.0, 2.0], 0.0), [1, 2, 4]);
    }

    #[test]
    fn what_is_left_out_weighs_no_more_than_allowed() {
        let weights = [1.0, 5.0, 2.0, 0.0, 2.0];
        assert_eq!(visible(&weights, 0.05), [0, 1, 2, 4]);
        assert_eq!(visible(&weights, 0.1), [1, 2, 4]);
        assert_eq!(visible(&weights, 0.3), [1, 4]);
        assert_eq!(visible(&weights, 0.5), [1]);
    }

    #[test]
    fn a_row_stands_once() {
        let mut rows = Rows::new(5);
        assert_eq!([3, 1, 3, 0].map(|row| rows.place(row)), [0, 1, 0, 2]);
        assert_eq!(rows.list, [3, 1, 0]);
        rows.clear();
        assert_eq!(rows.place(1), 0);
    }
}
