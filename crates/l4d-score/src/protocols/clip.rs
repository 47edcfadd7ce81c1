//! What a protocol sees, one query frame by frame with truth and answer, and what it says of it.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::{Query, QueryId};
use l4d_masks::Mask;
use serde::{Deserialize, Serialize};

use crate::judge::Answer;
use crate::truth::{SceneTruth, TruthMask};

/// Where relevancy is highest by query and frame: shares of width and height. Only latents know it.
pub type Summits = BTreeMap<(QueryId, u32), [f64; 2]>;

/// One query over the annotated frames of a clip.
#[derive(Debug)]
pub(super) struct Clip<'a> {
    pub(super) query: &'a Query,
    /// Its frames, ascending.
    pub(super) seen: Vec<Seen<'a>>,
    /// Whether the method answers anything in the scene.
    pub(super) is_scene_answered: bool,
}

/// One query in one frame.
#[derive(Debug)]
pub(super) struct Seen<'a> {
    /// Whether the sentence holds in the frame; always, if it is about no time.
    pub(super) holds: bool,
    /// What each referent shows of itself, whether the sentence holds or not; those that show nothing are left out.
    pub(super) referents: Vec<&'a TruthMask>,
    /// Their union; none without a pixel.
    pub(super) visible: Option<Cow<'a, TruthMask>>,
    /// What was answered; none where nothing was.
    pub(super) predicted: Option<Cow<'a, Mask>>,
    /// Where relevancy is highest, shares of width and height.
    pub(super) summit: Option<[f64; 2]>,
    /// Pixels of the answer.
    pub(super) answered: u64,
    /// Pixels of the answer within what is visible.
    pub(super) intersection: u64,
}

impl<'a> Clip<'a> {
    /// A query with one answer per annotated frame of the truth.
    pub(super) fn new(
        truth: &'a SceneTruth,
        query: &'a Query,
        referents: &[usize],
        answers: &'a [Answer],
        summits: &Summits,
    ) -> Self {
        let see = |(position, answer): (usize, &'a Answer)| {
            let frame = truth.frames[position];
            let visible = truth.union(referents, position);
            let predicted = match answer {
                Answer::Absent => Some(Cow::Owned(Mask::empty(truth.width, truth.height))),
                answer => answer.mask((truth.width, truth.height)),
            };
            let both = |mask: &Cow<'_, Mask>| visible.as_ref().map_or(0, |visible| visible.overlap(mask));
            Seen {
                holds: query.asks_at(frame),
                referents: referents
                    .iter()
                    .filter_map(|&index| truth.instances[index].masks[position].as_ref())
                    .collect(),
                answered: predicted.as_ref().map_or(0, |mask| mask.area()),
                intersection: predicted.as_ref().map_or(0, both),
                summit: summits.get(&(query.id.clone(), frame)).copied(),
                visible,
                predicted,
            }
        };
        let seen = answers.iter().enumerate().map(see).collect();
        Self { query, seen, is_scene_answered: true }
    }

    /// Frames that show what is asked for.
    pub(super) fn present(&self) -> impl Iterator<Item = &Seen<'a>> {
        self.seen.iter().filter(|seen| seen.is_present())
    }
}

impl Seen<'_> {
    /// What is to be found: nothing, while the sentence does not hold.
    pub(super) fn target(&self) -> Option<&TruthMask> {
        self.visible.as_deref().filter(|_| self.holds)
    }

    /// Whether anything is to be found.
    pub(super) fn is_present(&self) -> bool {
        self.target().is_some()
    }

    /// Whether the frame has no answer.
    pub(super) fn is_missing(&self) -> bool {
        self.predicted.is_none()
    }

    /// IoU with what is visible, whether the sentence holds or not; none where neither has a pixel.
    pub(super) fn visible_iou(&self) -> Option<f64> {
        let union = self.visible.as_ref().map_or(0, |mask| mask.area()) + self.answered - self.intersection;
        l4d_masks::iou(self.intersection, union)
    }

    /// IoU with what is to be found; none where neither has a pixel.
    pub(super) fn iou(&self) -> Option<f64> {
        if self.holds { self.visible_iou() } else { (self.answered > 0).then_some(0.0) }
    }
}

/// A mean over frames of one query, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    pub mean: f64,
    /// Frames that it rests on.
    pub frames: u64,
}

impl Value {
    /// The mean of some values; none without any.
    pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut frames = 0;
        let mean = crate::metrics::mean(values.into_iter().inspect(|_| frames += 1))?;
        Some(Self { mean, frames })
    }

    /// The share of frames for which something holds.
    pub fn share(values: impl IntoIterator<Item = bool>) -> Option<Self> {
        Self::mean(values.into_iter().map(|holds| f64::from(u8::from(holds))))
    }

    /// A number that is of the whole clip.
    pub fn whole(mean: f64, frames: usize) -> Self {
        Self { mean, frames: frames as u64 }
    }
}

/// What the source leaves out or counts without an answer, and how much of it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LeftOut {
    pub what: Cow<'static, str>,
    /// Queries that are concerned.
    pub queries: u64,
    /// Frames that are concerned.
    pub frames: u64,
}

/// What a protocol says of one query.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QueryScores {
    /// One value a measure of the protocol; none where the query has none.
    pub values: Vec<Option<Value>>,
    /// What was left out.
    pub left_out: Vec<LeftOut>,
}

impl QueryScores {
    /// Values without anything left out.
    pub fn new(values: impl IntoIterator<Item = Option<Value>>) -> Self {
        Self { values: values.into_iter().collect(), left_out: Vec::new() }
    }

    /// Tells that frames were left out, if there were any.
    pub fn leaving_out(mut self, what: &'static str, frames: usize) -> Self {
        if frames > 0 {
            self.left_out.push(LeftOut { what: what.into(), queries: 1, frames: frames as u64 });
        }
        self
    }
}
