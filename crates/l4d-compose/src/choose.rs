//! The set of a scene: many kinds, every object, no shortcut.
//!
//! A search over the candidates by simulated annealing. Everything wanted of a set is a term of one price, so that a
//! scene that cannot have all of it gets the best compromise.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::Category;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::candidate::Candidate;
use crate::compose::LEAST_QUERIES;

/// A candidate, and its sentence once it has been said.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) candidate: Candidate,
    pub(crate) text: Option<String>,
    /// How far each bounded shortcut is above chance on it; empty where shortcuts are not tried.
    pub(crate) above_chance: Vec<f64>,
}

/// Share of each category in the test set.
const MIX: [(Category, f64); 4] = [
    (Category::Attribute, 0.35),
    (Category::Action, 0.21),
    (Category::Spatial, 0.25),
    (Category::Interaction, 0.19),
];
/// Queries wanted per object. The test set has 2.7; a composed scene has fewer objects, and is worth as many queries.
const QUERIES_PER_OBJECT: f64 = 4.0;
/// Fewest and most single queries wanted.
const WANTED: [f64; 2] = [14.0, 18.0];

/// Steps of the search from nothing, and of one that goes on.
const STEPS: usize = 40_000;
const MORE_STEPS: usize = 10_000;
/// Temperatures at which the search begins, goes on from a set that is nearly good, and ends, in units of the price.
const HOT: f64 = 3.0;
const WARM: f64 = 0.4;
const COLD: f64 = 0.02;

/// What a query is worth at most; a set is better off without one that costs more.
const WORTH: f64 = 6.0;
/// An object that no query means.
const UNASKED: f64 = 8.0;
/// For the square of what a category lacks of the wanted number, and of what it has more.
const LACK: f64 = 2.5;
const EXCESS: f64 = 5.0;
/// For the square of what a set lacks of the fewest that are wanted, and for each query that it must have and lacks.
const SHORT: f64 = 4.0;
const TOO_SHORT: f64 = 30.0;
/// For the squared number of queries of one form.
const SAME_SHAPE: f64 = 0.35;
/// For the squared number of queries about the same thing.
const SAME_CORE: f64 = 0.5;
/// For the squared number of queries that mean the same object.
const SAME_REFERENT: f64 = 0.5;
/// For the square of what a shortcut gains in a category, in queries; a shortcut that loses is the lesser evil.
const GAIN: f64 = 12.0;
const LOSS: f64 = 4.0;

/// The chosen single queries, as places in `entries`, ascending; `start` is a set that was chosen before.
pub(crate) fn singles(
    entries: &[Entry],
    wanted: [f64; 4],
    start: Vec<usize>,
    random: &mut ChaCha8Rng,
) -> Vec<usize> {
    if entries.is_empty() {
        return Vec::new();
    }
    let board = Board::of(entries, wanted);
    let (first, steps) = if start.is_empty() { (HOT, STEPS) } else { (WARM, MORE_STEPS) };
    let mut chosen = start;
    let mut price = board.price(&chosen);
    let mut best = (price, chosen.clone());
    for step in 0..steps {
        let progress = step as f64 / steps as f64;
        let temperature = first * (COLD / first).powf(progress);
        let mut next = chosen.clone();
        let newcomer = random.random_range(0..entries.len());
        match random.random_range(0..4) {
            0 if !next.is_empty() => drop(next.swap_remove(random.random_range(0..next.len()))),
            1 => next.push(newcomer),
            _ if !next.is_empty() => {
                let place = random.random_range(0..next.len());
                next[place] = newcomer;
            }
            _ => next.push(newcomer),
        }
        if !board.is_allowed(&next) {
            continue;
        }
        let changed = board.price(&next);
        if changed <= price || random.random::<f64>() < ((price - changed) / temperature).exp() {
            (chosen, price) = (next, changed);
            if price < best.0 {
                best = (price, chosen.clone());
            }
        }
    }
    best.1.sort_unstable();
    best.1
}

/// How many of each category are wanted: the mix of the test set on average over many scenes.
pub(crate) fn wanted(objects: usize, random: &mut ChaCha8Rng) -> [f64; 4] {
    let total = (objects as f64 * QUERIES_PER_OBJECT).clamp(WANTED[0], WANTED[1]);
    MIX.map(|(_, share)| (share * total + random.random::<f64>()).floor())
}

/// Everything about the entries that the search asks for, as numbers.
struct Board<'e> {
    entries: &'e [Entry],
    wanted: [f64; 4],
    categories: Vec<usize>,
    referents: Vec<usize>,
    shapes: Vec<Vec<usize>>,
    cores: Vec<Vec<usize>>,
    objects: usize,
    all_shapes: usize,
    all_cores: usize,
}

/// Gives each text a number.
#[derive(Default)]
struct Numbers(BTreeMap<String, usize>);

impl Numbers {
    fn of(&mut self, text: String) -> usize {
        let next = self.0.len();
        *self.0.entry(text).or_insert(next)
    }
}

