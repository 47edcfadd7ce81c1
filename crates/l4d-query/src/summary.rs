//! What the set holds, in the shape of `check-queries --json`.

use std::collections::BTreeMap;

use l4d_data::{Category, Query, Scale, Status};
use serde::Serialize;

use crate::probes::Probe;
use crate::prove::{COMPOSITES, SceneSet};
use crate::rules::Rule;

/// What is counted of a scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Written<'a> {
    pub(crate) scale: Scale,
    /// Objects that queries may refer to.
    pub(crate) objects: usize,
    pub(crate) queries: &'a [Query],
    pub(crate) composites: &'a [Query],
    pub(crate) absents: &'a [Query],
}

fn written(sets: &[SceneSet]) -> Vec<Written<'_>> {
    sets.iter().map(SceneSet::written).collect()
}

/// Counts of the set, its shortcuts and what is demanded of it.
#[derive(Debug, Default, Serialize)]
pub struct SetSummary {
    /// Scenes checked.
    pub scenes: usize,
    /// Scenes per scale.
    pub scales: BTreeMap<&'static str, usize>,
    /// Objects that queries may refer to.
    pub instances: usize,
    /// Scored queries per category.
    pub queries: BTreeMap<&'static str, usize>,
    /// Queries of two categories, per pair.
    pub composites: BTreeMap<&'static str, usize>,
    /// Sentences that nothing satisfies.
    pub absent: usize,
    /// Queries that people have verified.
    pub verified: usize,
    /// Queries of any kind that people have rejected; they are in no other count.
    pub rejected: usize,
    /// How well each shortcut does.
    pub probes: Vec<Probe>,
    /// What is demanded of the complete set, and what it has; nothing is demanded of a dev or private set.
    pub rules: Vec<Rule>,
}

impl SetSummary {
    /// Scored queries of all categories.
    pub fn total(&self) -> usize {
        self.queries.values().sum()
    }

    /// Counts without probes and rules.
    pub(crate) fn count(sets: &[SceneSet]) -> Self {
        Self::of_written(&written(sets))
    }

    /// The same of scenes of any kind.
    pub(crate) fn of_written(scenes: &[Written<'_>]) -> Self {
        Self::count_of(scenes, |query| query.status != Status::Rejected)
    }

    /// The same as if people had rejected nothing.
    pub(crate) fn count_as_written(sets: &[SceneSet]) -> Self {
        Self::count_of(&written(sets), |_| true)
    }

    fn count_of(scenes: &[Written<'_>], counts: fn(&Query) -> bool) -> Self {
        let mut summary = Self { scenes: scenes.len(), ..Self::default() };
        summary.scales.extend(Scale::ALL.map(|scale| (scale.as_str(), 0)));
        summary.queries.extend(Category::ALL.map(|category| (category.as_str(), 0)));
        summary.composites.extend(COMPOSITES.map(|(name, _)| (name, 0)));
        for set in scenes {
            *summary.scales.entry(set.scale.as_str()).or_default() += 1;
            summary.instances += set.objects;
            for query in set.queries.iter().filter(|query| counts(query)) {
                summary.verified += usize::from(query.status == Status::Verified);
                if let [category] = query.categories.as_slice() {
                    *summary.queries.entry(category.as_str()).or_default() += 1;
                }
            }
            for query in set.composites.iter().filter(|query| counts(query)) {
                if let Some((name, _)) = COMPOSITES.iter().find(|(_, pair)| query.categories == pair) {
                    *summary.composites.entry(name).or_default() += 1;
                }
            }
            summary.absent += set.absents.iter().filter(|query| counts(query)).count();
            let all = set.queries.iter().chain(set.composites).chain(set.absents);
            summary.rejected += all.filter(|query| query.status == Status::Rejected).count();
        }
        summary
    }
}
