//! The contract of a grounder: what it is asked, and what it may answer.

use std::collections::BTreeMap;

use l4d_data::{DataError, Interval, Name, Query};
use l4d_masks::Mask;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::clip::ViewClip;
use crate::unreadable::Unreadable;

/// What is asked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Question {
    /// Scene of the clip.
    pub scene: Name,
    /// Number of the query within the benchmark; none for a sentence of the user's own.
    pub number: Option<Name>,
    pub text: String,
    /// Frames that the user asks about; none for the whole clip.
    pub range: Option<Interval>,
}

impl From<&Query> for Question {
    fn from(query: &Query) -> Self {
        let Query { id, text, .. } = query;
        Self { scene: id.scene.clone(), number: Some(id.number.clone()), text: text.clone(), range: None }
    }
}

impl Question {
    /// The frames of a clip that the user asks about.
    pub(crate) fn frames<'c>(&self, clip: &'c ViewClip) -> impl Iterator<Item = u32> + use<'c> {
        let range = self.range;
        clip.frame_numbers().filter(move |frame| range.is_none_or(|range| range.contains(*frame)))
    }
}

/// Longer texts are no sentence about a clip, characters.
const LONGEST_SENTENCE: usize = 2000;

/// The sentence without blanks around it, if a model can be asked it.
pub(crate) fn sentence(text: &str) -> Result<&str, Unreadable> {
    let sentence = text.trim();
    let length = sentence.chars().count();
    match length {
        0 => Err(Unreadable::whole("the sentence is empty")),
        1..=LONGEST_SENTENCE => Ok(sentence),
        _ => Err(Unreadable::whole(format!(
            "the sentence has {length} characters, and at most {LONGEST_SENTENCE} are sent"
        ))),
    }
}

/// A question that a model can be asked about a clip.
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
            let (width, height) = (clip.width, clip.height);
            let why = format!("the clip has pictures of {width}x{height} pixels, which cannot be sent");
            return Err(Outcome::Error(why));
        }
        let frames: Vec<u32> = question.frames(clip).collect();
        let ends = frames.first().zip(frames.last()).map(|(first, last)| Interval::new(*first, *last));
        let Some(Ok(whole)) = ends else {
            return Err(Outcome::Error("the clip has no frame that is asked about".to_owned()));
        };
        Ok(Self { sentence, frames, range: question.range.unwrap_or(whole) })
    }
}

/// What came of a question to one view. Only [`Outcome::Found`] and [`Outcome::Absent`] are answers, and may vote.
/// [`Outcome::Unsupported`] says nothing about the view, but is the grounder's last word; after all others it is worth
/// asking again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", content = "why")]
pub enum Outcome {
    /// It is there, in at least one frame.
    Found,
    /// It looked, and says that this view never shows it.
    Absent,
    /// There is a reply, and no sense in it.
    Unparsed(String),
    /// The reply was cut off.
    Truncated,
    /// The model would not say.
    Refused(String),
    /// The grounder cannot read the sentence, and never will.
    Unsupported(Unreadable),
    /// No reply: the connection, the process, the file.
    Error(String),
}

impl Outcome {
    /// Whether it may vote.
    pub fn is_answer(&self) -> bool {
        matches!(self, Self::Found | Self::Absent)
    }

    /// Whether the same grounder would say the same again, so that it is remembered and not asked anew.
    pub fn is_final(&self) -> bool {
        self.is_answer() || matches!(self, Self::Unsupported(_))
    }

    /// A file that failed, in full: where, what, why, and what to do about it.
    pub fn of_data_error(error: &DataError) -> Self {
        let cause = std::error::Error::source(error).map(|cause| format!(": {cause}")).unwrap_or_default();
        Self::Error(format!("{error}{cause}; {}", error.hint()))
    }

    /// What it says beside its word.
    pub fn why(&self) -> Option<String> {
        match self {
            Self::Found | Self::Absent | Self::Truncated => None,
            Self::Unparsed(why) | Self::Refused(why) | Self::Error(why) => Some(why.clone()),
            Self::Unsupported(unread) => Some(unread.to_string()),
        }
    }

    /// One word, as tables show it.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::Absent => "absent",
            Self::Unparsed(_) => "unparsed",
            Self::Truncated => "truncated",
            Self::Refused(_) => "refused",
            Self::Unsupported(_) => "unsupported",
            Self::Error(_) => "error",
        }
    }
}

/// What one view says: a proposal (the paper's M_v).
#[derive(Debug, Clone, PartialEq)]
pub struct Grounding {
    /// What came of it.
    pub outcome: Outcome,
    /// Canonical frame -> what is meant there, at the size of the clip; an empty mask says that it is not seen there.
    /// One for each frame of the clip if the outcome is an answer (absent: all empty), none otherwise.
    pub masks: BTreeMap<u32, Mask>,
    /// How it came about, for people to read; a sentence each.
    pub notes: Vec<String>,
    /// How sure the grounder is; none if it does not say.
    pub choice: Option<Choice>,
}

/// What was taken, and what nearly was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    /// How well the sentence describes what was taken, 0 to 1.
    pub confidence: f64,
    /// The next best; none if nothing else was seen.
    pub runner_up: Option<RunnerUp>,
}

/// What would have been taken next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunnerUp {
    /// The noun that fits it best.
    pub noun: String,
    /// How well the sentence describes it, 0 to 1.
    pub confidence: f64,
}

impl Grounding {
    pub fn without_answer(outcome: Outcome) -> Self {
        Self { outcome, masks: BTreeMap::new(), notes: Vec::new(), choice: None }
    }

    /// An answer: found if any mask has a pixel. Frames of the clip without a mask are taken as empty.
    pub fn of_masks(clip: &ViewClip, mut masks: BTreeMap<u32, Mask>, notes: Vec<String>) -> Self {
        for frame in clip.frame_numbers() {
            masks.entry(frame).or_insert_with(|| Mask::empty(clip.width, clip.height));
        }
        let is_found = masks.values().any(|mask| !mask.is_empty());
        let outcome = if is_found { Outcome::Found } else { Outcome::Absent };
        Self { outcome, masks, notes, choice: None }
    }
}

/// Finds what a sentence means in what one camera shows.
pub trait Grounder: Sync {
    /// Everything that its answers depend on beside clip and question: kind, version, model, settings, seeds. Answers
    /// are kept under its digest.
    fn identity(&self) -> Value;

    /// Whether it looks at the truth. Such answers are marked, and never ranked.
    fn uses_truth(&self) -> bool {
        false
    }

    /// Whether it can read a sentence, as far as that can be told without a clip. Where it cannot, [`Self::ground`]
    /// answers [`Outcome::Unsupported`] in every view.
    ///
    /// # Errors
    /// What it cannot read.
    fn reads(&self, _text: &str) -> Result<(), Unreadable> {
        Ok(())
    }

    /// What it can read, as a list that follows "it knows"; none where that is not limited to a list.
    fn knows(&self) -> Option<String> {
        None
    }

    /// What a sentence may say: what kind of words, and all of them or an example; empty where that is not limited.
    fn words(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// Asks about one view. Every failure is an outcome.
    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding;
}
