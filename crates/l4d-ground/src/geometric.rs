//! The grounder that needs nothing: no model, no truth, no file.
//!
//! It reads the sentence with a grammar, finds things by classical perception, and asks which of them the sentence
//! describes. One view at a time: what it gets wrong it gets wrong for this view, and other views may vote it down.

mod classical;
mod kinds;
pub(crate) mod lab;
mod lexicon;
pub(crate) mod link;
mod looks;
pub(crate) mod motion;
mod parse;
pub(crate) mod perceive;
mod reason;
pub(crate) mod segment;
mod settings;
pub(crate) mod stage;
pub(crate) mod surface;
#[cfg(test)]
mod tests;

use std::convert::Infallible;
use std::sync::Arc;

use serde_json::{Value, json};

use self::classical::perceive;
use self::lab::LabTable;
use self::lexicon::Lexicon;
use self::parse::{Parsed, parse};
use self::perceive::Perceived;
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::remembered::Remembered;
use crate::unreadable::Unreadable;

/// The geometric grounder.
#[derive(Debug, Default)]
pub struct Geometric {
    table: LabTable,
    remembered: Remembered<Perceived>,
}

impl Geometric {
    fn perceived(&self, clip: &ViewClip) -> Arc<Perceived> {
        let seen = self.remembered.of(clip, || Ok::<_, Infallible>(perceive(clip, &self.table)));
        seen.unwrap_or_else(|never| match never {})
    }
}

impl Grounder for Geometric {
    fn identity(&self) -> Value {
        json!({
            "kind": "geometric",
            "version": 2,
            "words": Lexicon::shipped_digest(),
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        // A damaged lexicon is an error of every view, and no fault of the sentence.
        Lexicon::shipped().map_or(Ok(()), |lexicon| understood(lexicon, text).map(|_| ()))
    }

    fn knows(&self) -> Option<String> {
        let lexicon = Lexicon::shipped().ok()?;
        Some(format!(
            "colours, patterns, materials, shapes, sizes, places, {} kinds of things and {} verbs such as walk, run, jump, \
             carry, lift (docs/panopticquery.md#words)",
            lexicon.kind_count(),
            lexicon.verb_count()
        ))
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        let lexicon = match Lexicon::shipped() {
            Ok(lexicon) => lexicon,
            Err(message) => return Grounding::without_answer(Outcome::Error(message)),
        };
        let parsed = match understood(lexicon, &question.text) {
            Ok(parsed) => parsed,
            Err(unread) => return Grounding::without_answer(Outcome::Unsupported(unread)),
        };
        let seen = self.perceived(clip);
        let answer = reason::answer(&seen, lexicon, &parsed);
        let is_asked = |frame: u32| question.range.is_none_or(|range| range.contains(frame));
        let masks = answer.masks.into_iter().filter(|(frame, _)| is_asked(*frame)).collect();
        Grounding::of_masks(clip, masks, answer.notes)
    }
}

/// What a sentence means, if that can be looked for.
fn understood(lexicon: &Lexicon, text: &str) -> Result<Parsed, Unreadable> {
    let parsed = parse(lexicon, text)?;
    match reason::unmeasured(lexicon, &parsed) {
        Some(unread) => Err(unread),
        None => Ok(parsed),
    }
}
