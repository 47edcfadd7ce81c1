//! What was seen as a belief about a scene: boxes over time, odds of nouns and properties, what may happen.
//!
//! Events are not seen by the network: boxes that move tell of them.

use std::collections::BTreeMap;

use l4d_data::Temporal;
use l4d_data::tracks::Tracks;
use l4d_network::Description;
use l4d_query::Predicate;
use l4d_query::soft::{Belief, BeliefError, Noise, Odds, Ranked, Thing, derive, rank};

use super::look::{Looked, log_softmax};
use super::motion::Kinematics;
use super::stage::{name_of, stage};

/// How sharply the mean over glimpses decides: that of several is surer than each.
const KIND_POWER: f32 = 2.0;
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
    tracks: Tracks,
    things: Vec<Thing>,
}

impl Scene {
    /// What is believed of the things of a clip; none if there are none.
    pub(super) fn of(looked: &Looked, description: &Description) -> Option<Self> {
        let seen = &looked.perceived;
        let all: Vec<usize> = (0..seen.tracks.len()).collect();
        if all.is_empty() {
            return None;
        }
        let moves: Vec<Kinematics> = seen.tracks.iter().map(|track| Kinematics::new(track, seen)).collect();
        let thing = |number: &usize| {
            Some(Thing {
                name: name_of(*number)?,
                kinds: kinds(&looked.kinds[*number], description),
                attributes: attributes(&looked.values[*number], description),
                presence: looked.presence[*number],
            })
        };
        let things = all.iter().filter_map(thing).collect();
        Some(Self { tracks: stage(seen, &moves, &all, &all)?, things })
    }

    /// The things that a predicate may mean, the best first.
    pub(super) fn rank(&self, predicate: &Predicate, temporal: Temporal) -> Result<Vec<Ranked>, BeliefError> {
        let events = derive::events(&self.tracks, predicate);
        let noise = Noise::perceived(self.tracks.scale);
        let belief = Belief::new(&self.tracks, self.things.clone(), events, noise)?;
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
