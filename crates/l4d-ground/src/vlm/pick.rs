//! Choosing among candidates (`pick`).

use l4d_data::Interval;
use l4d_endpoint::{Image, Reply, Request, Schema};
use serde_json::{Value, json};

use super::Settings;
use super::request::{Filling, SentFrames, Template, interval_schema, object_schema, with_pictures};
use crate::grounder::Outcome;
use crate::plan::{Clock, document};
use crate::question::CheckedQuestion;
use crate::worker::{Object, Segmented};

/// More outlines than this hide what they outline.
const MOST_CANDIDATES: usize = 20;

/// What may be meant, numbered from 1 in this order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidates {
    pub(super) objects: Vec<Object>,
    skipped: Vec<String>,
}

/// What a model chose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Choice {
    /// Numbers of candidates, ascending, at least one.
    pub(super) numbers: Vec<usize>,
    pub(super) intervals: Vec<Interval>,
    pub(super) notes: Vec<String>,
}

impl Candidates {
    /// The surest of what was found, without what is never seen.
    pub(super) fn of(found: Segmented, notes: &mut Vec<String>) -> Self {
        let Segmented { mut objects, skipped } = found;
        objects.retain(|object| object.masks.values().any(|mask| !mask.is_empty()));
        if objects.len() > MOST_CANDIDATES {
            notes.push(format!("only the {MOST_CANDIDATES} surest candidates were shown"));
            objects.truncate(MOST_CANDIDATES);
        }
        Self { objects, skipped }
    }

    /// What was chosen of them.
    pub(super) fn chosen(self, numbers: &[usize]) -> Segmented {
        let Self { objects, skipped } = self;
        let chosen = objects.into_iter().zip(1..).filter(|(_, number)| numbers.contains(number));
        Segmented { objects: chosen.map(|(object, _)| object).collect(), skipped }
    }
}

/// The question which of `candidates` candidates is meant.
pub(super) fn request(
    asked: &CheckedQuestion<'_>,
    sent: &SentFrames<'_>,
    pictures: Vec<Image>,
    candidates: usize,
    settings: &Settings,
) -> Request {
    let mut example = json!({ "numbers": [2] });
    let mut properties = json!({
        "numbers": { "type": "array", "items": { "type": "integer", "minimum": 1, "maximum": candidates } },
    });
    interval_schema(settings, &mut example, &mut properties);
    let filling = Filling { candidates, example, ..Filling::of(asked, sent, settings) };
    let text = Template::PICK.fill(&filling);
    with_pictures(pictures, text, Schema::new("choice", object_schema(properties)), settings)
}

/// Reads a choice among `count` candidates.
pub(super) fn read_choice(reply: &Reply, clock: &Clock, count: usize) -> Result<Choice, Outcome> {
    let document = document(reply)?;
    let Some(items) = ["numbers", "ids", "chosen"].iter().find_map(|key| document.get(*key)?.as_array())
    else {
        return Err(Outcome::Unparsed("the answer holds no list of numbers".to_owned()));
    };
    if items.is_empty() {
        return Err(Outcome::Absent);
    }
    let number = |item: &Value| -> Option<usize> {
        let number = item.as_u64().or_else(|| item.as_str()?.trim().parse().ok())?;
        usize::try_from(number).ok().filter(|number| (1..=count).contains(number))
    };
    let mut numbers: Vec<usize> = items.iter().filter_map(number).collect();
    let mut notes = Vec::new();
    if numbers.len() < items.len() {
        notes.push(format!("{} of {} numbers are no candidate's", items.len() - numbers.len(), items.len()));
    }
    if numbers.is_empty() {
        return Err(Outcome::Unparsed(format!("none of {} numbers is a candidate's", items.len())));
    }
    numbers.sort_unstable();
    numbers.dedup();
    let intervals = crate::plan::intervals(&document, clock, &mut notes);
    Ok(Choice { numbers, intervals, notes })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(text: &str) -> Result<Choice, Outcome> {
        read_choice(&Reply::saying(text), &Clock::new(vec![0, 48, 96], Interval::WHOLE), 3)
    }

    #[test]
    fn numbers_of_candidates_are_chosen_and_others_are_told() {
        assert_eq!(choice(r#"{"numbers":[3,1,3]}"#).unwrap().numbers, [1, 3]);
        let some = choice(r#"It is {"ids":["2", 7, -1, "x"]}."#).unwrap();
        assert_eq!((some.numbers, some.notes.len()), (vec![2], 1));
        assert_eq!(choice(r#"{"numbers":[]}"#), Err(Outcome::Absent));
        for nonsense in [r#"{"numbers":[0,4]}"#, r#"{"number":1}"#, "2", ""] {
            assert!(matches!(choice(nonsense), Err(Outcome::Unparsed(_))), "{nonsense}");
        }
        assert_eq!(choice(r#"{"numbers":[1"#), Err(Outcome::Truncated));
    }
}
