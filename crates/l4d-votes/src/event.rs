//! What an annotator can do with an item.

use std::collections::BTreeSet;

use l4d_data::{Interval, Name};
use serde::{Deserialize, Serialize};

/// What the prompt means, in the eyes of one annotator.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Choice {
    /// These instances, at least one.
    Objects(BTreeSet<Name>),
    /// Nothing in the scene.
    None,
    /// One cannot tell.
    Ambiguous {
        /// Why not.
        reason: String,
    },
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
    /// What.
    pub choice: Choice,
    /// When, canonical frames; the whole clip unless the annotator narrowed it.
    pub frames: Interval,
}

/// One act of an annotator on an item.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Event {
    /// Answers the item; replaces an earlier answer or skip.
    Choose(Answer),
    /// Takes back the latest act on the item that still stands.
    Undo,
    /// Leaves the item without an answer; replaces an earlier answer.
    Skip,
    /// A remark; changes no answer.
    Comment(String),
}

/// What was on the screen before the act.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seen {
    /// Views.
    pub views: BTreeSet<Name>,
    /// Canonical frames.
    pub frames: BTreeSet<u32>,
}
