//! The grounder that sees: a trained network finds things and says what they may be, the sentence is read, and the
//! predicate is judged by degrees on what was seen.
//!
//! One view at a time, as in the paper: what it gets wrong it gets wrong for this view, and other views may vote it
//! down. Owns no rule of English and no meaning of a clause: `l4d-english` reads, `l4d-query` judges.

mod believe;
mod look;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use l4d_data::Temporal;
use l4d_english::Words;
use l4d_masks::Mask;
use l4d_network::{Network, WeightsError};
use l4d_query::Predicate;
use l4d_query::soft::{Ranked, rank};
use serde_json::{Value, json};

use self::believe::believed;
use self::look::{Looked, look};
use crate::clip::ViewClip;
use crate::geometric::lab::LabTable;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::unreadable::{Reason, Unreadable};

/// Clips whose findings are kept: the views of one scene and some more.
const REMEMBERED: usize = 16;
/// Things that are told of in notes.
const TOLD: usize = 3;

/// The panoptic grounder.
pub struct Panoptic {
    network: Network,
    table: LabTable,
    /// Digest of a clip -> what is seen in it; the latest last.
    remembered: Mutex<Vec<(String, Arc<Looked>)>>,
}

impl Panoptic {
    /// The grounder with these weights.
    ///
    /// # Errors
    /// Weights that cannot be run.
    pub fn new(weights: Vec<u8>, description: &str) -> Result<Self, WeightsError> {
        Ok(Self {
            network: Network::load(weights, description)?,
            table: LabTable::new(),
            remembered: Mutex::default(),
        })
    }

    /// What is seen in a clip: worked out once, then remembered for the other questions.
    fn looked(&self, clip: &ViewClip) -> Result<Arc<Looked>, WeightsError> {
        let digest = clip.digest();
        let known = |entries: &[(String, Arc<Looked>)]| {
            entries.iter().find(|(key, _)| *key == digest).map(|(_, seen)| Arc::clone(seen))
        };
        // A panic elsewhere leaves nothing half-written here.
        if let Some(seen) = known(&self.remembered.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Ok(seen);
        }
        let seen = Arc::new(look(clip, &self.network, &self.table)?);
        let mut entries = self.remembered.lock().unwrap_or_else(PoisonError::into_inner);
        if entries.len() >= REMEMBERED {
            entries.remove(0);
        }
        entries.push((digest, Arc::clone(&seen)));
        Ok(seen)
    }
}

impl Grounder for Panoptic {
    fn identity(&self) -> Value {
        json!({
            "kind": "panoptic",
            "version": 1,
            "weights": self.network.description().sha256,
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        read(text).map(|_| ())
    }

    fn knows(&self) -> Option<String> {
        let description = self.network.description();
        Some(format!(
            "{} kinds of things and {} of their properties (`l4d query SCENE --words` lists them)",
            description.kinds.len() - 1,
            description.values.len(),
        ))
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        let (predicate, temporal) = match read(&question.text) {
            Ok(meant) => meant,
            Err(unread) => return Grounding::without_answer(Outcome::Unsupported(unread)),
        };
        let looked = match self.looked(clip) {
            Ok(looked) => looked,
            Err(error) => return Grounding::without_answer(Outcome::Error(error.to_string())),
        };
        let mut notes = vec![format!("reads the sentence as {predicate}")];
        let ranked = match believed(&looked, self.network.description(), &predicate) {
            Some(tracks) => match tracks.belief() {
                Ok(belief) => rank(&belief, &predicate, temporal),
                Err(error) => return Grounding::without_answer(Outcome::Error(error.to_string())),
            },
            None => Vec::new(),
        };
        notes.push(format!("sees {} things", looked.perceived.tracks.len()));
        notes.extend(ranked.iter().take(TOLD).map(|one| told(one, &looked, self.network.description())));
        let masks = ranked.first().map_or_else(BTreeMap::new, |best| masks_of(best, temporal, &looked));
        let is_asked = |frame: u32| question.range.is_none_or(|range| range.contains(frame));
        let masks = masks.into_iter().filter(|(frame, _)| is_asked(*frame)).collect();
        Grounding::of_masks(clip, masks, notes)
    }
}

/// What a sentence means.
fn read(text: &str) -> Result<(Predicate, Temporal), Unreadable> {
    let (predicate, temporal) = l4d_english::read(text, &Words::all()).map_err(|unread| match unread {
        l4d_english::Unread::Word(word) => Unreadable::words(Reason::Unknown, [&word]),
        other => Unreadable::whole(other.to_string()),
    })?;
    if predicate.discriminating().next().is_none() {
        let noun = predicate.noun().to_owned();
        return Err(Unreadable::words(Reason::Bare, [&noun]));
    }
    Ok((predicate, temporal))
}

/// The masks of the thing that is meant, in the frames in which it is.
fn masks_of(best: &Ranked, temporal: Temporal, looked: &Looked) -> BTreeMap<u32, Mask> {
    let Some(track) = looked.track(&best.name) else { return BTreeMap::new() };
    let likely = best.when.likely();
    let is_open = |frame: u32| {
        temporal == Temporal::Whole || likely.at(looked.perceived.timeline.canonical(frame))
    };
    track
        .seen()
        .map(|(index, glimpse)| (looked.perceived.frames[index], glimpse))
        .filter(|(frame, _)| is_open(*frame))
        .map(|(frame, glimpse)| (frame, glimpse.mask.clone()))
        .collect()
}

/// A candidate, for people.
fn told(one: &Ranked, looked: &Looked, description: &l4d_network::Description) -> String {
    let kind = looked.likeliest(&one.name, description);
    let clauses: Vec<String> = one.clauses.iter().map(|degree| format!("{degree:.2}")).collect();
    format!(
        "{}, perhaps a {kind}: clauses {}, confidence {:.2}",
        one.name,
        clauses.join(" "),
        one.confidence
    )
}
