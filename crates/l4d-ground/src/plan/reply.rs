//! Reading a plan from a model's reply.
//!
//! Models are asked for one shape and answer in many: a bare list instead of an object, `bbox_2d` beside or above the
//! time, times as text, prose and code fences around the JSON. All shapes with the same content give the same plan.
//! Asks nothing itself, and does not know what a plan is carried out with.

use l4d_endpoint::coordinates::WrittenBox;
use l4d_endpoint::{BoxPx, Convention, EndpointError, Reply, one_line};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::GroundingPlan;
use super::clock::Clock;
use super::objects::numbered;
use crate::grounder::Outcome;

/// Characters of an expression or noun phrase that are passed on; the rest is cut.
const MAX_WORDS_CHARS: usize = 300;
/// Boxes that are read from one reply; what follows is counted only.
const MAX_BOXES: usize = 1024;
/// Characters of a reply that an outcome quotes.
const EXCERPT: usize = 160;

/// What a plan must have to be carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// An expression or a noun phrase.
    Words,
    /// A box in at least one frame.
    Boxes,
}

/// What the model was shown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SentPictures<'a> {
    /// The times at which pictures were sent.
    pub(crate) clock: &'a Clock,
    /// Width and height of the pictures that were sent, pixels.
    pub(crate) size: (u32, u32),
    /// Width and height of the clip, pixels.
    pub(crate) clip: (u32, u32),
    /// How the model writes boxes.
    pub(crate) convention: &'a Convention,
}

/// Reads a plan. The outcome is `Found` if the plan can be carried out, and `Absent` if the model says that the view
/// does not show the referent; with any other outcome the plan is of no use.
pub(crate) fn read(reply: &Reply, wanted: Wanted, pictures: &SentPictures<'_>) -> (Outcome, GroundingPlan) {
    let mut plan = GroundingPlan::default();
    let document = match document(reply) {
        Ok(document) => document,
        Err(outcome) => return (outcome, plan),
    };
    plan.expression = words(&document, &["expression", "referring_expression", "description"]);
    plan.noun_phrase = words(&document, &["noun_phrase", "noun", "phrase"]);
    let outcome = match wanted {
        Wanted::Words => read_words(&document, &mut plan),
        Wanted::Boxes => read_boxes(&document, pictures, &mut plan),
    };
    (outcome, plan)
}

/// The JSON of a reply: an object, or a list of objects.
pub(crate) fn document(reply: &Reply) -> Result<Value, Outcome> {
    match reply.json::<Document>() {
        Ok(Document(document)) => Ok(document),
        Err(EndpointError::Truncated { .. }) => Err(Outcome::Truncated),
        Err(EndpointError::Refused(message)) => Err(Outcome::Refused(one_line(&message, EXCERPT))),
        Err(EndpointError::NoJson { .. }) if is_refusal(&reply.text) => {
            Err(Outcome::Refused(one_line(&reply.text, EXCERPT)))
        }
        Err(error) => Err(Outcome::Unparsed(one_line(&error.to_string(), 2 * EXCERPT))),
    }
}

/// JSON that can be a plan. Other JSON in a reply, such as the `[1]` of prose, is passed over.
struct Document(Value);

impl<'de> Deserialize<'de> for Document {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        let is_document = match &value {
            Value::Object(_) => true,
            Value::Array(items) => items.iter().all(Value::is_object),
            _ => false,
        };
        let error = || serde::de::Error::custom("is no object and no list of objects");
        if is_document { Ok(Self(value)) } else { Err(error()) }
    }
}

/// Servers mark a refusal; models that were not trained to be marked say it in words.
fn is_refusal(text: &str) -> bool {
    const OPENINGS: [&str; 8] =
        ["i'm sorry", "i am sorry", "sorry,", "i cannot", "i can't", "i can’t", "i'm unable", "as an ai"];
    let text = text.trim_start().to_lowercase().replace('’', "'");
    OPENINGS.iter().any(|opening| text.starts_with(opening))
}

fn read_words(document: &Value, plan: &mut GroundingPlan) -> Outcome {
    match (visible(document), plan.expression.is_empty(), plan.noun_phrase.is_empty()) {
        (Some(false), _, _) => Outcome::Absent,
        (_, true, true) => Outcome::Unparsed("the answer names nothing".to_owned()),
        (_, is_without_expression, is_without_noun) => {
            if is_without_expression {
                plan.expression.clone_from(&plan.noun_phrase);
                plan.notes.push("the answer has no expression; its noun phrase is used".to_owned());
            } else if is_without_noun {
                plan.noun_phrase.clone_from(&plan.expression);
                plan.notes.push("the answer has no noun phrase; its expression is used".to_owned());
            }
            Outcome::Found
        }
    }
}

fn read_boxes(document: &Value, pictures: &SentPictures<'_>, plan: &mut GroundingPlan) -> Outcome {
    let mut boxes = BoxReader { pictures, found: Vec::new(), seen: 0, outside: 0, unusable: 0, timeless: 0 };
    boxes.gather(document, When::Unstated);
    boxes.note(&mut plan.notes);
    let seen = boxes.seen;
    let (keyframes, dropped) = numbered(boxes.found);
    if dropped > 0 {
        plan.notes.push(format!("{dropped} boxes were left out: repeated, or more than a sentence can mean"));
    }
    plan.keyframes = keyframes;
    match (visible(document), seen, plan.keyframes.len()) {
        (Some(false), 0, _) => Outcome::Absent,
        (Some(false), seen, _) => {
            Outcome::Unparsed(format!("the answer says that it is not visible, and gives {seen} boxes"))
        }
        (Some(true), 0, _) => {
            Outcome::Unparsed("the answer says that it is visible, and gives no boxes".to_owned())
        }
        (None, 0, _) if is_empty_list(document) => Outcome::Absent,
        (None, 0, _) => Outcome::Unparsed("the answer holds no boxes".to_owned()),
        (_, seen, 0) => Outcome::Unparsed(format!("none of {seen} boxes can be used")),
        _ => Outcome::Found,
    }
}

