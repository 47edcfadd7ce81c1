//! MeViS: J and F of every expression over all frames of its video.
//!
//! `tools/eval_mevis.py` lines 29 to 53 and 89 to 94. Frames in which nothing is meant count, with 1 if nothing is said.
//! A missing picture ends the worker, and the expression is then absent from the mean without a word; a video without a
//! folder counts 0.

use super::boundary::{both, contour, region};
use super::clip::{Clip, QueryScores, Seen, Value};
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "MeViS, tools/eval_mevis.py",
    measures: &[
        Measure { key: "j_and_f", title: "J&F" },
        Measure { key: "j", title: "J" },
        Measure { key: "f", title: "F" },
    ],
    on_missing: OnMissing::OwnRule,
    resizes: false,
    averaging: Averaging::Queries,
    remark: "A query is an expression, a scene a video.",
    judge,
};

const NO_VIDEO: &str = "belong to videos without any answer, which count 0";
const LOST: &str = "belong to expressions that lack an answer, and such an expression is lost silently";

fn judge(clip: &Clip<'_>) -> QueryScores {
    let frames = clip.seen.len();
    if !clip.is_scene_answered {
        return QueryScores::new([Some(Value::whole(0.0, frames)); 3]).leaving_out(NO_VIDEO, frames);
    }
    if clip.seen.iter().any(Seen::is_missing) {
        return QueryScores::new([None; 3]).leaving_out(LOST, frames);
    }
    let j = Value::mean(clip.seen.iter().map(region));
    let f = Value::mean(clip.seen.iter().map(contour));
    QueryScores::new([both(j, f), j, f])
}
