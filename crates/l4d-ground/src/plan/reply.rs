//! Reading a plan from a model's reply.
//!
//! Models are asked for one shape and answer in many: a bare list instead of an object, `bbox_2d` beside or above the
//! time, times as text, prose and fences around it. Whatever says the same is read the same way.

use l4d_endpoint::coordinates::WrittenBox;
use l4d_endpoint::{BoxPx, Convention, EndpointError, Reply, one_line};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::GroundingPlan;
use super::clock::Clock;
use super::objects::numbered;
use crate::grounder::Outcome;

/// Longest words that are passed on, characters; the rest is cut.
const LONGEST_WORDS: usize = 300;
/// No answer says more of boxes; what follows is not read.
const MOST_PLACES: usize = 1024;
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
    /// Labels of the pictures.
    pub(crate) clock: &'a Clock,
    /// Width and height of the pictures that were sent, pixels.
    pub(crate) size: (u32, u32),
    /// Width and height of the clip, pixels.
    pub(crate) clip: (u32, u32),
    /// How the model writes boxes.
    pub(crate) convention: &'a Convention,
}

/// Reads a plan. The outcome is found if it can be carried out, and absent if the model says that the view does not
/// show it; otherwise the plan is without use.
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

/// What a reply's JSON may be. Numbers in brackets, as prose has them, are passed over.
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
    let mut places = Places { pictures, found: Vec::new(), seen: 0, outside: 0, unusable: 0, timeless: 0 };
    places.gather(document, When::Unsaid);
    places.note(&mut plan.notes);
    let seen = places.seen;
    let (keyframes, dropped) = numbered(places.found);
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

/// Whether the answer is a list of nothing, with or without an object around it.
fn is_empty_list(document: &Value) -> bool {
    let is_empty = |value: &Value| value.as_array().is_some_and(Vec::is_empty);
    // Times at which nothing holds say nothing about places.
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
    one_line(text, LONGEST_WORDS)
}

/// Which picture a part of an answer speaks of.
#[derive(Clone, Copy)]
enum When {
    /// It does not say.
    Unsaid,
    /// This canonical frame.
    At(u32),
    /// A time at which no picture was sent.
    Nowhere,
}

/// Boxes of an answer, in whatever place.
struct Places<'a> {
    pictures: &'a SentPictures<'a>,
    found: Vec<(u32, BoxPx)>,
    seen: usize,
    outside: usize,
    unusable: usize,
    timeless: usize,
}

impl Places<'_> {
    /// Goes through the answer; a time counts for everything inside its object.
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
        Some(self.pictures.clock.frame(time).map_or(When::Nowhere, When::At))
    }

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

    /// The frame of one more place, if it is known and there is room.
    fn admit(&mut self, when: When) -> Option<u32> {
        self.seen += 1;
        if self.seen > MOST_PLACES {
            return None;
        }
        let frame = match (when, self.pictures.clock.0.as_slice()) {
            (When::At(frame), _) => Some(frame),
            // There is no other that could be meant.
            (When::Unsaid, [only]) => Some(*only),
            _ => None,
        };
        self.timeless += usize::from(frame.is_none());
        frame
    }

    fn note(&self, notes: &mut Vec<String>) {
        let of = format!("of {} boxes", self.seen);
        if self.seen > MOST_PLACES {
            notes.push(format!("only {MOST_PLACES} {of} were read"));
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