/// Whether the answer is an empty list, with or without an object around it.
fn is_empty_list(document: &Value) -> bool {
    let is_empty = |value: &Value| value.as_array().is_some_and(Vec::is_empty);
    // An empty list of times says nothing about boxes.
    let of_boxes = |(name, value): (&String, &Value)| name != "intervals" && is_empty(value);
    is_empty(document) || document.as_object().is_some_and(|fields| fields.iter().any(of_boxes))
}

fn visible(document: &Value) -> Option<bool> {
    let value = ["visible", "is_visible", "present", "exists"].iter().find_map(|key| document.get(*key))?;
    match value {
        Value::Bool(visible) => Some(*visible),
        Value::String(text) => match text.trim().to_lowercase().as_str() {
            "yes" | "true" => Some(true),
            "no" | "false" => Some(false),
            _ => None,
        },
        _ => None,
    }
}

fn words(document: &Value, keys: &[&str]) -> String {
    let text = keys.iter().find_map(|key| document.get(*key)?.as_str()).unwrap_or_default();
    one_line(text, MAX_WORDS_CHARS)
}

/// Which picture a part of an answer is about.
#[derive(Clone, Copy)]
enum When {
    /// It does not say.
    Unstated,
    /// The one at this canonical frame.
    At(u32),
    /// It says a time at which no picture was sent.
    NotSent,
}

/// Collects the boxes of an answer, wherever in it they are.
struct BoxReader<'a> {
    pictures: &'a SentPictures<'a>,
    /// Canonical frames, and boxes in pixels of the clip.
    found: Vec<(u32, BoxPx)>,
    /// All boxes of the answer.
    seen: usize,
    /// Boxes that reach beyond the range of the convention.
    outside: usize,
    /// Boxes without an area inside the picture.
    unusable: usize,
    /// Boxes of no picture that was sent.
    timeless: usize,
}

impl BoxReader<'_> {
    /// Goes through a part of the answer; the time in an object holds for everything inside it.
    fn gather(&mut self, value: &Value, when: When) {
        match value {
            Value::Array(items) => items.iter().for_each(|item| self.gather(item, when)),
            Value::Object(fields) => {
                let when = self.time(fields).unwrap_or(when);
                if let Some(written) = WrittenBox::of(value) {
                    self.take(written.numbers, when);
                } else {
                    for (name, field) in fields {
                        // Some answers use the time as a key.
                        let named = self.pictures.clock.frame(&Value::from(name.as_str()));
                        self.gather(field, named.map_or(when, When::At));
                    }
                }
            }
            _ => {}
        }
    }

    fn time(&self, fields: &Map<String, Value>) -> Option<When> {
        const KEYS: [&str; 7] = ["time", "timestamp", "second", "seconds", "frame", "frame_index", "image"];
        let time = KEYS.iter().find_map(|key| fields.get(*key))?;
        Some(self.pictures.clock.frame(time).map_or(When::NotSent, When::At))
    }

    /// Adds a box, converted from the model's convention to pixels of the clip.
    fn take(&mut self, numbers: [f64; 4], when: When) {
        let Some(frame) = self.admit(when) else { return };
        let SentPictures { size: sent, clip, convention, .. } = *self.pictures;
        self.outside += usize::from(!convention.holds(numbers, sent));
        let Some(BoxPx { x0, y0, x1, y1 }) = convention.pixels(numbers, sent) else {
            self.unusable += 1;
            return;
        };
        let [x, y] = [f64::from(clip.0) / f64::from(sent.0), f64::from(clip.1) / f64::from(sent.1)];
        self.found.push((frame, BoxPx { x0: x0 * x, y0: y0 * y, x1: x1 * x, y1: y1 * y }));
    }

    /// Counts a box and gives its canonical frame; none if that is unknown, or after [`MAX_BOXES`] boxes.
    fn admit(&mut self, when: When) -> Option<u32> {
        self.seen += 1;
        if self.seen > MAX_BOXES {
            return None;
        }
        let frame = match (when, self.pictures.clock.0.as_slice()) {
            (When::At(frame), _) => Some(frame),
            // With a single picture there is no other that could be meant.
            (When::Unstated, [only]) => Some(*only),
            _ => None,
        };
        self.timeless += usize::from(frame.is_none());
        frame
    }

    /// Says in `notes` what was left out or cut.
    fn note(&self, notes: &mut Vec<String>) {
        let of = format!("of {} boxes", self.seen);
        if self.seen > MAX_BOXES {
            notes.push(format!("only {MAX_BOXES} {of} were read"));
        }
        if self.timeless > 0 {
            notes.push(format!("{} {of} belong to no picture that was sent", self.timeless));
        }
        if self.unusable > 0 {
            notes.push(format!("{} {of} have no area inside the picture", self.unusable));
        }
        if self.outside > 0 {
            let name = &self.pictures.convention.name;
            notes.push(format!(
                "{} {of} leave the range of `{name}` and were cut; if that happens often, another of the `coordinates` \
                 of docs/endpoints.md is right for this model",
                self.outside
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_are_known_by_their_opening() {
        assert!(is_refusal("I'm sorry, but I can't help with identifying people."));
        assert!(is_refusal("I can’t do that."));
        assert!(!is_refusal("The cup is sorry to see."));
    }
}
