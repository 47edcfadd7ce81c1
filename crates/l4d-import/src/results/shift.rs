//! Imported masks against the truth of the benchmark, for one purpose: to notice that frames are counted wrongly.
//!
//! A method whose masks fit the neighbouring frame better was imported with the wrong rule for frames, or rendered
//! another list of cameras. Scores are the judge's business.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::truth::Truth;
use l4d_data::{Query, QueryId, Report};
use l4d_masks::{Mask, Rle, target};

use super::codes;

/// Masks by frame; none where the method says that nothing is there.
pub(super) type Answers = BTreeMap<u32, Option<Rle>>;

/// Where relevancy is highest by query and frame: shares of width and height.
pub(super) type Summits = BTreeMap<(QueryId, u32), [f64; 2]>;

/// A shift that raises the mean IoU by this factor is reported.
const TELLING: f64 = 1.1;
/// From so few pairs of frame and query nothing follows: what is at rest fits every frame.
const FEW: u64 = 6;
/// A mean IoU below this is reported: masks and truth are unrelated.
const HARDLY: f64 = 0.01;

/// Reports that masks fit the frame before or after better, or hardly touch the truth.
pub(super) fn check_frames(truth: &Truth, at: &Path, asked: &[(&Query, &Answers)], report: &mut Report) {
    let Some((now, _)) = mean_iou(truth, asked, 0) else { return };
    for (shift, side) in [(-1, "earlier"), (1, "later")] {
        let is_telling = |(iou, pairs): &(f64, u64)| *pairs >= FEW && *iou > TELLING * now && *iou > HARDLY;
        let Some((iou, _)) = mean_iou(truth, asked, shift).filter(is_telling) else { continue };
        let message = format!(
            "fit the truth of one frame {side} better (mean IoU {:.1} % instead of {:.1} %)",
            100.0 * iou,
            100.0 * now
        );
        let hint = "check how files are numbered: from 0 or 1, by position or by name ({position}, {frame+1}, --frames)";
        report.warning(codes::FRAME_SHIFT, at, "masks", message, hint);
        return;
    }
    if now < HARDLY {
        let message = format!("hardly touch the truth: mean IoU {:.2} %", 100.0 * now);
        let hint = "check that these are masks of the held-out camera, in the right order of frames, and not flipped";
        report.warning(codes::HARDLY_TOUCHES, at, "masks", message, hint);
    }
}

/// Mean IoU over the frames that show a target, each compared with the answer `shift` places before it, and the number
/// of these pairs.
fn mean_iou(truth: &Truth, asked: &[(&Query, &Answers)], shift: isize) -> Option<(f64, u64)> {
    let (mut sum, mut count) = (0.0, 0_u64);
    for (query, answers) in asked {
        for (position, &frame) in truth.frames.iter().enumerate().filter(|(_, frame)| query.asks_at(**frame))
        {
            let target = target::union(truth, &query.referents, frame).filter(|mask| !mask.is_empty());
            let answered = position.checked_add_signed(-shift).and_then(|at| truth.frames.get(at));
            let answer = answered.and_then(|frame| answers.get(frame));
            let (Some(target), Some(answer)) = (target, answer) else { continue };
            let mask = answer.as_ref().map(|mask| Mask::from_rle(mask, truth.width, truth.height));
            sum += mask.and_then(|mask| mask.iou(&target)).unwrap_or(0.0);
            count += 1;
        }
    }
    (count > 0).then(|| (sum / count as f64, count))
}

/// Reports masks that cover nearly everything: any of them is a hit for mAcc.
pub(super) fn check_cover(
    at: &Path,
    size: (u32, u32),
    answers: &BTreeMap<QueryId, Answers>,
    report: &mut Report,
) {
    let pixels = u64::from(size.0) * u64::from(size.1);
    let covers = |mask: &&Rle| mask.area() * 20 > pixels * 19;
    for (query, answers) in answers {
        let full = answers.values().flatten().filter(covers).count();
        if full > 0 {
            let message = format!("{full} masks cover more than 95 % of the picture");
            let hint = "such a mask hits whatever is asked: check that inside and outside are not swapped";
            report.warning(codes::COVERS_ALL, at, format!("query {query}"), message, hint);
        }
    }
}
