//! SA-Co of SAM 3: finding what a phrase means, and saying nothing where nothing is meant.
//!
//! `sam3/eval/demo_eval.py` of facebookresearch/sam3 at 99d02f2, over clips as `ytvis_eval.py` does: an answer is found at a
//! threshold if its IoU over all frames reaches it, for ten thresholds from 0.5 to 0.95. pmF1 is the F1 of the counts over
//! sentences that mean something, averaged over the thresholds; IL_MCC is Matthews' correlation between whether anything is
//! meant and whether anything was answered; cgF1 is their product. N-acc, the no-target accuracy of GRES, is the share of
//! the sentences that mean nothing for which nothing was answered.

use super::clip::{Clip, QueryScores, Value};
use super::sheet::Row;
use super::{Averaging, Measure, OnMissing, Rules};

pub(super) const RULES: Rules = Rules {
    source: "SA-Co, sam3/eval/demo_eval.py and ytvis_eval.py",
    measures: &[
        Measure { key: "cgf1", title: "cgF1" },
        Measure { key: "pmf1", title: "pmF1" },
        Measure { key: "il_mcc", title: "IL_MCC" },
        Measure { key: "n_acc", title: "N-acc" },
    ],
    on_missing: OnMissing::Stops,
    resizes: false,
    averaging: Averaging::Counts,
    remark: "Queries and absent sentences together. What a sentence means is one mask, however many things it is. In rows of \
             sentences pmF1 is the IoU over the clip, and IL_MCC whether it was told rightly that something is meant.",
    judge,
};

const PMF1: usize = 1;
const TOLD: usize = 2;
const N_ACC: usize = 3;
/// What the source adds to denominators of shares of masks, and of sentences.
const EPSILONS: [f64; 2] = [1e-4, 1e-6];

fn judge(clip: &Clip<'_>) -> QueryScores {
    let sum = |of: fn(&super::clip::Seen<'_>) -> u64| clip.seen.iter().map(of).sum::<u64>();
    let target = sum(|seen| seen.target().map_or(0, |mask| mask.area()));
    let answered = sum(|seen| seen.answered);
    let intersection = sum(|seen| if seen.holds { seen.intersection } else { 0 });
    let whole = |value: f64| Some(Value::whole(value, clip.seen.len()));
    let is_right = f64::from(u8::from((target > 0) == (answered > 0)));
    let union = target + answered - intersection;
    let (found, silent) = match target {
        0 => (None, whole(is_right)),
        _ => (whole(intersection as f64 / union as f64), None),
    };
    QueryScores::new([None, found, whole(is_right), silent])
}

/// A number over sentences, 0 to 1 (IL_MCC and cgF1: -1 to 1); none where there is nothing to be found.
pub(super) fn number(rows: &[&Row], measure: usize) -> Option<f64> {
    let value = |row: &Row, measure: usize| row.judged.values[measure].map(|value| value.mean);
    if measure == N_ACC {
        return crate::metrics::mean(rows.iter().filter_map(|row| value(row, N_ACC)));
    }
    let counted = |is_meant: bool, is_right: f64| {
        let fits = |row: &&&Row| value(row, PMF1).is_some() == is_meant && value(row, TOLD) == Some(is_right);
        rows.iter().filter(fits).count() as f64
    };
    let [found, lost, silent, alarms] =
        [(true, 1.0), (true, 0.0), (false, 1.0), (false, 0.0)].map(|(meant, right)| counted(meant, right));
    let [of_masks, of_sentences] = EPSILONS;
    let product = (found + alarms) * (found + lost) * (silent + alarms) * (silent + lost);
    let mcc = (found * silent - alarms * lost) / (product.sqrt() + of_sentences);
    let ious: Vec<f64> = rows.iter().filter_map(|row| value(row, PMF1)).collect();
    let f1 = |step: u32| {
        let threshold = 0.5 + 0.05 * f64::from(step);
        let hits = ious.iter().filter(|iou| **iou >= threshold - 1e-12).count() as f64;
        let precision = hits / (found + of_masks);
        let recall = hits / (found + lost + of_masks);
        2.0 * precision * recall / (precision + recall + of_masks)
    };
    let pmf1 = (0..10).map(f1).sum::<f64>() / 10.0;
    match measure {
        _ if ious.is_empty() => None,
        PMF1 => Some(pmf1),
        TOLD => Some(mcc),
        _ => Some(pmf1 * mcc),
    }
}
