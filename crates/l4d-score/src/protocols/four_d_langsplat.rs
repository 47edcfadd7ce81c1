//! 4D LangSplat: sentences about no time by masks, sentences about a time by masks and by when they are said to hold.
//!
//! `eval/eval.py` lines 667 to 690 (mean IoU over annotated frames, then sentences), 379 (accuracy), 383 to 393 (vIoU).
//! The mask of the base object is the truth in every frame that shows it, whether the sentence holds or not.

use l4d_data::Temporal;

use super::clip::{Clip, QueryScores, Seen, Value};
use super::langsplat::leaving_out_absent;
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "4D LangSplat, eval/eval.py",
    measures: &[
        Measure { key: "miou", title: "mIoU" },
        Measure { key: "viou", title: "vIoU" },
        Measure { key: "acc", title: "Acc" },
    ],
    on_missing: OnMissing::Stops,
    resizes: false,
    averaging: Averaging::QueriesThenScenes,
    remark: "An answer of at least one pixel says that the sentence holds; the source says so where the \
             features of time are closer to it than on average.",
    judge,
};

const NOT_SHOWN: &str = "do not show the object of a sentence about a time: no one annotates them";

fn judge(clip: &Clip<'_>) -> QueryScores {
    if clip.query.temporal == Temporal::Whole {
        let iou = Value::mean(clip.present().filter_map(Seen::iou));
        return leaving_out_absent(QueryScores::new([iou, None, None]), clip);
    }
    let annotated = || clip.seen.iter().filter(|seen| seen.visible.is_some());
    let accuracy = Value::share(annotated().map(|seen| seen.holds == (seen.answered > 0)));
    let viou = accuracy.map(|Value { frames, .. }| {
        let either = annotated().filter(|seen| seen.holds || seen.answered > 0);
        let both = |seen: &Seen<'_>| seen.holds && seen.answered > 0;
        let ious = either.map(|seen| if both(seen) { seen.visible_iou().unwrap_or(0.0) } else { 0.0 });
        // Neither said nor true anywhere: the source says 0.
        Value { mean: Value::mean(ious).map_or(0.0, |value| value.mean), frames }
    });
    let hidden = clip.seen.len() - annotated().count();
    QueryScores::new([None, viou, accuracy]).leaving_out(NOT_SHOWN, hidden)
}
