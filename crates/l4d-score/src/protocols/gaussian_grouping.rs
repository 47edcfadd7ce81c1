//! Gaussian Grouping: IoU and boundary IoU over the frames of a sentence that were answered, then over sentences.
//!
//! `script/eval_lerf_mask.py` lines 62 to 73 and 95 to 98: a missing picture is skipped without a word. Boundaries are
//! 0.02 of the diagonal deep (Cheng et al., Boundary IoU, 2021).

use super::boundary::boundary_iou;
use super::clip::{Clip, QueryScores, Seen, Value};
use super::langsplat::leaving_out_absent;
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "Gaussian Grouping, script/eval_lerf_mask.py",
    measures: &[
        Measure { key: "miou", title: "mIoU" },
        Measure { key: "boundary_miou", title: "bound. mIoU" },
    ],
    on_missing: OnMissing::OwnRule,
    resizes: true,
    averaging: Averaging::QueriesThenScenes,
    remark: "The source writes masks above 128; here they are as they were given.",
    judge,
};

const SKIPPED: &str = "have no answer and are skipped silently, as if they had not been asked";

fn judge(clip: &Clip<'_>) -> QueryScores {
    let answered = || clip.present().filter(|seen| !seen.is_missing());
    let boundary = answered().filter_map(|seen| {
        let (target, predicted) = (seen.target()?, seen.predicted.as_ref()?);
        boundary_iou(target.mask(), predicted)
    });
    let judged = QueryScores::new([Value::mean(answered().filter_map(Seen::iou)), Value::mean(boundary)]);
    let skipped = clip.present().filter(|seen| seen.is_missing()).count();
    leaving_out_absent(judged, clip).leaving_out(SKIPPED, skipped)
}
