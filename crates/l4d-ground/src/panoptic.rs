//! The grounder that sees: a trained network finds things and says what they may be, the sentence is read, and the
//! predicate is judged by degrees on what was seen.
//!
//! One view at a time, as in the paper: what it gets wrong it gets wrong for this view, and other views may vote it
//! down. Owns no rule of English and no meaning of a clause: `l4d-english` reads, `l4d-query` judges.

mod believe;
mod bodies;
mod cluster;
mod elements;
mod fused;
mod given;
mod lab;
mod link;
mod look;
mod motion;
mod perceive;
mod surface;
mod tracks;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use l4d_data::store::read_bounded;
use l4d_data::{Role, StageError, Temporal};
use l4d_english::{Reading, Unread, Vocabulary, Words, examples, understand};
use l4d_masks::Mask;
use l4d_network::{Description, Network, WeightsError};
use l4d_query::soft::Ranked;
use l4d_query::verbs;
use serde_json::{Value, json};

pub use self::elements::GaussianProjector;
pub use self::fused::Fused;
pub use self::given::{Given, Part};

use self::believe::Scene;
use self::lab::LabTable;
use self::look::{Looked, Things, look};
use crate::clip::ViewClip;
use crate::grounder::{Choice, Grounder, Grounding, Outcome, Question, RunnerUp};
use crate::remembered::Remembered;
use crate::unreadable::{Reason, Unreadable};

/// Largest file of weights, or description of them.
const MOST_BYTES: u64 = 1 << 28;
/// Things that notes describe.
const TOLD: usize = 3;

/// The panoptic grounder.
pub struct Panoptic {
    network: Network,
    words: Vocabulary,
    table: LabTable,
    remembered: Remembered<Seen>,
}

/// A clip as it is seen, and what is believed of it.
struct Seen {
    looked: Looked,
    /// None if nothing is seen.
    scene: Option<Scene>,
}

impl Panoptic {
    /// The grounder with the weights in a folder: `perception.onnx`, and `perception.json` that describes them.
    ///
    /// # Errors
    /// Files that cannot be read, and weights that cannot be run.
    pub fn open(folder: &Path) -> Result<Self, StageError> {
        let [weights, described] = ["perception.onnx", "perception.json"].map(|name| folder.join(name));
        let description = read_bounded(&described, MOST_BYTES)?;
        let description = String::from_utf8_lossy(&description);
        let bytes = read_bounded(&weights, MOST_BYTES)?;
        Network::load(bytes, &description)
            .map(Self::of)
            .map_err(|error| unusable(format!("{}: {error}", weights.display())))
    }

    /// The grounder with the weights that l4d ships.
    ///
    /// # Errors
    /// None that a tested build can have.
    pub fn shipped() -> Result<Self, StageError> {
        let network = Network::shipped();
        network.map(Self::of).map_err(|error| {
            StageError::new(format!("the shipped weights: {error}"), "build l4d again from a clean checkout")
        })
    }

    fn of(network: Network) -> Self {
        Self {
            words: vocabulary(network.description()),
            network,
            table: LabTable::new(),
            remembered: Remembered::default(),
        }
    }

