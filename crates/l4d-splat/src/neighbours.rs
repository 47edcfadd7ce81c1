//! The nearest neighbours of points in a space of any number of axes.
//!
//! Knows nothing of Gaussians. Boxes around branches give exact bounds, so that points which lie in few dimensions of
//! many (trajectories of Gaussians that stand still) are found as fast as in those few.

use std::cmp::Ordering;

use rayon::prelude::*;

/// Points in a leaf.
const LEAF: usize = 8;
/// Queries answered by one task.
const CHUNK: usize = 256;

/// A balanced tree over points.
pub struct Tree<'a> {
    points: &'a [f32],
    axes: usize,
    /// Indices of points; each branch owns a range.
    order: Vec<u32>,
    /// Lowest and highest corner of each branch, numbered as a heap.
    boxes: Vec<f32>,
}

impl<'a> Tree<'a> {
    /// A tree over points with `axes` coordinates each.
    pub fn new(points: &'a [f32], axes: usize) -> Self {
        let count = points.len() / axes.max(1);
        let mut tree = Self { points, axes, order: (0..count as u32).collect(), boxes: Vec::new() };
        let mut order = std::mem::take(&mut tree.order);
        tree.build(0, &mut order);
        tree.order = order;
        tree
    }

    fn build(&mut self, branch: usize, range: &mut [u32]) {
        let axes = self.axes;
        let start = branch * 2 * axes;
        if self.boxes.len() < start + 2 * axes {
            self.boxes.resize(start + 2 * axes, 0.0);
        }
        let mut widest = (f32::NEG_INFINITY, 0);
        for axis in 0..axes {
            let along = range.iter().map(|&index| self.points[index as usize * axes + axis]);
            let (low, high) = along.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            self.boxes[start + axis] = low;
            self.boxes[start + axes + axis] = high;
            if high - low > widest.0 {
                widest = (high - low, axis);
            }
        }
        if range.len() <= LEAF {
            return;
        }
        let key = |index: u32| self.points[index as usize * axes + widest.1];
        let middle = range.len() / 2;
        range.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
        let (below, above) = range.split_at_mut(middle);
        self.build(2 * branch + 1, below);
        self.build(2 * branch + 2, above);
    }

    /// For each point its `count` nearest points, itself left out unless `with_itself`, nearest first: squared
    /// distance and index. Equal distances are in the order of their indices, but a point is its own first. Lists
    /// are shorter where there are not so many points.
    pub fn neighbours(&self, count: usize, with_itself: bool) -> Vec<Vec<(f32, u32)>> {
        let queries: Vec<u32> = (0..self.order.len() as u32).collect();
        let others = count - usize::from(with_itself && count > 0);
        queries
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                chunk.iter().map(|&query| {
                    let mut found = self.nearest(self.point(query), Some(query), others);
                    if others < count {
                        found.insert(0, (0.0, query));
                    }
                    found
                })
            })
            .collect()
    }

    /// Squared distance and index of the `count` points nearest to a place, `but` left out, nearest first; of equals
    /// the lower index.
    pub fn nearest(&self, to: &[f32], but: Option<u32>, count: usize) -> Vec<(f32, u32)> {
        let mut found = Vec::with_capacity(count + 1);
        if count > 0 {
            self.search(0, &self.order, (to, but), count, &mut found);
        }
        found
    }

    fn search(
        &self,
        branch: usize,
        range: &[u32],
        (to, but): (&[f32], Option<u32>),
        count: usize,
        found: &mut Vec<(f32, u32)>,
    ) {
        if range.len() <= LEAF {
            for &index in range.iter().filter(|&&index| but != Some(index)) {
                let apart = to.iter().zip(self.point(index)).map(|(a, b)| (a - b) * (a - b)).sum();
                let entry = (apart, index);
                if found.len() < count || found.last().is_some_and(|last| by_distance(&entry, last).is_lt()) {
                    let place = found.partition_point(|other| by_distance(other, &entry).is_lt());
                    found.insert(place, entry);
                    found.truncate(count);
                }
            }
            return;
        }
        let (below, above) = range.split_at(range.len() / 2);
        let mut sides = [(2 * branch + 1, below), (2 * branch + 2, above)]
            .map(|(branch, range)| (self.least(to, branch), branch, range));
        if sides[1].0 < sides[0].0 {
            sides.swap(0, 1);
        }
        for (least, branch, range) in sides {
            // Not "less": an equal distance may belong to a lower index.
            if found.len() < count || found.last().is_some_and(|last| least <= last.0) {
                self.search(branch, range, (to, but), count, found);
            }
        }
    }

    fn point(&self, index: u32) -> &[f32] {
        &self.points[index as usize * self.axes..][..self.axes]
    }

    /// Squared distance to the box of a branch.
    fn least(&self, to: &[f32], branch: usize) -> f32 {
        let corners = &self.boxes[branch * 2 * self.axes..][..2 * self.axes];
        let (low, high) = corners.split_at(self.axes);
        let beyond = to.iter().zip(low).zip(high);
        beyond.map(|((value, low), high)| (low - value).max(value - high).max(0.0).powi(2)).sum()
    }
}

fn by_distance(a: &(f32, u32), b: &(f32, u32)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn neighbours_are_those_of_the_plain_search() {
        for axes in [1, 3, 7] {
            let mut random = ChaCha8Rng::seed_from_u64(axes as u64);
            // Coarse coordinates, so that many distances are equal.
            let points: Vec<f32> = (0..200 * axes).map(|_| random.random_range(0..6) as f32).collect();
            let found = Tree::new(&points, axes).neighbours(5, false);
            for (query, found) in found.iter().enumerate() {
                let at = |index: usize| &points[index * axes..][..axes];
                let mut all: Vec<(f32, u32)> = (0..200)
                    .filter(|&other| other != query)
                    .map(|other| {
                        let apart = at(other).iter().zip(at(query)).map(|(a, b)| (a - b) * (a - b)).sum();
                        (apart, other as u32)
                    })
                    .collect();
                all.sort_unstable_by(by_distance);
                assert_eq!(found[..], all[..5], "{query} of {axes} axes");
            }
        }
    }

    #[test]
    fn a_point_may_count_itself_and_few_points_give_short_lists() {
        let points = [0.0, 10.0, 11.0];
        let tree = Tree::new(&points, 1);
        assert_eq!(tree.neighbours(2, true)[2], [(0.0, 2), (1.0, 1)]);
        assert_eq!(tree.neighbours(5, false)[0], [(100.0, 1), (121.0, 2)]);
        assert!(Tree::new(&[], 3).neighbours(4, true).is_empty());
        assert!(Tree::new(&points, 1).neighbours(0, false)[0].is_empty());
    }
}
