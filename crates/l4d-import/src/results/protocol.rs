//! What the evaluations of others would say of the same masks.
//!
//! The judge of this project is `l4d-score`; here the sums of others are done again, so that a number of a paper can
//! be set beside ours and the difference explained. Every function takes the same counts. `docs/import/protocols.md`
//! has the definitions, with the lines of the originals that they follow.

use l4d_data::{QueryId, Temporal};
use serde::Serialize;

/// One sentence in one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Count {
    /// The sentence.
    pub query: QueryId,
    /// Whether it holds at some times only.
    pub temporal: Temporal,
    /// The frame.
    pub frame: u32,
    /// Pixels that the referents show in the frame, whether the sentence holds or not.
    pub visible: u64,
    /// Whether the sentence holds in the frame.
    pub holds: bool,
    /// Pixels predicted; none where nothing was answered.
    pub predicted: Option<u64>,
    /// Pixels of the prediction within what is visible.
    pub intersection: u64,
}

impl Count {
    fn answered(&self) -> u64 {
        self.predicted.unwrap_or(0)
    }

    /// IoU with what is visible; none where neither has a pixel.
    fn iou(&self) -> Option<f64> {
        let union = self.visible + self.answered() - self.intersection;
        (union > 0).then(|| self.intersection as f64 / union as f64)
    }

    /// IoU with what is asked for: nothing, while a sentence about a time does not hold.
    fn gated_iou(&self) -> Option<f64> {
        if self.is_asked() { self.iou() } else { (self.answered() > 0).then_some(0.0) }
    }

    fn is_asked(&self) -> bool {
        self.temporal == Temporal::Whole || self.holds
    }
}

/// Scores under the protocols of others, 0 to 1; none where nothing is to be averaged.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Scores {
    /// LangSplat and LangSplatV2, "iou chosen": mean over all pairs of frame and sentence of a scene.
    pub langsplat_iou: Option<f64>,
    /// LangSplat and LangSplatV2, "Localization accuracy": of the same pairs; only latents tell it.
    pub langsplat_localisation: Option<f64>,
    /// OpenGaussian: the same pairs, share with IoU above 0.25.
    pub opengaussian_acc25: Option<f64>,
    /// OpenGaussian: the same pairs, share with IoU above 0.5.
    pub opengaussian_acc50: Option<f64>,
    /// 4D LangSplat, "Mean IoU": mean over the frames of a sentence, then over sentences; without those about a time.
    pub four_d_langsplat_iou: Option<f64>,
    /// 4D LangSplat, "Average vIoU", over sentences about a time.
    pub four_d_langsplat_viou: Option<f64>,
    /// 4D LangSplat, "Average Accuracy": share of frames in which on and off are right.
    pub four_d_langsplat_acc: Option<f64>,
    /// Gaussian Grouping: mean over the answered frames of a sentence, then over sentences.
    pub gaussian_grouping_iou: Option<f64>,
    /// MeViS: mean J over all frames of a sentence, 1 where neither has a pixel, then over sentences.
    pub mevis_j: Option<f64>,
    /// DAVIS, semi-supervised: the same without the first and the last frame.
    pub davis_j: Option<f64>,
}

/// All scores of the counts of one scene, sorted by sentence and frame.
pub fn scores(counts: &[Count]) -> Scores {
    let by_query: Vec<&[Count]> = counts.chunk_by(|a, b| a.query == b.query).collect();
    let seen = || counts.iter().filter(|count| count.is_asked() && count.visible > 0);
    let pairs: Vec<f64> = seen().filter_map(Count::iou).collect();
    let above = |bound: f64| mean(pairs.iter().map(|&iou| f64::from(u8::from(iou > bound))));
    let of_time = || by_query.iter().filter(|counts| counts[0].temporal == Temporal::While);
    let timeless = || by_query.iter().filter(|counts| counts[0].temporal == Temporal::Whole);
    let present = |count: &&Count| count.visible > 0 && count.is_asked();
    let over_frames = |counts: &[Count]| mean(counts.iter().filter(present).filter_map(Count::iou));
    let answered = |counts: &[Count]| {
        mean(counts.iter().filter(present).filter(|count| count.predicted.is_some()).filter_map(Count::iou))
    };
    let j = |counts: &[Count]| mean(counts.iter().map(|count| count.gated_iou().unwrap_or(1.0)));
    let inner = |counts: &[Count]| counts.get(1..counts.len() - 1).and_then(j);
    Scores {
        langsplat_iou: mean(pairs.iter().copied()),
        langsplat_localisation: None,
        opengaussian_acc25: above(0.25),
        opengaussian_acc50: above(0.5),
        four_d_langsplat_iou: mean(timeless().filter_map(|counts| over_frames(counts))),
        four_d_langsplat_viou: mean(of_time().filter_map(|counts| viou(counts))),
        four_d_langsplat_acc: mean(of_time().filter_map(|counts| accuracy(counts))),
        gaussian_grouping_iou: mean(by_query.iter().filter_map(|counts| answered(counts))),
        mevis_j: mean(by_query.iter().filter_map(|counts| j(counts))),
        davis_j: mean(by_query.iter().filter_map(|counts| inner(counts))),
    }
}

