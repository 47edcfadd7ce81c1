//! What a protocol sees: one query, frame by frame, with truth and answer.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::{Query, QueryId};
use l4d_masks::Mask;

use crate::judge::Answer;
use crate::truth::{SceneTruth, TruthMask};

/// Where relevancy is highest by query and frame: shares of width and height. Only latents know it.
pub type Summits = BTreeMap<(QueryId, u32), [f64; 2]>;

/// One query over the annotated frames of a clip.
#[derive(Debug)]
pub struct Clip<'a> {
    /// The query.
    pub query: &'a Query,
    /// Its frames, ascending.
    pub seen: Vec<Seen<'a>>,
    /// Whether the method answers anything in the scene.
    pub is_scene_answered: bool,
}

/// One query in one frame.
#[derive(Debug)]
pub struct Seen<'a> {
    /// The frame.
    pub frame: u32,
    /// Whether the sentence holds in the frame; always, if it is about no time.
    pub holds: bool,
    /// What each referent shows of itself, whether the sentence holds or not; those that show nothing are left out.
    pub referents: Vec<&'a TruthMask>,
    /// Their union; none without a pixel.
    pub visible: Option<Cow<'a, TruthMask>>,
    /// What was answered; none where nothing was.
    pub predicted: Option<Cow<'a, Mask>>,
    /// Where relevancy is highest, shares of width and height.
    pub summit: Option<[f64; 2]>,
    /// Pixels of the answer.
    pub answered: u64,
    /// Pixels of the answer within what is visible.
    pub intersection: u64,
}

impl<'a> Clip<'a> {
    /// A query with one answer per annotated frame of the truth.
    pub fn new(
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
                frame,
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
    pub fn present(&self) -> impl Iterator<Item = &Seen<'a>> {
        self.seen.iter().filter(|seen| seen.is_present())
    }
}

impl Seen<'_> {
    /// What is to be found: nothing, while the sentence does not hold.
    pub fn target(&self) -> Option<&TruthMask> {
        self.visible.as_deref().filter(|_| self.holds)
    }

    /// Whether anything is to be found.
    pub fn is_present(&self) -> bool {
        self.target().is_some()
    }

    /// Whether the frame has no answer.
    pub fn is_missing(&self) -> bool {
        self.predicted.is_none()
    }

    /// IoU with what is visible, whether the sentence holds or not; none where neither has a pixel.
    pub fn visible_iou(&self) -> Option<f64> {
        let union = self.visible.as_ref().map_or(0, |mask| mask.area()) + self.answered - self.intersection;
        l4d_masks::iou(self.intersection, union)
    }

    /// IoU with what is to be found; none where neither has a pixel.
    pub fn iou(&self) -> Option<f64> {
        if self.holds { self.visible_iou() } else { (self.answered > 0).then_some(0.0) }
    }
}
