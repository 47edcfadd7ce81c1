//! What the set holds, in the shape of `check-queries --json`.

use std::collections::BTreeMap;

use l4d_data::{Category, Query, Scale, Status};
use serde::Serialize;

use crate::probes::Probe;
use crate::prove::COMPOSITES;

/// Counts of the set, and its shortcuts.
#[derive(Debug, Default, Serialize)]
pub struct SetSummary {
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
}

impl SetSummary {
    /// Scored queries of all categories.
    pub fn total(&self) -> usize {
        self.queries.values().sum()
    }

    /// Counts without probes: scale, possible referents, queries, composites and absent sentences of each
    /// scene.
    pub(crate) fn count<'q>(scenes: impl IntoIterator<Item = (Scale, usize, [&'q [Query]; 3])>) -> Self {
        let mut summary = Self::default();
        summary.scales.extend(Scale::ALL.map(|scale| (scale.as_str(), 0)));
        summary.queries.extend(Category::ALL.map(|category| (category.as_str(), 0)));
        summary.composites.extend(COMPOSITES.map(|(name, _)| (name, 0)));
        for (scale, objects, files) in scenes {
            summary.scenes += 1;
            *summary.scales.entry(scale.as_str()).or_default() += 1;
            summary.instances += objects;
            let is_rejected = |query: &&Query| query.status == Status::Rejected;
            summary.rejected += files.iter().copied().flatten().filter(is_rejected).count();
            let [queries, composites, absents] =
                files.map(|file| file.iter().filter(move |query| !is_rejected(query)));
            for query in queries {
                summary.verified += usize::from(query.status == Status::Verified);
                if let [category] = query.categories.as_slice() {
                    *summary.queries.entry(category.as_str()).or_default() += 1;
                }
            }
            for query in composites {
                if let Some((name, _)) = COMPOSITES.iter().find(|(_, pair)| query.categories == pair) {
                    *summary.composites.entry(name).or_default() += 1;
                }
            }
            summary.absent += absents.count();
        }
        summary
    }
}