/// Frames in which the referent is annotated: its mask counts whether the sentence holds or not.
fn annotated(counts: &[Count]) -> impl Iterator<Item = &Count> {
    counts.iter().filter(|count| count.visible > 0)
}

/// Over the frames in which the sentence holds or is said to: IoU where both, 0 elsewhere. No such frame: 0.
fn viou(counts: &[Count]) -> Option<f64> {
    annotated(counts).next()?;
    let either = annotated(counts).filter(|count| count.holds || count.answered() > 0);
    let iou =
        |count: &Count| if count.holds && count.answered() > 0 { count.iou().unwrap_or(0.0) } else { 0.0 };
    Some(mean(either.map(iou)).unwrap_or(0.0))
}

fn accuracy(counts: &[Count]) -> Option<f64> {
    mean(annotated(counts).map(|count| f64::from(u8::from(count.holds == (count.answered() > 0)))))
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(
        number: &str,
        frame: u32,
        (visible, holds): (u64, bool),
        predicted: Option<u64>,
        both: u64,
    ) -> Count {
        let temporal = if number == "009" { Temporal::While } else { Temporal::Whole };
        let query = format!("cups/{number}").parse().unwrap();
        Count { query, temporal, frame, visible, holds, predicted, intersection: both }
    }

    /// Two sentences of unequal length, one about a time.
    fn counts() -> Vec<Count> {
        vec![
            count("001", 0, (4, true), Some(4), 4),  // 1
            count("001", 2, (4, true), Some(4), 2),  // 1/3
            count("001", 4, (0, true), Some(0), 0),  // nothing to see, nothing said
            count("002", 0, (4, true), Some(0), 0),  // 0
            count("002", 2, (0, true), Some(3), 0),  // false alarm
            count("002", 4, (0, true), None, 0),     // not answered
            count("009", 0, (4, true), Some(4), 4),  // on, rightly: 1
            count("009", 2, (4, true), Some(0), 0),  // off, wrongly
            count("009", 4, (4, false), Some(4), 4), // on, wrongly
            count("009", 6, (4, false), Some(0), 0), // off, rightly
        ]
    }

    fn near(found: Option<f64>, expected: f64) {
        assert!((found.unwrap() - expected).abs() < 1e-12, "{found:?} is not {expected}");
    }

    #[test]
    fn each_protocol_by_hand() {
        let scores = scores(&counts());
        let third = 1.0 / 3.0;
        // Pairs that are asked for and visible: 1, 1/3, 0, 1, 0.
        near(scores.langsplat_iou, (1.0 + third + 1.0) / 5.0);
        near(scores.opengaussian_acc25, 3.0 / 5.0);
        near(scores.opengaussian_acc50, 2.0 / 5.0);
        near(scores.four_d_langsplat_iou, ((1.0 + third) / 2.0 + 0.0) / 2.0);
        near(scores.four_d_langsplat_viou, third);
        near(scores.four_d_langsplat_acc, 0.5);
        near(scores.gaussian_grouping_iou, ((1.0 + third) / 2.0 + 0.0 + 0.5) / 3.0);
        // 001: 1, 1/3, 1; 002: 0, 0, 1; 009: 1, 0, 0, 1.
        near(scores.mevis_j, ((2.0 + third) / 3.0 + third + 0.5) / 3.0);
        near(scores.davis_j, (third + 0.0 + 0.0) / 3.0);
    }

    #[test]
    fn nothing_to_average_is_no_number() {
        assert_eq!(scores(&[]), Scores::default());
        let unseen = scores(&[count("001", 0, (0, true), None, 0)]);
        assert_eq!((unseen.langsplat_iou, unseen.davis_j), (None, None));
        assert_eq!(unseen.mevis_j, Some(1.0));
    }
}
