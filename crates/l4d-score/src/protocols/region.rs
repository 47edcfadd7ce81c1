//! J and F of one query: how masks fit by area and by contour, in the sense of DAVIS.

use l4d_masks::Mask;

use super::boundary::Contours;
use super::judged::Value;
use super::seen::Seen;

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
