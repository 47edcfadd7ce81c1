//! J and F in the sense of DAVIS, and boundaries of masks.
//!
//! F after the DAVIS 2017 evaluation (`davis2017/metrics.py` lines 40 to 117): contours of one pixel that may lie apart by
//! 0.008 of the diagonal, rounded up. Boundary IoU after Cheng et al. 2021: the pixels of a mask near its border, 0.02 of
//! the diagonal deep, measured in squares; the border of the picture is a border of the mask.

use l4d_masks::Mask;
use l4d_masks::morphology::{dilated, edges, eroded_square};

use super::clip::{Seen, Value};

/// Share of the diagonal that contours may lie apart.
const CONTOUR_TOLERANCE: f64 = 0.008;
/// Share of the diagonal that boundaries are deep.
const BOUNDARY_DEPTH: f64 = 0.02;

/// How much of two contours lies near the other one, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Contours {
    predicted: u64,
    predicted_near: u64,
    target: u64,
    target_near: u64,
}

impl Contours {
    fn of(predicted: &Mask, target: &Mask) -> Self {
        let reach_px = (CONTOUR_TOLERANCE * diagonal(target)).ceil() as u32;
        let (predicted, target) = (edges(predicted), edges(target));
        let near = |ours: &Mask, theirs: &Mask| match ours.is_empty() || theirs.is_empty() {
            true => 0,
            false => ours.and_count(&dilated(theirs, reach_px)),
        };
        Self {
            predicted: predicted.area(),
            predicted_near: near(&predicted, &target),
            target: target.area(),
            target_near: near(&target, &predicted),
        }
    }

    /// A mask that fills the picture has no contour, and then counts as one without a pixel.
    fn f_measure(self) -> f64 {
        let share = |part: u64, whole: u64| part as f64 / whole as f64;
        let (precision, recall) = match (self.predicted, self.target) {
            (0, 0) => (1.0, 1.0),
            (0, _) => (1.0, 0.0),
            (_, 0) => (0.0, 1.0),
            (ours, theirs) => (share(self.predicted_near, ours), share(self.target_near, theirs)),
        };
        if precision + recall == 0.0 { 0.0 } else { 2.0 * precision * recall / (precision + recall) }
    }
}

/// J: IoU of the masks; where neither has a pixel, 1.
pub(super) fn region(seen: &Seen<'_>) -> f64 {
    seen.iou().unwrap_or(1.0)
}

/// F: the harmonic mean of the shares of either contour that lie near the other; where neither is, 1.
pub(super) fn contour(seen: &Seen<'_>) -> f64 {
    match (seen.target(), seen.predicted.as_deref().filter(|_| seen.answered > 0)) {
        (None, None) => 1.0,
        (Some(target), Some(predicted)) => Contours::of(predicted, target.mask()).f_measure(),
        (Some(one), None) => Contours::of(&empty_like(one.mask()), one.mask()).f_measure(),
        (None, Some(one)) => Contours::of(one, &empty_like(one)).f_measure(),
    }
}

fn empty_like(mask: &Mask) -> Mask {
    Mask::empty(mask.width(), mask.height())
}

/// The mean of J and F, from their means.
pub(super) fn both(j: Option<Value>, f: Option<Value>) -> Option<Value> {
    let (j, f) = (j?, f?);
    Some(Value { mean: (j.mean + f.mean) / 2.0, frames: j.frames })
}

/// IoU of the boundaries of two masks; none where neither has one.
pub(super) fn boundary_iou(one: &Mask, other: &Mask) -> Option<f64> {
    let (one, other) = (Boundary::of(one), Boundary::of(other));
    let intersection = one.overlap(&other);
    let union = one.area + other.area - intersection;
    (union > 0).then(|| intersection as f64 / union as f64)
}

/// The pixels of a mask without those deep inside.
struct Boundary<'a> {
    mask: &'a Mask,
    core: Mask,
    area: u64,
}

impl<'a> Boundary<'a> {
    fn of(mask: &'a Mask) -> Self {
        // Halves go to the even neighbour, as in the source's language.
        let depth_px = (BOUNDARY_DEPTH * diagonal(mask)).round_ties_even().max(1.0) as u32;
        let core = eroded_square(mask, depth_px);
        let area = mask.and_not_count(&core);
        Self { mask, core, area }
    }

    /// Pixels in both, from counts: what both masks share, less what is deep inside one of them or both.
    fn overlap(&self, other: &Self) -> u64 {
        let shared = self.mask.and_count(other.mask);
        let deep = self.core.and_count(other.mask) + other.core.and_count(self.mask);
        shared + self.core.and_count(&other.core) - deep
    }
}

fn diagonal(mask: &Mask) -> f64 {
    let (width, height) = mask.size();
    (f64::from(width).powi(2) + f64::from(height).powi(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(first: u32, side: u32) -> Mask {
        let inside = first..first + side;
        Mask::from_fn(60, 60, |col, row| inside.contains(&col) && inside.contains(&row))
    }

    /// Diagonal 84.85: contours may lie 1 pixel apart, boundaries are 2 deep.
    #[test]
    fn boundaries_by_hand() {
        // Rings of width 2 around squares of 10 and 8 in its middle: 100 - 36, 64 - 16; shared is the outer ring of the
        // small one that the big one's core of 6 leaves: 64 - 36.
        assert_eq!(boundary_iou(&square(10, 10), &square(11, 8)), Some(28.0 / (64.0 + 48.0 - 28.0)));
        assert_eq!(boundary_iou(&square(10, 10), &square(10, 10)), Some(1.0));
        assert_eq!(boundary_iou(&square(10, 10), &square(40, 10)), Some(0.0));
        let empty = Mask::empty(60, 60);
        assert_eq!(boundary_iou(&empty, &empty), None);
        assert_eq!(boundary_iou(&square(10, 3), &empty), Some(0.0));
        // The border of the picture bounds a mask.
        let full = Mask::full(60, 60);
        assert_eq!(boundary_iou(&full, &full), Some(1.0));
        assert_eq!(boundary_iou(&full, &square(2, 56)), Some(0.0));
    }

    #[test]
    fn contours_by_hand() {
        let f = |one: &Mask, other: &Mask| Contours::of(one, other).f_measure();
        assert_eq!(f(&square(10, 10), &square(10, 10)), 1.0);
        // One pixel apart is near enough, two corners excepted, whose neighbour lies across: each contour has 40 pixels.
        assert_eq!(f(&square(10, 10), &square(11, 10)), 0.975);
        assert_eq!(f(&square(10, 10), &square(40, 10)), 0.0);
        let (empty, full) = (Mask::empty(60, 60), Mask::full(60, 60));
        assert_eq!((f(&empty, &empty), f(&full, &empty), f(&empty, &square(3, 3))), (1.0, 1.0, 0.0));
    }
}
