//! Proposals, and which of them may take part in the vote.

use l4d_ground::{Grounding, ViewClip};
use l4d_masks::Mask;

/// What one view saw, and what it says.
#[derive(Debug, Clone, Copy)]
pub struct Proposal<'a> {
    /// What it saw.
    pub clip: &'a ViewClip,
    /// What it says.
    pub grounding: &'a Grounding,
}

/// What a proposal may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// It is judged, and judges.
    Found,
    Absent,
    NoAnswer,
}

impl<'a> Proposal<'a> {
    /// What each of these views says, in their order.
    pub fn of(clips: &'a [ViewClip], groundings: &'a [Grounding]) -> Vec<Self> {
        clips.iter().zip(groundings).map(|(clip, grounding)| Self { clip, grounding }).collect()
    }

    pub(super) fn part(&self) -> Part {
        // Masks decide which answer it is, whatever the outcome says: what marks nothing cannot be voted on.
        let marks_any = self.marked().iter().any(|&(_, pixels)| pixels > 0);
        match (self.grounding.outcome.is_answer(), marks_any) {
            (false, _) => Part::NoAnswer,
            (true, true) => Part::Found,
            (true, false) => Part::Absent,
        }
    }

    /// What it marks at a frame of its clip, if anything.
    pub(super) fn mask(&self, frame: u32) -> Option<&'a Mask> {
        self.grounding.masks.get(&frame).filter(|mask| !mask.is_empty())
    }

    /// The frames of the clip, with the pixels that it marks in each.
    pub(super) fn marked(&self) -> Vec<(u32, u64)> {
        let pixels = |frame| self.mask(frame).map_or(0, Mask::area);
        self.clip.frame_numbers().map(|frame| (frame, pixels(frame))).collect()
    }
}
