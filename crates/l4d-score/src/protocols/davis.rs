//! DAVIS 2017, semi-supervised: J and F of every object over its clip.
//!
//! `davis2017/metrics.py` lines 21 to 36 (J) and 40 to 117 (F), `evaluation.py` lines 84, 85 (the first frame is given to
//! methods and the last is dropped), `davis.py` line 93 (objects are those of the first frame), `utils.py` lines 144 to 158
//! (recall, decay). A query is an object.

use super::boundary::{both, contour, region};
use super::clip::{Clip, QueryScores, Seen, Value};
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "DAVIS 2017, semi-supervised",
    measures: &[
        Measure { key: "j_and_f", title: "J&F" },
        Measure { key: "j_mean", title: "J-Mean" },
        Measure { key: "j_recall", title: "J-Recall" },
        Measure { key: "j_decay", title: "J-Decay" },
        Measure { key: "f_mean", title: "F-Mean" },
        Measure { key: "f_recall", title: "F-Recall" },
        Measure { key: "f_decay", title: "F-Decay" },
    ],
    on_missing: OnMissing::Stops,
    resizes: false,
    averaging: Averaging::Queries,
    remark: "A query is an object. There are no void pixels.",
    judge,
};

const NO_OBJECT: &str =
    "belong to objects that the first frame does not show, so that no prompt asks to follow them";
const ENDS: &str = "are first or last of their clip and dropped";
const TOO_SHORT: &str = "belong to clips of one or two frames, of which nothing is left";

/// Quarters of a clip between which decay is measured.
const BINS: usize = 4;

fn judge(clip: &Clip<'_>) -> QueryScores {
    let frames = clip.seen.len();
    let none = || QueryScores::new([None; 7]);
    if !clip.seen.first().is_some_and(Seen::is_present) {
        return none().leaving_out(NO_OBJECT, frames);
    }
    if frames < 3 {
        return none().leaving_out(TOO_SHORT, frames);
    }
    let inner = &clip.seen[1..frames - 1];
    let j: Vec<f64> = inner.iter().map(region).collect();
    let f: Vec<f64> = inner.iter().map(contour).collect();
    let mean = |values: &[f64]| Value::mean(values.iter().copied());
    let recall = |values: &[f64]| Value::share(values.iter().map(|&value| value > 0.5));
    let lost = |values: &[f64]| Some(Value::whole(decay(values), values.len()));
    let (j_mean, f_mean) = (mean(&j), mean(&f));
    QueryScores::new([both(j_mean, f_mean), j_mean, recall(&j), lost(&j), f_mean, recall(&f), lost(&f)])
        .leaving_out(ENDS, 2)
}

/// How much the mean of the first quarter is above that of the last. Neighbouring quarters share the frame between them.
fn decay(values: &[f64]) -> f64 {
    let last = (values.len() - 1) as f64;
    // Positions of the ends of quarters; halves go to the even neighbour, after a nudge upwards.
    let end =
        |quarter: usize| (1.0 + last * quarter as f64 / BINS as f64 + 1e-10).round_ties_even() as usize - 1;
    let mean = |quarter: usize| {
        let bin = &values[end(quarter)..=end(quarter + 1)];
        bin.iter().sum::<f64>() / bin.len() as f64
    };
    mean(0) - mean(BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::decay;

    #[test]
    fn decay_by_hand() {
        assert_eq!(decay(&[0.5]), 0.0);
        // Ends at 0, 1, 2, 3, 4: quarters of two frames.
        assert_eq!(decay(&[1.0, 0.5, 0.0, 0.5, 0.25]), 0.75 - 0.375);
        // Seven frames: 1 + 6/4 = 2.5 goes up by the nudge, to position 2.
        assert!((decay(&[0.9, 0.6, 0.3, 0.0, 0.0, 0.0, 0.3]) - (0.6 - 0.15)).abs() < 1e-12);
    }
}
