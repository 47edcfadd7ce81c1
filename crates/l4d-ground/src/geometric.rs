//! The grounder that needs nothing: no model, no truth, no file.
//!
//! It reads the sentence with a grammar, finds things by [`Classical`] perception, and asks which of them the sentence
//! describes. One view at a time: what it gets wrong it gets wrong for this view, and other views may vote it down.

mod classical;
mod kinds;
mod lab;
mod lexicon;
mod link;
mod looks;
mod motion;
mod parse;
mod perceive;
mod reason;
mod segment;
mod settings;
mod stage;
mod surface;
#[cfg(test)]
mod tests;
mod vocabulary;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use l4d_data::digest::sha256_hex;
use l4d_masks::Mask;
use serde_json::{Value, json};

use self::classical::Classical;
use self::lexicon::Lexicon;
use self::parse::{Parsed, parse};
use self::perceive::Perceived;
use self::settings::ReasonSettings;
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::unread::Unread;

/// Clips whose findings are kept: the views of one scene and some more.
const REMEMBERED: usize = 16;

/// The geometric grounder.
#[derive(Debug, Default)]
pub struct Geometric {
    perception: Classical,
    settings: ReasonSettings,
    /// Digest of a clip -> what is seen in it; the latest last.
    remembered: Mutex<Vec<(String, Arc<Perceived>)>>,
}

impl Geometric {
    /// What is seen in a clip: worked out once, then remembered for the other questions.
    fn perceived(&self, clip: &ViewClip) -> Arc<Perceived> {
        let digest = digest_of(clip);
        let known = |entries: &[(String, Arc<Perceived>)]| {
            entries.iter().find(|(key, _)| *key == digest).map(|(_, seen)| Arc::clone(seen))
        };
        // A panic elsewhere leaves nothing half-written here.
        if let Some(seen) = known(&self.remembered.lock().unwrap_or_else(PoisonError::into_inner)) {
            return seen;
        }
        let seen = Arc::new(self.perception.perceive(clip));
        let mut entries = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if entries.len() >= REMEMBERED {
            entries.remove(0);
        }
        entries.push((digest, Arc::clone(&seen)));
        seen
    }
}

impl Grounder for Geometric {
    fn identity(&self) -> Value {
        json!({
            "kind": "geometric",
            "version": 1,
            "words": Lexicon::shipped_digest(),
            "perception": self.perception.identity(),
            "reasoning": self.settings,
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unread> {
        // A damaged lexicon is an error of every view, and no fault of the sentence.
        Lexicon::shipped().map_or(Ok(()), |lexicon| understood(lexicon, text).map(|_| ()))
    }

    fn knows(&self) -> Option<String> {
        Lexicon::shipped().ok().map(vocabulary::summary)
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
        let answer = reason::answer(&seen, lexicon, &self.settings, &parsed);
        let mut masks: BTreeMap<u32, Mask> = BTreeMap::new();
        for (frame, mask) in answer.masks {
            if question.range.is_none_or(|range| range.contains(frame)) {
                masks.insert(frame, mask);
            }
        }
        Grounding::of_masks(clip, masks, answer.notes)
    }
}

/// What a sentence means, if that can be looked for.
fn understood(lexicon: &Lexicon, text: &str) -> Result<Parsed, Unread> {
    let parsed = parse(lexicon, text)?;
    match reason::unmeasured(lexicon, &parsed) {
        Some(unread) => Err(unread),
        None => Ok(parsed),
    }
}

/// Digest of everything that perception sees.
fn digest_of(clip: &ViewClip) -> String {
    let mut bytes = Vec::new();
    bytes.extend(clip.width.to_le_bytes());
    bytes.extend(clip.height.to_le_bytes());
    let camera = &clip.camera;
    let numbers = [camera.fx, camera.fy, camera.cx, camera.cy];
    let poses = camera.world_from_camera.iter().flatten();
    bytes.extend(numbers.iter().chain(poses).flat_map(|number| number.to_le_bytes()));
    bytes.extend(clip.timeline.duration_s().to_le_bytes());
    for seen in &clip.frames {
        bytes.extend(seen.frame.to_le_bytes());
        bytes.extend(seen.colour.as_raw());
        bytes.extend(seen.depth.depth_m.iter().flat_map(|depth_m| depth_m.to_le_bytes()));
        bytes.extend(seen.depth.alpha.iter().flat_map(|alpha| alpha.to_le_bytes()));
    }
    sha256_hex(&bytes)
}
