//! A grounding plan: what a model says of one view, in the terms that segmenters take.
//!
//! This module owns the plan and its reading from a model's reply, whatever surrounds it or is missing in it. How a
//! model is asked and what a segmenter makes of a plan is not known here. Nothing is guessed: what cannot be read is
//! told apart from "it is not there".

mod clock;
mod objects;
mod reply;
#[cfg(test)]
mod tests;

use l4d_data::Interval;

pub(crate) use clock::Clock;
pub(crate) use reply::{SentPictures, Wanted, clean, document, intervals, read};

use crate::grounder::Outcome;

/// What a model says of one view. A segmenter takes the parts that it understands.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroundingPlan {
    /// Words that tell the target from everything else in this view; empty if none were given.
    pub(crate) expression: String,
    /// What kind of thing it is, in a few words; empty if none were given.
    pub(crate) noun_phrase: String,
    /// Where it is, by ascending frame and object.
    pub(crate) keyframes: Vec<Keyframe>,
    /// When the query holds, canonical frames; empty if nothing was said.
    pub(crate) intervals: Vec<Interval>,
    /// What a person who relies on the plan should know.
    pub(crate) notes: Vec<String>,
}

/// Where one object is in one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Keyframe {
    /// Canonical frame.
    pub(crate) frame: u32,
    /// Which of the objects that are meant, from 1: boxes of an object in several frames share it.
    pub(crate) object: u32,
    /// Left, upper, right and lower edge, pixels of the clip; `x0 < x1`, `y0 < y1`, inside the picture.
    pub(crate) box_px: Option<[f64; 4]>,
    /// Places on it: column and row, pixels of the clip.
    pub(crate) points_px: Vec<[f64; 2]>,
}

/// A reply, read.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    /// Found if the plan can be carried out; absent if the model says that the view does not show it.
    pub(crate) outcome: Outcome,
    /// What was read; without use unless the outcome is found.
    pub(crate) plan: GroundingPlan,
}

impl GroundingPlan {
    /// How many frames have a box or a point.
    pub(crate) fn frame_count(&self) -> usize {
        let mut frames: Vec<u32> = self.keyframes.iter().map(|keyframe| keyframe.frame).collect();
        frames.dedup();
        frames.len()
    }

    /// Whether the query holds at a frame, as far as the plan says.
    pub(crate) fn holds_at(&self, frame: u32) -> bool {
        self.intervals.is_empty() || self.intervals.iter().any(|interval| interval.contains(frame))
    }
}
