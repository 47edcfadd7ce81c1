//! What a question must be before a model is asked.

use l4d_data::Interval;
use l4d_masks::Mask;

use crate::clip::ViewClip;
use crate::grounder::{Outcome, Question};
use crate::unread::Unread;

/// Longer texts are no sentence about a clip, characters.
const LONGEST_SENTENCE: usize = 2000;

/// The sentence without blanks around it, if a model can be asked it.
pub(crate) fn sentence(text: &str) -> Result<&str, Unread> {
    let sentence = text.trim();
    if sentence.is_empty() {
        return Err(Unread::whole("the sentence is empty"));
    }
    let length = sentence.chars().count();
    if length > LONGEST_SENTENCE {
        let why = format!("the sentence has {length} characters, and at most {LONGEST_SENTENCE} are sent");
        return Err(Unread::whole(why));
    }
    Ok(sentence)
}

/// A question that can be asked of a clip.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CheckedQuestion<'a> {
    /// The sentence without blanks around it.
    pub(crate) sentence: &'a str,
    /// The frames of the clip that are asked about, ascending; at least one.
    pub(crate) frames: Vec<u32>,
    /// What is asked about, in canonical frames.
    pub(crate) range: Interval,
}

impl<'a> CheckedQuestion<'a> {
    /// Checks question and clip; the outcome says why there is nothing to ask.
    pub(crate) fn new(clip: &ViewClip, question: &'a Question) -> Result<Self, Outcome> {
        let sentence = sentence(&question.text).map_err(Outcome::Unsupported)?;
        if !Mask::is_sane_size(clip.width, clip.height) {
            let size = format!("{}x{}", clip.width, clip.height);
            return Err(Outcome::Error(format!(
                "the clip has pictures of {size} pixels, which cannot be sent"
            )));
        }
        let frames: Vec<u32> = clip.frame_numbers().filter(|frame| question.asks_about(*frame)).collect();
        let ends = frames.first().zip(frames.last()).map(|(first, last)| Interval::new(*first, *last));
        let Some(Ok(whole)) = ends else {
            return Err(Outcome::Error("the clip has no frame that is asked about".to_owned()));
        };
        Ok(Self { sentence, frames, range: question.range.unwrap_or(whole) })
    }
}
