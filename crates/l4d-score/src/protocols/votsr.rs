//! VOTSr 2026, the referral challenge of VOTS: IoU of every prompt over the annotated frames of its sequence.
//!
//! `vot/analysis/referral.py` of votchallenge/toolkit. A frame in which the target is annotated as gone counts, with 1 if
//! nothing is said. A frame without an answer becomes an empty mask there, which is right wherever the target is gone. All
//! frames of all prompts of a sequence weigh the same, and sequences weigh by their length: by all frames, although the
//! text beside it says by evaluated ones. Clips of a profile are equally long, so queries weigh the same here.

use super::boundary::region;
use super::clip::{Clip, QueryScores, Value};
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "VOTS 2026 referral, vot/analysis/referral.py",
    measures: &[Measure { key: "accuracy", title: "Accuracy" }],
    on_missing: OnMissing::OwnRule,
    resizes: false,
    averaging: Averaging::Queries,
    remark: "A query is a sequence with one prompt. There are no ignored pixels.",
    judge,
};

const FREE: &str = "have no answer and no target, which counts 1";
const LOST: &str = "have no answer where the target is, which counts 0";

fn judge(clip: &Clip<'_>) -> QueryScores {
    let accuracy = Value::mean(clip.seen.iter().map(region));
    let missing = |is_present: bool| {
        clip.seen.iter().filter(|seen| seen.is_missing() && seen.is_present() == is_present).count()
    };
    QueryScores::new([accuracy]).leaving_out(FREE, missing(false)).leaving_out(LOST, missing(true))
}
