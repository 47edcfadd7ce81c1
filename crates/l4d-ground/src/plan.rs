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

use l4d_endpoint::BoxPx;

pub(crate) use clock::Clock;
pub(crate) use reply::{SentPictures, Wanted, document, read};

/// What a model says of one view. A segmenter takes the parts that it understands.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct GroundingPlan {
    /// Words that tell the target from everything else in this view; empty if none were given.
    pub(crate) expression: String,
    /// What kind of thing it is, in a few words; empty if none were given.
    pub(crate) noun_phrase: String,
    /// Where it is, by ascending frame and object.
    pub(crate) keyframes: Vec<Keyframe>,
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
    /// Inside the picture, pixels of the clip.
    pub(crate) place: BoxPx,
}
