//! Parts of seeing and reading that are taken from the truth, to measure what each of them costs.
//!
//! Answers that were helped so are marked as using the truth, and are never ranked.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use l4d_data::tracks::Tracks;
use l4d_data::{DataError, Name, Query, Temporal};
use l4d_query::Predicate;
use l4d_query::soft::{Belief, BelievedEvent, Noise, Odds, Thing};
use serde::{Deserialize, Serialize};

use super::believe::Scene;
use super::tracks::name_of;
use crate::clip::ViewClip;
use crate::oracle::IdSource;

/// What may be taken from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// What the sentence means.
    Reading,
    /// Which pixels are one thing, in all views and at all times, and where it is.
    Things,
    /// What each is called.
    Kinds,
    /// What each looks like.
    Attributes,
    /// Who does what.
    Events,
}

/// The truth about a scene, and which parts of it are given away.
pub struct Given {
    parts: BTreeSet<Part>,
    tracks: Tracks,
    ids: Arc<dyn IdSource>,
    meanings: BTreeMap<Name, (Predicate, Temporal)>,
}

impl Given {
    /// These parts of what is true of a scene: its tracks, its ids, the meanings of its queries.
    ///
    /// # Errors
    /// A query whose predicate cannot be read.
    pub fn new(
        parts: BTreeSet<Part>,
        tracks: Tracks,
        ids: Arc<dyn IdSource>,
        queries: &[Query],
    ) -> Result<Self, serde_json::Error> {
        let meaning = |query: &Query| {
            let predicate = query.predicate.clone()?;
            let meaning = serde_json::from_value(predicate).map(|predicate| (predicate, query.temporal));
            Some(meaning.map(|meaning| (query.id.number.clone(), meaning)))
        };
        let meanings = queries.iter().filter_map(meaning).collect::<Result<_, _>>()?;
        Ok(Self { parts, tracks, ids, meanings })
    }

    pub(super) fn gives(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }

    pub(super) fn parts(&self) -> &BTreeSet<Part> {
        &self.parts
    }

    pub(super) fn instances(&self) -> usize {
        self.tracks.instances.len()
    }

    /// What a query means, if that is given.
    pub(super) fn meaning(&self, query: Option<&Name>) -> Option<&(Predicate, Temporal)> {
        self.meanings.get(query?).filter(|_| self.gives(Part::Reading))
    }

    /// For each pixel of a picture the number of the instance that it shows, from 1; 0 for none.
    pub(super) fn labels(&self, clip: &ViewClip, frame: u32) -> Result<Vec<u32>, DataError> {
        let mut labels = vec![0; clip.width as usize * clip.height as usize];
        for (number, instance) in self.tracks.instances.iter().enumerate() {
            let mask = self.ids.pixels_of(&clip.camera.name, frame, &[instance.id])?;
            for (column, row) in mask.pixels() {
                if let Some(label) = labels.get_mut(row as usize * clip.width as usize + column as usize) {
                    *label = number as u32 + 1;
                }
            }
        }
        Ok(labels)
    }

    /// Puts what is given in the place of what is believed. `instance_of` has the number of the instance that each thing
    /// is, if it is one.
    pub(super) fn correct(&self, scene: &mut Scene, instance_of: &[Option<usize>]) {
        let Ok(truth) = Belief::certain(&self.tracks) else { return };
        for (number, instance) in instance_of.iter().enumerate() {
            let Some((name, instance)) = name_of(number).zip(*instance) else { continue };
            let own = &self.tracks.instances[instance].name;
            let Some(known) = truth.things().find(|known| known.name == *own) else { continue };
            if self.gives(Part::Things) && scene.things.iter().all(|thing| thing.name != name) {
                // No view shows it, so that the network says nothing of it.
                let unknown = Thing {
                    kinds: Odds::new(),
                    attributes: BTreeMap::new(),
                    presence: 1.0,
                    name: name.clone(),
                };
                scene.things.push(unknown);
            }
            let Some(thing) = scene.things.iter_mut().find(|thing| thing.name == name) else { continue };
            if self.gives(Part::Kinds) {
                thing.kinds = known.kinds.clone();
            }
            if self.gives(Part::Attributes) {
                thing.attributes = known.attributes.clone();
            }
            if self.gives(Part::Things) {
                thing.presence = 1.0;
            }
        }
        let name_of = |name: &Name| {
            let number = self.tracks.instances.iter().position(|instance| instance.name == *name)?;
            name_of(instance_of.iter().position(|instance| *instance == Some(number))?)
        };
        if self.gives(Part::Events) {
            let event = |event: &BelievedEvent| {
                let object = event.object.as_ref().map(name_of);
                let subject = name_of(&event.subject)?;
                Some(BelievedEvent {
                    subject,
                    object: object.map_or(Some(None), |name| name.map(Some))?,
                    ..event.clone()
                })
            };
            scene.events = Some(truth.events().iter().filter_map(event).collect());
        }
        if self.gives(Part::Things) {
            let mut tracks = self.tracks.clone();
            tracks
                .instances
                .retain_mut(|instance| name_of(&instance.name).map(|name| instance.name = name).is_some());
            tracks.pairs.retain_mut(|pair| {
                let names = name_of(&pair.a).zip(name_of(&pair.b));
                names.map(|names| (pair.a, pair.b) = names).is_some()
            });
            tracks.events.clear();
            scene.tracks = tracks;
            scene.noise = Noise::NONE;
        }
    }
}
