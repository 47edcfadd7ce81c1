//! Shortcuts: how often a rule that doesn't understand the sentence picks the referent.
//!
//! Each probe picks one object of the referent's category (what the noun alone says). On queries that ask for more
//! than a property it must not do much better than chance. Where it has no information or several objects tie, it
//! picks at random among them; random picks count with their expected value, so the table needs no seed.

use std::collections::BTreeMap;

use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::TrackedInstance;
use l4d_data::truth::Truth;
use l4d_data::{Category, Query, Temporal};
use serde::Serialize;

use crate::ast::Predicate;
use crate::prove::SceneSet;
use crate::world::World;

mod picks;

use picks::{Case, Pick, SHORTCUTS, Shortcut};

/// A shortcut may be right this much more often than chance, percentage points.
pub const BOUND_POINTS: f64 = 10.0;

/// How well one shortcut does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Probe {
    pub name: &'static str,
    /// How it picks.
    pub rule: &'static str,
    /// Whether [`BOUND_POINTS`] is demanded of it.
    pub bounded: bool,
    /// Queries that it was tried on.
    pub queries: usize,
    /// How often it is right, percent.
    pub accuracy: f64,
    /// How often a random look-alike is right, percent.
    pub chance: f64,
    /// Accuracy minus chance, percentage points.
    pub difference: f64,
    /// The difference per category, percentage points.
    pub categories: BTreeMap<&'static str, f64>,
    /// Queries whose referent it picks for sure.
    pub solved: Vec<String>,
}

impl Probe {
    /// Whether it does better than it may.
    pub fn is_beyond(&self) -> bool {
        self.bounded && self.difference > BOUND_POINTS
    }

    fn of(shortcut: &Shortcut, trials: &[Trial<'_, '_>]) -> Self {
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let values: Vec<f64> = values.collect();
            if values.is_empty() { 0.0 } else { 100.0 * values.iter().sum::<f64>() / values.len() as f64 }
        };
        let scored: Vec<(Category, f64, f64)> = trials
            .iter()
            .filter_map(|trial| Some((trial.category, trial.score(shortcut)?, trial.chance())))
            .collect();
        let accuracy = mean(&mut scored.iter().map(|(_, score, _)| *score));
        let chance = mean(&mut scored.iter().map(|(_, _, chance)| *chance));
        let per_category = |category: Category| {
            let of: Vec<_> = scored.iter().filter(|(of, ..)| *of == category).collect();
            let difference = mean(&mut of.iter().map(|(_, score, chance)| score - chance));
            (category.as_str(), round(difference))
        };
        let solved = trials.iter().filter(|trial| trial.score(shortcut) == Some(1.0));
        Self {
            name: shortcut.name,
            rule: shortcut.rule,
            bounded: shortcut.bounded,
            queries: scored.len(),
            accuracy: round(accuracy),
            chance: round(chance),
            difference: round(accuracy - chance),
            categories: BOUNDED.map(per_category).into_iter().collect(),
            solved: solved.map(|trial| trial.query.id.to_string()).collect(),
        }
    }
}

/// The categories that no shortcut may solve; properties may be seen in a single glance.
pub const BOUNDED: [Category; 3] = [Category::Action, Category::Spatial, Category::Interaction];

/// One query that shortcuts are tried on.
pub struct Trial<'c, 'a> {
    query: &'c Query,
    category: Category,
    case: Case<'c, 'a>,
}

impl<'c, 'a> Trial<'c, 'a> {
    /// None of a query that may be seen at a glance, is no single one, or has no candidates; `truth` is what the
    /// held-out view sees.
    pub fn new(
        world: &'c World<'a>,
        truth: Option<&'c Truth>,
        query: &'c Query,
        predicate: Predicate,
    ) -> Option<Self> {
        let [category] = query.categories.as_slice() else { return None };
        let is_candidate = |object: &&TrackedInstance| object.category == predicate.noun();
        let candidates: Vec<_> = world.objects().filter(is_candidate).collect();
        let is_tried = BOUNDED.contains(category) && !candidates.is_empty();
        let (text, frames) = (query.text.as_str(), frames(query));
        let case = Case { world, truth, text, predicate, candidates, frames };
        is_tried.then_some(Self { query, category: *category, case })
    }

    /// Names of the shortcuts that must stay near chance, with the probability that each picks the referent; none
    /// where it cannot be tried.
    pub fn bounded(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> {
        let bounded = SHORTCUTS.iter().filter(|shortcut| shortcut.bounded);
        bounded.map(|shortcut| (shortcut.name, self.score(shortcut)))
    }

    /// Probability that a look-alike picked at random is the referent.
    pub fn chance(&self) -> f64 {
        1.0 / self.case.candidates.len() as f64
    }

    /// Probability that the shortcut picks the referent; none where it cannot be tried.
    fn score(&self, shortcut: &Shortcut) -> Option<f64> {
        let picked = match (shortcut.pick)(&self.case) {
            Pick::Among(picked) if picked.is_empty() => self.case.candidates.clone(),
            Pick::Among(picked) => picked,
            Pick::Impossible => return None,
        };
        let is_right = picked.iter().any(|candidate| self.query.referents.contains(&candidate.name));
        Some(if is_right { 1.0 / picked.len() as f64 } else { 0.0 })
    }
}

/// The frames in which a query holds.
fn frames(query: &Query) -> Vec<u32> {
    (0..FRAME_COUNT).filter(|&frame| query.temporal == Temporal::Whole || query.holds_at(frame)).collect()
}

/// Tries every shortcut on every query that asks for an action, a place or an interaction.
pub fn measure(sets: &[SceneSet]) -> Vec<Probe> {
    let worlds: Vec<World<'_>> = sets.iter().map(|set| World::new(&set.tracks)).collect();
    let mut trials = Vec::new();
    for (set, world) in sets.iter().zip(&worlds) {
        for (query, predicate) in set.scored() {
            let Some(predicate) = predicate else { continue };
            trials.extend(Trial::new(world, set.truth.as_ref(), query, predicate));
        }
    }
    SHORTCUTS.iter().map(|shortcut| Probe::of(shortcut, &trials)).collect()
}

fn round(percent: f64) -> f64 {
    (percent * 10.0).round() / 10.0
}

#[cfg(test)]
mod tests;
