//! Imported masks against the truth of the benchmark, for one purpose: to notice that frames are counted wrongly.
//!
//! A method whose masks fit the neighbouring frame better was imported with the wrong rule for frames, or rendered
//! another list of cameras. Scores are the judge's business.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::truth::Truth;
use l4d_data::{Query, QueryId, Report};
use l4d_masks::target;
use l4d_masks::{Mask, Rle};

use super::codes;

/// Masks by frame; none where the method says that nothing is there.
pub type Answers = BTreeMap<u32, Option<Rle>>;

/// Where relevancy is highest by query and frame: shares of width and height.
pub type Summits = BTreeMap<(QueryId, u32), [f64; 2]>;

/// A shift that raises the mean IoU by this factor is told.
const TELLING: f64 = 1.1;
/// From so few pairs of frame and query nothing follows: what rests fits every frame.
const FEW: u64 = 6;
/// A mean IoU below this is told: masks and truth have nothing to do with each other.
const HARDLY: f64 = 0.01;

/// One query in one frame.
struct Count {
    /// Pixels that the referents show, whether the query holds or not.
    visible: u64,
    /// Whether anything is asked for: the query holds, or is about no time.
    is_asked: bool,
    /// Pixels predicted; none where nothing was answered.
    predicted: Option<u64>,
    /// Pixels of the prediction within what is visible.
    intersection: u64,
}

/// The truth of a scene.
pub struct Judged<'a> {
    truth: &'a Truth,
}

impl<'a> Judged<'a> {
    /// The truth in a file.
    pub fn new(truth: &'a Truth) -> Self {
        Self { truth }
    }

    /// Reports that masks fit the frame before or after better, or hardly touch the truth.
    pub fn check(&self, at: &Path, asked: &[(&Query, &Answers)], report: &mut Report) {
        let [before, now, after] = [-1, 0, 1].map(|shift| self.mean_iou(asked, shift));
        let Some((now, _)) = now else { return };
        for (shift, other) in [(-1, before), (1, after)] {
            let is_telling =
                |(other, pairs): &(f64, u64)| *pairs >= FEW && *other > TELLING * now && *other > HARDLY;
            let Some((other, _)) = other.filter(is_telling) else {
                continue;
            };
            let side = if shift < 0 { "earlier" } else { "later" };
            let message = format!(
                "fit the truth of one frame {side} better (mean IoU {:.1} % instead of {:.1} %)",
                100.0 * other,
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

    /// Mean IoU over the frames that show a target, each compared with the answer `shift` places before it, and the
    /// number of these pairs.
    fn mean_iou(&self, asked: &[(&Query, &Answers)], shift: isize) -> Option<(f64, u64)> {
        let (mut sum, mut count) = (0.0, 0_u64);
        for (query, answers) in asked {
            for frame in self.compared(query, answers, shift) {
                let Some(predicted) = frame.predicted.filter(|_| frame.is_asked && frame.visible > 0) else {
                    continue;
                };
                let union = frame.visible + predicted - frame.intersection;
                sum += frame.intersection as f64 / union as f64;
                count += 1;
            }
        }
        (count > 0).then(|| (sum / count as f64, count))
    }

    fn compared(&self, query: &Query, answers: &Answers, shift: isize) -> Vec<Count> {
        let frames = &self.truth.frames;
        let mut counts = Vec::new();
        for (position, &frame) in frames.iter().enumerate() {
            let target = target::union(self.truth, &query.referents, frame)
                .unwrap_or_else(|| Mask::empty(self.truth.width, self.truth.height));
            // What was answered for a frame is held against the truth `shift` places later.
            let answered = position.checked_add_signed(-shift).and_then(|position| frames.get(position));
            let mask = match answered.and_then(|frame| answers.get(frame)) {
                None => None,
                Some(None) => Some(Mask::empty(self.truth.width, self.truth.height)),
                Some(Some(mask)) => Some(Mask::from_rle(mask, self.truth.width, self.truth.height)),
            };
            counts.push(Count {
                visible: target.area(),
                is_asked: query.asks_at(frame),
                predicted: mask.as_ref().map(Mask::area),
                intersection: mask.map_or(0, |mask| mask.and_count(&target)),
            });
        }
        counts
    }
}

/// Reports masks that cover nearly everything: any of them counts as a hit for mAcc.
pub fn check_cover(at: &Path, size: (u32, u32), answers: &BTreeMap<QueryId, Answers>, report: &mut Report) {
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
