//! What is believed of a scene, checked: no number that is none comes further than this.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::Name;
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::{TrackedInstance, Tracks};

use super::degrees::Degrees;
use super::settings::Noise;
use crate::ast::Predicate;
use crate::reading::Happens;
use crate::times::Times;

/// Probabilities by word.
pub type Odds = BTreeMap<String, f64>;

/// What a thing is believed to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    /// Its name in the tracks.
    pub name: Name,
    /// Probability of each noun; empty if nothing is known.
    pub kinds: Odds,
    /// Probability of each value, by property; a property that is left out is unknown.
    pub attributes: BTreeMap<String, Odds>,
    /// Probability that it is there at all.
    pub presence: f64,
}

/// Something that is believed to happen.
#[derive(Debug, Clone, PartialEq)]
pub struct BelievedEvent {
    pub subject: Name,
    pub verb: String,
    pub object: Option<Name>,
    /// How far, when.
    pub degree: Degrees,
}

impl Happens for BelievedEvent {
    type Truth = Degrees;

    fn subject(&self) -> &Name {
        &self.subject
    }

    fn verb(&self) -> &str {
        &self.verb
    }

    fn object(&self) -> Option<&Name> {
        self.object.as_ref()
    }

    fn times(&self) -> Degrees {
        self.degree
    }
}

/// What a name in a predicate stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Meant {
    Thing(Name),
    /// What this describes.
    Such(Predicate),
}

/// Why a belief is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place} {message} ({hint})")]
pub struct BeliefError {
    place: String,
    message: String,
    hint: &'static str,
}

impl BeliefError {
    pub(super) fn new(place: impl Into<String>, message: impl Into<String>, hint: &'static str) -> Self {
        Self { place: place.into(), message: message.into(), hint }
    }
}

/// A scene as it is believed to be.
///
/// Of the tracks only boxes, fronts, roles and distances count: declared categories, attributes and events do not. For
/// pairs that are not listed boxes decide, if `pair_reach_m` is 0.
#[derive(Debug, Clone)]
pub struct Belief<'a> {
    pub(super) tracks: &'a Tracks,
    pub(super) things: BTreeMap<&'a str, Thing>,
    pub(super) events: Vec<BelievedEvent>,
    pub(super) names: BTreeMap<Name, Meant>,
    pub(super) noise: Noise,
}

impl<'a> Belief<'a> {
    /// What is believed of the things of these tracks and of what happens, and how well boxes are known.
    ///
    /// # Errors
    /// Numbers that are none, probabilities beyond 0 and 1, and names of nothing in the tracks.
    pub fn new(
        tracks: &'a Tracks,
        things: Vec<Thing>,
        events: Vec<BelievedEvent>,
        noise: Noise,
    ) -> Result<Self, BeliefError> {
        tracks.instances.iter().try_for_each(check_boxes)?;
        let names: BTreeSet<&str> = tracks.instances.iter().map(|one| one.name.as_str()).collect();
        if names.len() != tracks.instances.len() {
            return Err(BeliefError::new("the tracks", "have a name twice", "number the things"));
        }
        let is_known = |name: &Name, place: &str| {
            let message = format!("names `{name}`, which is not in the tracks");
            let error = || BeliefError::new(place, message, "name things as the tracks do");
            names.get(name.as_str()).copied().ok_or_else(error)
        };
        for pair in &tracks.pairs {
            is_known(&pair.a, "a pair")?;
            is_known(&pair.b, "a pair")?;
            let are_lengths = pair.distance_m.iter().all(|distance| distance.is_finite() && *distance >= 0.0);
            if !are_lengths || !is_per_clip(pair.distance_m.len()) {
                let place = format!("pair {}, {}", pair.a, pair.b);
                return Err(BeliefError::new(place, "has distances that are none", "give 1 or 97 lengths"));
            }
        }
        if !(tracks.pair_reach_m.is_finite() && tracks.pair_reach_m >= 0.0) {
            return Err(BeliefError::new("pair_reach_m", "is no length", "give 0 if nothing is promised"));
        }
        let deviations = [noise.position_m, noise.size, noise.angle_deg, noise.frames];
        if !deviations.iter().all(|deviation| deviation.is_finite() && *deviation >= 0.0) {
            return Err(BeliefError::new("the noise", "is not finite or below 0", "give deviations"));
        }
        let mut by_name = BTreeMap::new();
        for thing in things {
            let name = is_known(&thing.name, "a thing")?;
            check_odds(&thing)?;
            by_name.insert(name, thing);
        }
        for event in &events {
            is_known(&event.subject, "the subject of an event")?;
            event.object.as_ref().map(|object| is_known(object, "the object of an event")).transpose()?;
        }
        Ok(Self { tracks, things: by_name, events, names: BTreeMap::new(), noise })
    }

