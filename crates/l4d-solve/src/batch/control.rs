//! Runs that take away what an answer should rest on. What is still right then was not seen, or not read.

use l4d_data::Query;
use l4d_ground::{Question, ViewClip};
use serde::Deserialize;

/// What is taken away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Control {
    /// All pictures are of one grey; depth stays.
    BlankPictures,
    /// Each query is answered by the sentence of another query about the same scene.
    ShuffledSentences,
}

/// Display colour of a blank picture.
const GREY: u8 = 118;

impl Control {
    /// As on the command line and in the names of methods.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::BlankPictures => "blank-pictures",
            Self::ShuffledSentences => "shuffled-sentences",
        }
    }

    /// The clips of a view as they are shown.
    pub(super) fn on_clip(self, clip: &mut ViewClip) {
        if self == Self::BlankPictures {
            clip.frames.iter_mut().for_each(|seen| seen.colour.fill(GREY));
        }
    }

    /// The question as it is asked. `known` are all queries of the scene in the order of the benchmark: sentences are
    /// handed on by half of them, since neighbours often mean the same thing.
    pub(super) fn on_question(self, question: &mut Question, query: &Query, known: &[Query]) {
        if self == Self::ShuffledSentences
            && let Some(place) = known.iter().position(|other| other.id == query.id)
        {
            let shift = (known.len() / 2).max(1);
            question.text.clone_from(&known[(place + shift) % known.len()].text);
        }
    }
}
