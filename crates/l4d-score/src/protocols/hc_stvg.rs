//! HC-STVG: tubes of boxes.
//!
//! `eval_hcvg.py` lines 54 to 69: the IoU of boxes, summed over the frames that have both, over the length from the first
//! frame of either tube to the last of either; gaps count. A video without an answer counts 0. Boxes are those around the
//! masks, with edges between pixels.

use l4d_masks::mask::PixelBox;

use super::Measure;
use super::judged::{Judged, Value};
use super::seen::Clip;

pub(super) const MEASURES: &[Measure] = &[
    Measure { key: "viou", title: "m_vIoU" },
    Measure { key: "tiou", title: "m_tIoU" },
    Measure { key: "viou30", title: "vIoU@.3" },
    Measure { key: "viou50", title: "vIoU@.5" },
];

const NO_TUBE: &str = "belong to sentences whose target is never to be seen: there is no tube to find";
const NO_ANSWER: &str = "belong to sentences without any answer, which count 0";

pub(super) fn judge(clip: &Clip<'_>) -> Judged {
    let boxes: Vec<(Option<PixelBox>, Option<PixelBox>)> = clip
        .seen
        .iter()
        .map(|seen| {
            let target = seen.target().and_then(|target| target.mask().bounding_box());
            (target, seen.predicted.as_ref().and_then(|mask| mask.bounding_box()))
        })
        .collect();
    let frames = boxes.len();
    if boxes.iter().all(|(target, _)| target.is_none()) {
        return Judged::new([None; 4]).leaving_out(NO_TUBE, frames);
    }
    let either = |&(target, predicted): &(Option<PixelBox>, Option<PixelBox>)| target.or(predicted).is_some();
    let first = boxes.iter().position(either).unwrap_or(0);
    let last = boxes.iter().rposition(either).unwrap_or(0);
    let hull = (last - first + 1) as f64;
    let common: Vec<f64> = boxes.iter().filter_map(|&(one, other)| Some(box_iou(one?, other?))).collect();
    let viou = common.iter().sum::<f64>() / hull;
    let value = |mean: f64| Some(Value::whole(mean, frames));
    let above = |threshold: f64| value(f64::from(u8::from(viou > threshold)));
    let judged = Judged::new([value(viou), value(common.len() as f64 / hull), above(0.3), above(0.5)]);
    let is_silent = clip.seen.iter().all(|seen| seen.is_missing());
    judged.leaving_out(NO_ANSWER, if is_silent { frames } else { 0 })
}

fn box_iou(one: PixelBox, other: PixelBox) -> f64 {
    let overlap = |firsts: [u32; 2], lasts: [u32; 2]| {
        u64::from((lasts[0].min(lasts[1]) + 1).saturating_sub(firsts[0].max(firsts[1])))
    };
    let both = overlap([one.first_col, other.first_col], [one.last_col, other.last_col])
        * overlap([one.first_row, other.first_row], [one.last_row, other.last_row]);
    (both as f64) / (area(one) + area(other) - both) as f64
}

fn area(of: PixelBox) -> u64 {
    u64::from(of.last_col - of.first_col + 1) * u64::from(of.last_row - of.first_row + 1)
}
