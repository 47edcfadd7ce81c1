//! OpenGaussian: pairs of frame and sentence, and the shares of them above two thresholds.
//!
//! `scripts/compute_lerf_iou.py` lines 17, 18 (0/0 is 0), 39 to 43 (a missing picture is 0, though the print says that it
//! is skipped) and 51 to 59 (strictly above).

use super::Measure;
use super::judged::{Judged, Value};
use super::langsplat::leaving_out_absent;
use super::seen::Clip;

pub(super) const MEASURES: &[Measure] = &[
    Measure { key: "miou", title: "mIoU" },
    Measure { key: "acc25", title: "Acc@.25" },
    Measure { key: "acc50", title: "Acc@.5" },
];

const COUNTED: &str = "have no answer and count 0";

pub(super) fn judge(clip: &Clip<'_>) -> Judged {
    let ious = || clip.present().map(|seen| seen.iou().unwrap_or(0.0));
    let above = |threshold: f64| Value::share(ious().map(|iou| iou > threshold));
    let judged = Judged::new([Value::mean(ious()), above(0.25), above(0.5)]);
    let missing = clip.present().filter(|seen| seen.is_missing()).count();
    leaving_out_absent(judged, clip).leaving_out(COUNTED, missing)
}
