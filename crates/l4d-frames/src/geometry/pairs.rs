//! Which pairs of views are compared.

/// Ordered pairs of view indices: each view with its neighbours in the list (which is the order along the rig)
/// and with the held-out view, both ways. Grows linearly with the number of views.
pub fn view_pairs(view_count: usize, test_view: usize) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for view in 0..view_count {
        if view + 1 < view_count {
            pairs.extend([(view, view + 1), (view + 1, view)]);
        }
        if view != test_view {
            pairs.extend([(view, test_view), (test_view, view)]);
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

#[cfg(test)]
mod tests {
    use super::view_pairs;

    #[test]
    fn neighbours_and_the_held_out_view_both_ways() {
        assert_eq!(view_pairs(3, 0), [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)]);
        assert_eq!(view_pairs(4, 1), [(0, 1), (1, 0), (1, 2), (1, 3), (2, 1), (2, 3), (3, 1), (3, 2)]);
        assert!(view_pairs(1, 0).is_empty());
    }
}
