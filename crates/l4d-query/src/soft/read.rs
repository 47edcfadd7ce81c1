//! How beliefs answer what the evaluator asks.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use l4d_data::Name;
use l4d_data::tracks::TrackedInstance;

use super::belief::{Belief, BelievedEvent, Meant};
use super::degrees::{Degrees, logistic};
use super::settings::{LEAST_PRESUMED, PARTY_SHARE, RIVAL_SHARE, UNHEARD_OF, WIDER_SHARE, weighed};
use crate::ast::{Clause, Party, Predicate};
use crate::eval::fits;
use crate::nouns::{kinds_of, parents_of};
use crate::reading::{Degree as _, Member, Reading, Unit};
use crate::thresholds::Slack;
use crate::world::World;

/// No box is known better than this, metres, shares and degrees alike.
const LEAST_DEVIATION: f64 = 1e-9;
/// Lengths and volumes whose ratio is taken.
const SIZES: [f64; 2] = [1e-12, 1e12];
/// Fewer than this, and there is nobody to measure a distance to.
const LEAST_MASS: f64 = 1e-6;

/// Whom a party means.
type Meanings<'b> = Rc<Vec<Member<'b, f64>>>;

/// A belief, read for one question.
pub(super) struct Soft<'b> {
    belief: &'b Belief<'b>,
    world: World<'b>,
    /// Nouns that are believed of something.
    nouns: BTreeSet<&'b str>,
    /// How likely things are of a noun, by name, and the likeliest.
    kinds: RefCell<BTreeMap<String, Rc<Kinds>>>,
    parties: RefCell<Vec<(Party, Meanings<'b>)>>,
}

/// How likely things are of a noun.
struct Kinds {
    by_name: BTreeMap<String, f64>,
    most: f64,
}

impl<'b> Soft<'b> {
    pub(super) fn new(belief: &'b Belief<'b>) -> Self {
        let nouns = belief.things.values().flat_map(|thing| thing.kinds.keys().map(String::as_str));
        Self {
            belief,
            world: World::new(belief.tracks),
            nouns: nouns.collect(),
            kinds: RefCell::default(),
            parties: RefCell::default(),
        }
    }

    fn kinds(&self, noun: &str) -> Rc<Kinds> {
        if let Some(known) = self.kinds.borrow().get(noun) {
            return Rc::clone(known);
        }
        let names = self.belief.tracks.instances.iter().map(|one| one.name.as_str());
        // Who is called a person is meant by "person"; if nobody is, women and men are.
        let own = |name: &str| self.odds(name, [noun]);
        let unclaimed = 1.0 - names.clone().map(own).fold(0.0, f64::max);
        let wider = if self.nouns.contains(noun) { 0.0 } else { WIDER_SHARE };
        let degree = |name: &str| {
            let narrow = self.odds(name, kinds_of(noun)) * unclaimed;
            let wide = self.odds(name, parents_of(noun)) * wider;
            (own(name) + narrow.max(wide)).min(1.0)
        };
        let by_name: BTreeMap<String, f64> = names.map(|name| (name.to_owned(), degree(name))).collect();
        let most = by_name.values().copied().fold(0.0, f64::max);
        let kinds = Rc::new(Kinds { by_name, most });
        self.kinds.borrow_mut().insert(noun.to_owned(), Rc::clone(&kinds));
        kinds
    }

    /// Probability that a thing is there and of one of these nouns.
    fn odds<'n>(&self, name: &str, nouns: impl IntoIterator<Item = &'n str>) -> f64 {
        match self.belief.things.get(name) {
            Some(thing) if !thing.kinds.is_empty() => {
                let sum: f64 = nouns.into_iter().filter_map(|noun| thing.kinds.get(noun)).sum();
                sum.min(1.0) * thing.presence
            }
            unknown => {
                let is_asked = nouns.into_iter().next().is_some();
                let presence = unknown.map_or(1.0, |thing| thing.presence);
                if is_asked { UNHEARD_OF * presence } else { 0.0 }
            }
        }
    }

    /// What a name says of itself: the noun that it ends in, and values of properties beside it.
    fn described(&self, name: &Name) -> Option<Predicate> {
        let words: Vec<&str> = name.split('_').filter(|word| word.parse::<u32>().is_err()).collect();
        let spans = (1..=words.len())
            .rev()
            .flat_map(|length| (0..=words.len() - length).rev().map(move |start| start..start + length));
        let mut spans = spans.map(|span| (words[span.clone()].join("_"), span));
        let (noun, span) = spans.find(|(noun, _)| self.nouns.contains(noun.as_str()))?;
        let beside = words.iter().enumerate().filter(|(at, _)| !span.contains(at));
        let properties = beside.filter_map(|(_, word)| self.property(word));
        Some(Predicate(std::iter::once(Clause::Category(noun)).chain(properties).collect()))
    }

    /// The property that has this value of something.
    fn property(&self, value: &str) -> Option<Clause> {
        let mut all = self.belief.things.values().flat_map(|thing| &thing.attributes);
        let (key, _) = all.find(|(_, odds)| odds.contains_key(value))?;
        Some(Clause::Attribute { key: key.clone(), value: value.to_owned() })
    }

    fn deviation(&self, unit: Unit) -> f64 {
        let noise = &self.belief.noise;
        let deviation = match unit {
            Unit::Metres => noise.position_m,
            Unit::ShareOf(length) => noise.position_m / length.max(LEAST_DEVIATION),
            Unit::Size(power) => noise.size * power,
            Unit::Degrees => noise.angle_deg,
        };
        deviation.max(LEAST_DEVIATION)
    }
}