impl<'e> Board<'e> {
    fn of(entries: &'e [Entry], wanted: [f64; 4]) -> Self {
        let [mut objects, mut shapes, mut cores] = [const { Numbers(BTreeMap::new()) }; 3];
        let category = |entry: &Entry| {
            let category = entry.candidate.categories().first().copied();
            MIX.iter().position(|(known, _)| Some(*known) == category).unwrap_or_default()
        };
        let referent = |entry: &Entry| entry.candidate.referent.as_ref().map(ToString::to_string);
        let noun = |entry: &Entry, core: &str| format!("{} {core}", entry.candidate.predicate.noun());
        Self {
            entries,
            wanted,
            categories: entries.iter().map(category).collect(),
            referents: entries.iter().map(|entry| objects.of(referent(entry).unwrap_or_default())).collect(),
            shapes: entries
                .iter()
                .map(|entry| entry.candidate.shapes.iter().map(|shape| shapes.of(shape.clone())).collect())
                .collect(),
            cores: entries
                .iter()
                .map(|entry| entry.candidate.cores.iter().map(|core| cores.of(noun(entry, core))).collect())
                .collect(),
            objects: objects.0.len(),
            all_shapes: shapes.0.len(),
            all_cores: cores.0.len(),
        }
    }

    /// No two say the same of the same object.
    fn is_allowed(&self, chosen: &[usize]) -> bool {
        chosen.iter().enumerate().all(|(place, &one)| {
            chosen[place + 1..].iter().all(|&other| {
                one != other
                    && (self.referents[one] != self.referents[other]
                        || !self.cores[one].iter().any(|core| self.cores[other].contains(core)))
            })
        })
    }

    fn price(&self, chosen: &[usize]) -> f64 {
        let mut categories = [0.0_f64; 4];
        let mut gains = [[0.0_f64; MOST_SHORTCUTS]; 4];
        let mut referents = vec![0.0_f64; self.objects];
        let mut shapes = vec![0.0_f64; self.all_shapes];
        let mut cores = vec![0.0_f64; self.all_cores];
        let mut price = 0.0;
        for &one in chosen {
            let entry = &self.entries[one];
            let category = self.categories[one];
            price += entry.candidate.price - WORTH;
            categories[category] += 1.0;
            referents[self.referents[one]] += 1.0;
            self.shapes[one].iter().for_each(|&shape| shapes[shape] += 1.0);
            self.cores[one].iter().for_each(|&core| cores[core] += 1.0);
            for (gain, above) in gains[category].iter_mut().zip(&entry.above_chance) {
                *gain += above;
            }
        }
        let squares = |counts: &[f64]| counts.iter().map(|count| count * count).sum::<f64>();
        for (have, want) in categories.iter().zip(self.wanted) {
            price += if have < &want { LACK } else { EXCESS } * (have - want).powi(2);
        }
        price += SHORT * (WANTED[0] - chosen.len() as f64).max(0.0).powi(2);
        price += TOO_SHORT * LEAST_QUERIES.saturating_sub(chosen.len()) as f64;
        price += UNASKED * referents.iter().filter(|count| **count == 0.0).count() as f64;
        price +=
            SAME_REFERENT * squares(&referents) + SAME_SHAPE * squares(&shapes) + SAME_CORE * squares(&cores);
        let gains = gains.as_flattened().iter();
        price + gains.map(|gain| if *gain > 0.0 { GAIN } else { LOSS } * gain * gain).sum::<f64>()
    }
}

/// At least as many as `l4d_query::probes` has bounded ones.
pub(crate) const MOST_SHORTCUTS: usize = 8;

/// The next of the entries after those that are chosen: a cheap one that differs in form, content and referent. `whims`
/// are a draw for each.
pub(crate) fn next_varied(
    entries: &[Entry],
    chosen: &[usize],
    left: &[usize],
    whims: &[f64],
) -> Option<usize> {
    let price = |place: usize| {
        let again: f64 = chosen.iter().map(|&other| likeness(&entries[place], &entries[other])).sum();
        entries[place].candidate.price + whims[place] + again
    };
    let priced = left.iter().map(|&place| (price(place), place));
    priced.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// How much worse an entry is after another one.
fn likeness(one: &Entry, other: &Entry) -> f64 {
    let shared = |a: &[String], b: &[String]| {
        let a: BTreeSet<&String> = a.iter().collect();
        b.iter().filter(|text| a.contains(text)).count() as f64
    };
    let (one, other) = (&one.candidate, &other.candidate);
    let is_same_pair = f64::from(one.categories() == other.categories());
    let is_same_referent = f64::from(one.referent == other.referent && one.referent.is_some());
    2.0 * is_same_pair
        + 1.5 * is_same_referent
        + 3.0 * shared(&one.cores, &other.cores)
        + shared(&one.shapes, &other.shapes)
}
