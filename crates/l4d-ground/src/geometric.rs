//! The grounder that needs nothing: no model, no truth, no file.
//!
//! It reads the sentence with a grammar, sees things with a [`Perception`], and asks which of them the sentence
//! describes. One view at a time: what it gets wrong it gets wrong for this view, and other views may vote it down.

pub mod classical;
pub mod kinds;
pub mod lab;
pub mod lexicon;
mod link;
mod looks;
mod motion;
pub mod parse;
pub mod perceive;
mod reason;
mod segment;
pub mod settings;
mod stage;
mod surface;
mod vocabulary;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use l4d_data::digest::sha256_hex;
use l4d_frames::Mask;
use serde_json::{Value, json};

use self::classical::Classical;
use self::lexicon::Lexicon;
use self::parse::{Parsed, parse};
use self::perceive::{Perception, Seen};
use self::settings::ReasonSettings;
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::unread::Unread;

/// Clips whose findings are kept: the views of one scene and some more.
const REMEMBERED: usize = 16;

/// The geometric grounder over some perception.
#[derive(Debug, Default)]
pub struct Geometric<P = Classical> {
    perception: P,
    settings: ReasonSettings,
    /// Digest of a clip -> what is seen in it; the latest last.
    remembered: Mutex<Vec<(String, Arc<Seen>)>>,
}

impl<P: Perception> Geometric<P> {
    /// Over this perception, with the usual thresholds.
    pub fn new(perception: P) -> Self {
        Self::with_settings(perception, ReasonSettings::default())
    }

    /// With other thresholds.
    pub fn with_settings(perception: P, settings: ReasonSettings) -> Self {
        Self { perception, settings, remembered: Mutex::default() }
    }

    /// What is seen in a clip: worked out once, then remembered for the other questions.
    pub fn prepare(&self, clip: &ViewClip) -> Arc<Seen> {
        let digest = digest_of(clip);
        let known = |entries: &[(String, Arc<Seen>)]| {
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

impl<P: Perception> Grounder for Geometric<P> {
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
        let seen = self.prepare(clip);
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