impl<'b> Reading<'b> for Soft<'b> {
    type Degree = f64;
    type Truth = Degrees;
    type Event = BelievedEvent;

    fn world(&self) -> &World<'b> {
        &self.world
    }

    fn slack(&self) -> Slack {
        Slack::Nominal
    }

    fn events(&self) -> &[BelievedEvent] {
        &self.belief.events
    }

    fn is_a(&self, thing: &TrackedInstance, noun: &str) -> f64 {
        self.kinds(noun).by_name.get(thing.name.as_str()).copied().unwrap_or(0.0)
    }

    fn has(&self, thing: &TrackedInstance, key: &str, value: &str) -> f64 {
        let believed = self.belief.things.get(thing.name.as_str());
        let odds = believed.and_then(|thing| thing.attributes.get(key));
        odds.map_or(f64::UNKNOWN, |odds| odds.get(value).copied().unwrap_or(0.0))
    }

    fn named(&self, name: &Name) -> Vec<Member<'b, f64>> {
        let described = match self.belief.names.get(name) {
            Some(Meant::Thing(thing)) => {
                return self.world.instance(thing).map(|thing| (thing, 1.0)).into_iter().collect();
            }
            Some(Meant::Such(predicate)) => Some(predicate.clone()),
            None => self.described(name),
        };
        let Some(predicate) = described else { return Vec::new() };
        self.world.instances().map(|thing| (thing, fits(self, &predicate, thing))).collect()
    }

    fn is_rival(&self, thing: &TrackedInstance, other: &TrackedInstance, noun: &str) -> f64 {
        if thing.name == other.name {
            return 0.0;
        }
        let kinds = self.kinds(noun);
        let own = kinds.by_name.get(other.name.as_str()).copied().unwrap_or(0.0);
        let share = own / kinds.most.max(LEAST_PRESUMED);
        if share < RIVAL_SHARE { 0.0 } else { share }
    }

    fn at_least(&self, value: f64, limit: f64, unit: Unit) -> f64 {
        let [low, high] = SIZES;
        let difference = match unit {
            Unit::Size(_) => value.clamp(low, high).ln() - limit.clamp(low, high).ln(),
            _ => value - limit,
        };
        logistic(difference, self.deviation(unit))
    }

    fn jitter_frames(&self) -> f64 {
        self.belief.noise.frames
    }

    /// The distance that is expected of the nearest, given that one of them is meant.
    fn nearest(&self, distances: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
        let mut sorted: Vec<(f64, f64)> = distances.collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut expected, mut left) = (0.0, 1.0);
        for (distance, degree) in sorted {
            expected += distance * degree * left;
            left *= 1.0 - degree;
        }
        (left < 1.0 - LEAST_MASS).then(|| expected / (1.0 - left))
    }

    fn weigh(&self, clause: &Clause, degree: f64) -> f64 {
        weighed(clause, degree)
    }

    /// The sentence says that there is one, so the best that fits is presumed to be it.
    fn meant(&self, party: &Party, all: impl FnOnce() -> Vec<Member<'b, f64>>) -> Meanings<'b> {
        let known = |(other, _): &&(Party, _)| other == party;
        if let Some((_, members)) = self.parties.borrow().iter().find(known) {
            return Rc::clone(members);
        }
        let mut members = all();
        let most = members.iter().map(|(_, degree)| *degree).fold(LEAST_PRESUMED, f64::max);
        members.iter_mut().for_each(|(_, degree)| *degree /= most);
        members.retain(|(_, degree)| *degree >= PARTY_SHARE);
        let members = Rc::new(members);
        self.parties.borrow_mut().push((party.clone(), Rc::clone(&members)));
        members
    }
}
