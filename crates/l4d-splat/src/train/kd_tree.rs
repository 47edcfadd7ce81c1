//! The nearest neighbours of points, by a k-d tree.
//!
//! Forty lines of own code: the libraries for this bring coroutines and a dozen further crates along.

use std::cmp::Ordering;

/// A balanced tree over points: the middle of every range splits it, the axes take turns.
pub(super) struct KdTree<'a> {
    points: &'a [[f32; 3]],
    order: Vec<u32>,
}

impl<'a> KdTree<'a> {
    pub(super) fn new(points: &'a [[f32; 3]]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        split(points, &mut order, 0);
        Self { points, order }
    }

    /// Squared distance and index of the `K` nearest points with an index other than `but`, nearest first; fewer than
    /// `K` points leave infinite distances.
    pub(super) fn nearest<const K: usize>(&self, to: [f32; 3], but: Option<u32>) -> [(f32, u32); K] {
        let mut found = [(f32::INFINITY, u32::MAX); K];
        self.search(&self.order, 0, to, but, &mut found);
        found
    }

    fn search<const K: usize>(
        &self,
        range: &[u32],
        axis: usize,
        to: [f32; 3],
        but: Option<u32>,
        found: &mut [(f32, u32); K],
    ) {
        let middle = range.len() / 2;
        let (below, [here, above @ ..]) = range.split_at(middle) else { return };
        let point = self.points[*here as usize];
        if but != Some(*here) {
            let entry = ((0..3).map(|axis| (point[axis] - to[axis]).powi(2)).sum::<f32>(), *here);
            if let Some(last) = found.last_mut().filter(|last| by_distance(&entry, last).is_lt()) {
                *last = entry;
                found.sort_unstable_by(by_distance);
            }
        }
        let offset = to[axis] - point[axis];
        let (near, far) = if offset < 0.0 { (below, above) } else { (above, below) };
        let next = (axis + 1) % 3;
        self.search(near, next, to, but, found);
        if found.last().is_some_and(|last| offset * offset <= last.0) {
            self.search(far, next, to, but, found);
        }
    }
}

/// Equal distances in the order of their indices.
fn by_distance(a: &(f32, u32), b: &(f32, u32)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

fn split(points: &[[f32; 3]], range: &mut [u32], axis: usize) {
    if range.len() < 2 {
        return;
    }
    let middle = range.len() / 2;
    let along =
        |a: &u32, b: &u32| points[*a as usize][axis].total_cmp(&points[*b as usize][axis]).then(a.cmp(b));
    let (below, _, above) = range.select_nth_unstable_by(middle, along);
    split(points, below, (axis + 1) % 3);
    split(points, above, (axis + 1) % 3);
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn neighbours_are_those_of_the_plain_search() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        // Coarse coordinates, so that many distances are equal.
        let points: Vec<[f32; 3]> =
            (0..300).map(|_| std::array::from_fn(|_| random.random_range(0..7) as f32)).collect();
        let tree = KdTree::new(&points);
        for (index, &point) in points.iter().enumerate() {
            let mut all: Vec<(f32, u32)> = (0..points.len() as u32)
                .filter(|&other| other != index as u32)
                .map(|other| {
                    let at = points[other as usize];
                    ((0..3).map(|axis| (at[axis] - point[axis]).powi(2)).sum(), other)
                })
                .collect();
            all.sort_unstable_by(by_distance);
            assert_eq!(tree.nearest::<3>(point, Some(index as u32)), all[..3], "{index}");
        }
    }

    #[test]
    fn too_few_points_leave_gaps() {
        assert_eq!(KdTree::new(&[]).nearest::<1>([0.0; 3], None), [(f32::INFINITY, u32::MAX)]);
        let one = [[1.0, 0.0, 0.0]];
        assert_eq!(KdTree::new(&one).nearest::<2>([0.0; 3], None)[0], (1.0, 0));
        assert!(KdTree::new(&one).nearest::<2>([0.0; 3], None)[1].0.is_infinite());
    }
}
