//! What an annotator can say about an item.

use std::collections::BTreeSet;

use l4d_data::{Interval, Name};
use serde::{Deserialize, Serialize};

/// No clip is longer; keeps arithmetic on frames far from its limits.
const MAX_FRAME: u32 = 999_999;
/// Longest reason or comment.
const MAX_REMARK_BYTES: usize = 2000;

/// What the prompt means, in the eyes of one annotator.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Choice {
    /// These instances, at least one.
    Objects(BTreeSet<Name>),
    /// Nothing in the scene.
    None,
    /// One cannot tell.
    Ambiguous { reason: String },
}

impl Choice {
    /// The choice as one word: sorted names joined by `+`, `(none)` or `(ambiguous)`. No instance can have such a
    /// name as the last two.
    pub fn label(&self) -> String {
        match self {
            Self::Objects(objects) => objects.iter().map(Name::as_str).collect::<Vec<_>>().join("+"),
            Self::None => "(none)".to_owned(),
            Self::Ambiguous { .. } => "(ambiguous)".to_owned(),
        }
    }
}

/// A choice and when it holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    pub choice: Choice,
    /// When, canonical frames; the whole clip unless the annotator narrowed it.
    pub frames: Interval,
}

/// One event of an annotator on an item.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum Event {
    /// Answers the item; replaces an earlier answer or skip.
    Choose(Answer),
    /// Takes back the latest event on the item that was not taken back yet.
    Undo,
    /// Leaves the item without an answer; replaces an earlier answer.
    Skip,
    /// A remark; changes no answer.
    Comment { text: String },
}

/// What was on the screen before the event.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShownFrames {
    pub views: BTreeSet<Name>,
    /// Canonical frames.
    pub frames: BTreeSet<u32>,
}

/// What one annotator says about one item, after all events.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Response {
    /// The answer that counts.
    pub answer: Option<Answer>,
    /// Whether the item was skipped.
    pub skipped: bool,
    /// The latest answer to an earlier wording or scene, where neither an answer nor a skip counts.
    pub stale: Option<Answer>,
    /// Comments that were not taken back, oldest first.
    pub comments: Vec<String>,
}

impl Response {
    /// Neither answered nor skipped.
    pub fn is_open(&self) -> bool {
        self.answer.is_none() && !self.skipped
    }
}

impl Event {
    /// What no log may hold, whatever program writes it.
    pub(crate) fn problem(&self) -> Option<&'static str> {
        let is_remark = |text: &str| {
            !text.trim().is_empty() && text.len() <= MAX_REMARK_BYTES && !text.chars().any(char::is_control)
        };
        match self {
            Self::Choose(answer) if answer.frames.last() > MAX_FRAME => {
                Some("the frames lie beyond any clip")
            }
            Self::Choose(Answer { choice: Choice::Objects(objects), .. }) if objects.is_empty() => {
                Some("no object is chosen: choose one, or none")
            }
            Self::Choose(Answer { choice: Choice::Ambiguous { reason }, .. }) if !is_remark(reason) => {
                Some("a reason is one line of at most 2000 bytes")
            }
            Self::Comment { text } if !is_remark(text) => Some("a comment is one line of at most 2000 bytes"),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_are_one_bounded_line() {
        let problem = |text: &str| Event::Comment { text: text.to_owned() }.problem();
        for text in ["", "  ", "a\nb", "\u{1b}[2J", &"x".repeat(2001)] {
            assert!(problem(text).is_some(), "{text:?}");
        }
        assert!(problem(&"x".repeat(2000)).is_none());
    }
}
