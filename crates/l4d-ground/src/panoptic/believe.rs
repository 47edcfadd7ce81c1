//! What was seen as a belief about a scene: boxes over time, odds of nouns and properties, what may happen.
//!
//! Events are not seen by the network: boxes that move tell of them.

use std::collections::BTreeMap;

use l4d_data::Temporal;
use l4d_data::tracks::Tracks;
use l4d_network::Description;
use l4d_query::Predicate;
use l4d_query::soft::{Belief, BeliefError, BelievedEvent, Noise, Odds, Ranked, Thing, derive, rank};

use super::look::{Things, log_softmax};
use super::tracks::{name_of, tracks_of};

/// How sharply the mean over glimpses decides: that of several is surer than each.
const KIND_POWER: f32 = 1.0;
/// The same of properties.
const VALUE_POWER: f32 = 1.5;
/// Odds below this are dropped.
const LEAST_ODDS: f64 = 1e-4;
/// Share of the odds of being somebody that each noun for people gets: what a person is called is a matter of the scene.
const ANY_PERSON: f64 = 0.25;
/// Nouns for people.
const PEOPLE: [&str; 7] = ["person", "pedestrian", "woman", "man", "child", "cook", "athlete"];

/// Boxes over time and what is believed of the things in them.
pub(super) struct Scene {
    pub(super) tracks: Tracks,
    pub(super) things: Vec<Thing>,
    /// How well boxes are known.
    pub(super) noise: Noise,
    /// What happens, if somebody knows; otherwise boxes tell.
    pub(super) events: Option<Vec<BelievedEvent>>,
}

impl Scene {
    /// What is believed of the things of a clip; none if there are none.
    pub(super) fn of(seen: &Things, description: &Description) -> Option<Self> {
        if seen.perceived.tracks.is_empty() {
            return None;
        }
        let thing = |number: usize| {
            Some(Thing {
                name: name_of(number)?,
                kinds: kinds(&seen.kinds[number], description),
                attributes: attributes(&seen.values[number], description),
                presence: seen.presence[number],
            })
        };
        let things = seen.perceived.placed().filter_map(|(number, _)| thing(number)).collect();
        let noise = Noise::perceived(seen.perceived.scale);
        Some(Self { tracks: tracks_of(&seen.perceived)?, things, noise, events: None })
    }

    /// The things that a predicate may mean, the best first.
    pub(super) fn rank(&self, predicate: &Predicate, temporal: Temporal) -> Result<Vec<Ranked>, BeliefError> {
        let events = self.events.clone().unwrap_or_else(|| derive::events(&self.tracks, predicate));
        let belief = Belief::new(&self.tracks, self.things.clone(), events, self.noise)?;
        Ok(rank(&belief, predicate, temporal))
    }
}

/// Odds of nouns from mean logarithms.
fn kinds(means: &[f32], description: &Description) -> Odds {
    let sharp: Vec<f32> = means.iter().skip(1).map(|value| value * KIND_POWER).collect();
    let odds = log_softmax(&sharp).into_iter().map(|value| f64::from(value.exp()));
    let mut odds: Odds = description.nouns().map(str::to_owned).zip(odds).collect();
    let of = |odds: &Odds, noun: &str| odds.get(noun).copied().unwrap_or(0.0);
    let somebody: f64 = PEOPLE.iter().map(|noun| of(&odds, noun)).sum();
    for noun in PEOPLE {
        let own = of(&odds, noun);
        odds.insert(noun.to_owned(), (1.0 - ANY_PERSON) * own + ANY_PERSON * somebody);
    }
    odds.retain(|_, odds| *odds >= LEAST_ODDS);
    odds.values_mut().for_each(|odds| *odds = odds.clamp(0.0, 1.0));
    odds
}

/// Odds of values, by property.
fn attributes(logits: &[f32], description: &Description) -> BTreeMap<String, Odds> {
    let mut by_key: BTreeMap<&str, Vec<(&str, f32)>> = BTreeMap::new();
    for ((key, value), logit) in description.values.iter().zip(logits) {
        by_key.entry(key).or_default().push((value, logit * VALUE_POWER));
    }
    let odds = |values: Vec<(&str, f32)>| {
        let logits: Vec<f32> = values.iter().map(|(_, logit)| *logit).collect();
        let odds = log_softmax(&logits).into_iter().map(|value| f64::from(value.exp()).clamp(0.0, 1.0));
        values.iter().map(|(value, _)| (*value).to_owned()).zip(odds).collect::<Odds>()
    };
    by_key.into_iter().map(|(key, values)| (key.to_owned(), odds(values))).collect()
}
