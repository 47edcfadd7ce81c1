//! Points of surfaces at one moment, and which training cameras see them.
//!
//! They come from rendered depth, or from a reconstruction where there is one; no one makes them up. Which of too many
//! are kept is decided by a hash, so that they lie evenly and are the same in every run.

mod depth;
mod reconstruction;

use glam::DVec2;
use l4d_data::Camera;

pub(super) use self::depth::{SeenFrame, View};
pub(super) use self::reconstruction::Reconstruction;
use crate::points::ColouredPoint;

/// The moment whose points a layout of a whole clip starts from.
pub(super) const FIRST: &str = "the first moment";
/// The moment of a layout that has a folder for each.
pub(super) const EACH: &str = "each moment";

/// Points at a moment.
pub(super) enum Cloud<'a> {
    /// From what training cameras saw.
    Depth(SeenFrame<'a>),
    /// From a reconstruction, with the training cameras that are present.
    Reconstruction(&'a Reconstruction, Vec<&'a Camera>, u32),
}

/// A point and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CloudPoint {
    pub(super) surface: ColouredPoint,
    /// The view that shows it, or its place in the reconstruction.
    source: usize,
}

impl<'a> Cloud<'a> {
    /// At most about `budget` points; all if there are fewer.
    pub(super) fn points(&self, budget: usize) -> Vec<CloudPoint> {
        match self {
            Self::Depth(moment) => moment.points(budget),
            Self::Reconstruction(points, _, _) => points.points(budget),
        }
    }

    /// [`Self::points`] without where they come from.
    pub(super) fn surfaces(&self, budget: usize) -> Vec<ColouredPoint> {
        self.points(budget).into_iter().map(|point| point.surface).collect()
    }

    /// Where the pictures of training cameras show a point.
    pub(super) fn sightings(&self, point: &CloudPoint) -> Vec<(&'a Camera, DVec2)> {
        match self {
            Self::Depth(moment) => moment.sightings(point),
            Self::Reconstruction(points, present, frame) => points.sightings(point, present, *frame),
        }
    }
}

/// Says of which moment, and from where, the points in a file are, or that there are none.
pub(super) fn statement(file: &str, moment: &str, cloud: Option<&Cloud<'_>>) -> String {
    match cloud {
        Some(Cloud::Depth(_)) => format!("{file}: points come from rendered depth at {moment}"),
        Some(Cloud::Reconstruction(points, _, _)) => match points.left_out() {
            0 => format!("{file}: points are those of the reconstruction"),
            count => format!(
                "{file}: points are those of the reconstruction, but for {count} that fewer than two training views saw"
            ),
        },
        None => format!(
            "{file}: no points, since surfaces are unknown; triangulate some with the cameras of \
             `--format colmap` (`colmap point_triangulator`) and give the model with `--points-from`"
        ),
    }
}

/// The share of points to keep.
fn share(budget: usize, total: usize) -> f64 {
    budget as f64 / total.max(1) as f64
}

/// Whether a point is among the share that is kept.
fn is_kept(share: f64, source: usize, index: usize) -> bool {
    share >= 1.0 || unit_hash(source as u64, index as u64) < share
}

/// A number from 0 to 1 that looks random and depends on nothing but the place.
fn unit_hash(source: u64, index: u64) -> f64 {
    // SplitMix64's finaliser over a counter.
    let mut bits = (source << 40 | index).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_even_in_every_view() {
        for view in 0..4 {
            let kept = (0..100_000).filter(|&pixel| is_kept(0.1, view, pixel)).count();
            assert!((9_700..10_300).contains(&kept), "{kept} of view {view}");
        }
        assert_ne!(unit_hash(0, 1), unit_hash(1, 0));
    }
}