    /// What a sentence means.
    fn read(&self, text: &str) -> Result<Reading, Unreadable> {
        let words = Words::of_vocabulary(&self.words);
        let mut readings = understand(text, &words).map_err(|unread| match unread {
            Unread::Word(word) => Unreadable::words(Reason::Unknown, [&word]),
            Unread::Unclear { words, .. } if !words.is_empty() => Unreadable::words(Reason::Unknown, &words),
            other => Unreadable::whole(other.to_string()),
        })?;
        let best = readings.swap_remove(0);
        if best.predicate.discriminating().next().is_none() {
            let noun = best.predicate.noun().to_owned();
            return Err(Unreadable::words(Reason::Bare, [&noun]));
        }
        Ok(best)
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, Outcome> {
        let reading = self.read(&question.text).map_err(Outcome::Unsupported)?;
        let seen = self.seen(clip).map_err(|error| Outcome::Error(error.to_string()))?;
        let judged = self.judge(seen.scene.as_ref(), &seen.looked.things, &reading)?;
        let track = judged.best.as_ref().and_then(|best| seen.looked.things.number(&best.name));
        let masks = track.map(|track| seen.looked.masks(track)).unwrap_or_default();
        Ok(judged.shown(clip, masks, question))
    }

    /// Ranks what is seen by how well the sentence describes it.
    fn judge(
        &self,
        scene: Option<&Scene>,
        things: &Things,
        reading: &Reading,
    ) -> Result<Interpretation, Outcome> {
        let (predicate, temporal) = (&reading.predicate, reading.temporal);
        let mut notes = vec![format!("reads the sentence as {predicate}")];
        notes.extend(reading.note());
        let ranked = scene.map(|scene| scene.rank(predicate, temporal)).transpose();
        let ranked = ranked.map_err(|error| Outcome::Error(error.to_string()))?.unwrap_or_default();
        notes.push(format!("sees {} things", things.perceived.tracks.len()));
        let description = self.network.description();
        notes.extend(ranked.iter().take(TOLD).map(|one| told(one, things, description)));
        let runner_up = ranked.get(1).map(|one| RunnerUp {
            noun: things.likeliest(&one.name, description).to_owned(),
            confidence: one.confidence,
        });
        Ok(Interpretation { best: ranked.into_iter().next(), runner_up, temporal, notes })
    }

    fn seen(&self, clip: &ViewClip) -> Result<Arc<Seen>, WeightsError> {
        self.remembered.of(clip, || {
            let looked = look(clip, &self.network, &self.table)?;
            let scene = Scene::of(&looked.things, self.network.description());
            Ok(Seen { looked, scene })
        })
    }
}

impl Grounder for Panoptic {
    fn identity(&self) -> Value {
        json!({
            "kind": "panoptic",
            "version": 2,
            "weights": self.network.description().sha256,
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        self.read(text).map(|_| ())
    }

    fn knows(&self) -> Option<String> {
        let description = self.network.description();
        Some(format!(
            "{} kinds of things and {} of their properties",
            description.kinds.len() - 1,
            description.values.len(),
        ))
    }

    fn words(&self) -> Vec<(String, String)> {
        let Vocabulary { nouns, attributes, verbs } = &self.words;
        let list = |words: Vec<&str>| words.join(", ").replace('_', " ");
        let mut rows = vec![("things".to_owned(), list(nouns.keys().map(String::as_str).collect()))];
        let values = |values: &BTreeSet<String>| list(values.iter().map(String::as_str).collect());
        rows.extend(attributes.iter().map(|(key, all)| (key.clone(), values(all))));
        rows.push(("verbs".to_owned(), list(verbs.iter().map(String::as_str).collect())));
        let quoted = |(what, sentence): (&str, String)| (what.to_owned(), format!("\"{sentence}\""));
        rows.extend(examples(&Words::of_vocabulary(&self.words)).into_iter().map(quoted));
        rows
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        self.answer(clip, question).unwrap_or_else(Grounding::without_answer)
    }
}

/// Weights that cannot be run.
fn unusable(message: String) -> StageError {
    StageError::new(message, "docs/network.md says how weights are made")
}

/// What a sentence means among the things that are seen.
struct Interpretation {
    best: Option<Ranked>,
    runner_up: Option<RunnerUp>,
    temporal: Temporal,
    notes: Vec<String>,
}

impl Interpretation {
    /// The answer in one view, in which these are the pixels of what is meant: those of the times that are meant.
    fn shown(self, clip: &ViewClip, mut masks: BTreeMap<u32, Mask>, question: &Question) -> Grounding {
        let likely = self.best.as_ref().map(|best| best.when.likely());
        let is_meant = |frame: u32| {
            self.temporal == Temporal::Whole
                || likely.as_ref().is_some_and(|likely| likely.at(clip.timeline.canonical(frame)))
        };
        let is_asked = |frame: u32| question.range.is_none_or(|range| range.contains(frame));
        masks.retain(|&frame, _| is_meant(frame) && is_asked(frame));
        let choice = self.best.map(|best| Choice { confidence: best.confidence, runner_up: self.runner_up });
        Grounding { choice, ..Grounding::of_masks(clip, masks, self.notes) }
    }
}

/// The words of a network, and the verbs that boxes may tell of. It says of nothing that it is a mere landmark.
fn vocabulary(description: &Description) -> Vocabulary {
    let mut words = Vocabulary::default();
    words.nouns.extend(description.nouns().map(|noun| (noun.to_owned(), Role::Object)));
    for (key, value) in &description.values {
        words.attributes.entry(key.clone()).or_default().insert(value.clone());
    }
    words.verbs.extend(verbs::lexicon().into_iter().map(str::to_owned));
    words
}

/// A candidate, for people.
fn told(one: &Ranked, things: &Things, description: &Description) -> String {
    let kind = things.likeliest(&one.name, description);
    let clauses: Vec<String> = one.clauses.iter().map(|degree| format!("{degree:.2}")).collect();
    format!("{}, perhaps a {kind}: clauses {}, confidence {:.2}", one.name, clauses.join(" "), one.confidence)
}

#[cfg(test)]
mod tests {
    use half::f16;

    use super::*;
    use crate::testing::{asked_from, clip, sentence};

    /// A tiny network with drawn weights: what it finds means nothing, and is the same every time.
    fn tiny() -> Panoptic {
        Panoptic::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../l4d-network/tests/data")).unwrap()
    }

    /// A wall of coloured stripes a metre away.
    fn wall() -> ViewClip {
        let mut clip = clip(96, 64, &[0, 12, 24, 36]);
        for seen in &mut clip.frames {
            for (column, row, pixel) in seen.colour.enumerate_pixels_mut() {
                *pixel = [(column * 5) as u8, (row * 3) as u8, ((column / 12) * 30) as u8].into();
            }
            seen.depth.depth_m.fill(1.0);
            seen.depth.alpha.fill(f16::ONE);
        }
        clip
    }

    #[test]
    fn a_guess_is_better_than_no_answer_and_always_the_same() {
        let (grounder, question) = (tiny(), sentence("The red cup"));
        let grounding = grounder.ground(&wall(), &question);
        assert_eq!(grounding.outcome, Outcome::Found, "{:?}", grounding.notes);
        assert_eq!(grounding.masks.len(), 4);
        assert!(grounding.notes[0].contains("cup"), "{:?}", grounding.notes);
        assert_eq!(tiny().ground(&wall(), &question), grounding);
        let asked = grounder.ground(&wall(), &asked_from(question, 12, 24));
        assert!(asked.masks[&0].is_empty() && asked.masks[&12] == grounding.masks[&12]);
    }

    /// A wall of Gaussians, one behind each pixel.
    struct Wall;

    impl GaussianProjector for Wall {
        fn gather(&self, _: &ViewClip, _: u32, pixels: &[f32], _: usize) -> Result<Vec<f32>, StageError> {
            Ok(pixels.to_vec())
        }

        fn splat(&self, _: &ViewClip, _: u32, features: &[f32], _: usize) -> Result<Vec<f32>, StageError> {
            Ok(features.to_vec())
        }
    }

    #[test]
    fn views_together_answer_in_each_of_them_and_in_no_other() {
        let (views, question) = ([wall()], sentence("The red cup"));
        let fused = |views: &[ViewClip]| Fused::new(Arc::new(tiny()), views, &Wall, None).unwrap();
        let grounding = fused(&views).ground(&views[0], &question);
        assert_eq!(grounding.outcome, Outcome::Found, "{:?}", grounding.notes);
        assert!(!fused(&views).uses_truth());
        let mut other = wall();
        other.frames[0].depth.depth_m.fill(2.0);
        assert!(matches!(fused(&views).ground(&other, &question).outcome, Outcome::Error(_)));
        assert_ne!(fused(&views).identity(), fused(&[other]).identity());
    }

    #[test]
    fn what_has_no_depth_is_nowhere() {
        let grounding = tiny().ground(&clip(96, 64, &[0, 12]), &sentence("The red cup"));
        assert_eq!(grounding.outcome, Outcome::Absent);
    }

    #[test]
    fn sentences_that_mean_nothing_are_unsupported() {
        let grounder = tiny();
        for text in ["", "the cup", "der rote Eimer neben der Katze", &"very ".repeat(500)] {
            let unread = grounder.reads(text).unwrap_err();
            assert!(!unread.to_string().is_empty());
            let outcome = grounder.ground(&wall(), &sentence(text)).outcome;
            assert!(matches!(outcome, Outcome::Unsupported(_)), "{text:.20}: {outcome:?}");
        }
    }

    #[test]
    fn weights_that_are_not_there_are_named() {
        let error = Panoptic::open(Path::new("/nonexistent")).err().unwrap();
        assert!(error.to_string().contains("perception.json"), "{error}");
    }
}