    /// What names in predicates stand for; of others the noun in the name is taken: `table_1` is a table.
    #[must_use]
    pub fn with_names(mut self, names: BTreeMap<Name, Meant>) -> Self {
        self.names.extend(names);
        self
    }

    /// Everything as the tracks declare it, without doubt.
    ///
    /// # Errors
    /// Boxes and pairs that [`Belief::new`] refuses.
    pub fn certain(tracks: &'a Tracks) -> Result<Self, BeliefError> {
        let sure = |word: &String| BTreeMap::from([(word.clone(), 1.0)]);
        let thing = |one: &TrackedInstance| Thing {
            name: one.name.clone(),
            kinds: sure(&one.category),
            attributes: one.attributes.iter().map(|(key, value)| (key.clone(), sure(value))).collect(),
            presence: 1.0,
        };
        let events = tracks.events.iter().map(|event| BelievedEvent {
            subject: event.subject.clone(),
            verb: event.verb.clone(),
            object: event.object.clone(),
            degree: Times::of(event.frames).into(),
        });
        let things = tracks.instances.iter().map(thing).collect();
        let names = tracks.instances.iter().map(|one| (one.name.clone(), Meant::Thing(one.name.clone())));
        Ok(Self::new(tracks, things, events.collect(), Noise::NONE)?.with_names(names.collect()))
    }

    /// What is believed of each thing, by name.
    pub fn things(&self) -> impl Iterator<Item = &Thing> {
        self.things.values()
    }

    /// What is believed to happen.
    pub fn events(&self) -> &[BelievedEvent] {
        &self.events
    }
}

fn is_per_clip(count: usize) -> bool {
    count == 1 || count == FRAME_COUNT as usize
}

fn check_boxes(instance: &TrackedInstance) -> Result<(), BeliefError> {
    let track = &instance.track;
    let lists = [
        (track.centre.len(), track.centre.as_flattened()),
        (track.axes.len(), track.axes.as_flattened()),
        (track.extents.len(), track.extents.as_flattened()),
    ];
    let are_numbers = |(_, values): &(usize, &[f64])| values.iter().all(|value| value.is_finite());
    let have_size = track.extents.as_flattened().iter().all(|side| *side >= 0.0);
    if !have_size || !lists.iter().all(|list| is_per_clip(list.0) && are_numbers(list)) {
        let message = "has boxes that are none";
        let hint = "give 1 or 97 boxes of finite numbers, or leave the thing out";
        return Err(BeliefError::new(format!("thing `{}`", instance.name), message, hint));
    }
    Ok(())
}

fn check_odds(thing: &Thing) -> Result<(), BeliefError> {
    let mut odds = thing.kinds.values().chain(thing.attributes.values().flat_map(BTreeMap::values));
    if odds.all(|odds| (0.0..=1.0).contains(odds)) && (0.0..=1.0).contains(&thing.presence) {
        return Ok(());
    }
    let place = format!("thing `{}`", thing.name);
    Err(BeliefError::new(place, "has a probability that is not from 0 to 1", "clamp what is perceived"))
}
