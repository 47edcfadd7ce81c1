//! R4D-Bench-QA: when a sentence is said to hold, and the masks of the frames in which it does.
//!
//! `scripts/evaluate_ours_benchmark.py` of HyperGaussian at 5a12135. The truth knows some frames with masks; from the
//! first to the last of them the target counts as there (`existence_frames`, its "dense range"). Acc compares that with
//! whether anything was answered, over the frames that were rendered; tIoU is the IoU of the two sets of frames. vIoU is
//! the mean IoU over the frames with masks, each against the nearest rendered frame, 0 where nothing was answered. A
//! target that is never there is right, 1, if nothing is ever answered. A query without any answer leaves the mean.

use super::clip::{Clip, QueryScores, Seen, Value};
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "R4D-Bench-QA, scripts/evaluate_ours_benchmark.py",
    measures: &[
        Measure { key: "acc", title: "Acc" },
        Measure { key: "viou", title: "vIoU" },
        Measure { key: "tiou", title: "tIoU" },
    ],
    on_missing: OnMissing::OwnRule,
    resizes: true,
    averaging: Averaging::Queries,
    remark: "An answer of at least one pixel says that the sentence holds. Between the first and the last frame that \
             shows what is meant, it counts as there in all frames.",
    judge,
};

const LOST: &str = "belong to queries without any answer, and such a query leaves the mean";
const NEAREST: &str = "have no answer, and are compared with the nearest frame that has one";
const BETWEEN: &str = "do not show what is meant, but lie between frames that do, and count as if they did";

fn judge(clip: &Clip<'_>) -> QueryScores {
    let rendered: Vec<(usize, &Seen<'_>)> =
        clip.seen.iter().enumerate().filter(|(_, seen)| !seen.is_missing()).collect();
    if rendered.is_empty() {
        return QueryScores::new([None; 3]).leaving_out(LOST, clip.seen.len());
    }
    let annotated: Vec<usize> = (0..clip.seen.len()).filter(|&place| clip.seen[place].is_present()).collect();
    let ends = annotated.first().zip(annotated.last());
    let is_there = |place: usize| ends.is_some_and(|(first, last)| (*first..=*last).contains(&place));
    let says = |seen: &Seen<'_>| seen.answered > 0;

    let acc = Value::share(rendered.iter().map(|(place, seen)| says(seen) == is_there(*place)));
    let said = |place: usize| rendered.iter().any(|(at, seen)| *at == place && says(seen));
    let places = || 0..clip.seen.len();
    let both = places().filter(|&place| said(place) && is_there(place)).count();
    let either = places().filter(|&place| said(place) || is_there(place)).count();
    let tiou = if either == 0 { 1.0 } else { both as f64 / either as f64 };

    let iou = |&place: &usize| {
        let nearest = nearest(&rendered, place);
        if says(nearest) { iou_with(&clip.seen[place], nearest) } else { 0.0 }
    };
    let viou = Value::mean(annotated.iter().map(iou))
        .unwrap_or(Value::whole(f64::from(u8::from(either == 0)), clip.seen.len()));

    let lost = annotated.iter().filter(|&&place| clip.seen[place].is_missing()).count();
    let between = places().filter(|&place| is_there(place)).count() - annotated.len();
    QueryScores::new([acc, Some(viou), Some(Value::whole(tiou, clip.seen.len()))])
        .leaving_out(NEAREST, lost)
        .leaving_out(BETWEEN, between)
}

/// The rendered frame that is nearest to a place, of two equally near ones the earlier.
fn nearest<'s, 'a>(rendered: &[(usize, &'s Seen<'a>)], place: usize) -> &'s Seen<'a> {
    let nearest = rendered.iter().min_by_key(|(at, _)| at.abs_diff(place));
    nearest.map(|(_, seen)| *seen).expect("a query without rendered frames was left out")
}

/// IoU of the target of one frame with the answer to another.
fn iou_with(target: &Seen<'_>, answered: &Seen<'_>) -> f64 {
    let (Some(target), Some(answer)) = (target.target(), answered.predicted.as_deref()) else { return 0.0 };
    let intersection = target.overlap(answer);
    l4d_masks::iou(intersection, target.area() + answered.answered - intersection).unwrap_or(0.0)
}
