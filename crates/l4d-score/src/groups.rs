//! Means with confidence intervals over groups of queries: by category, scale, time, size and occlusion of the target,
//! scene, and query. Knows how queries are grouped, not how a mean or its interval is worked out.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name, QueryId, Scale, Temporal};
use serde::{Deserialize, Serialize};

use crate::cluster::{Estimate, FEW_SCENES};
use crate::eval_set::EvalSet;
use crate::metrics::{PerMetric, QueryTally};
use crate::traits::Traits;

/// Each number of a table with its interval, percent.
pub type Estimates = PerMetric<Option<Estimate>>;

impl Estimates {
    pub fn over(tallies: &[&QueryTally], seed: u64) -> Self {
        Self::of(|metric| Estimate::of_ratio(tallies.iter().copied(), |ratios| ratios.get(metric), seed))
    }
}

/// What the queries of a group have in common.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum GroupKind {
    /// One group of all queries.
    All,
    /// Category; a composite query is in both of its two.
    Category,
    /// The two categories of composite queries.
    Composite,
    /// Scale of the scene.
    Scale,
    /// Scale of the scene and category together, as in the paper's table of scales.
    ScaleCategory,
    /// How the sentence binds time ([`Temporal`]).
    Temporal,
    /// [`crate::traits::Size`] of the target.
    Size,
    /// [`crate::traits::Occlusion`] of the target.
    Occlusion,
    Scene,
    Query,
}

impl GroupKind {
    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}

/// A group of queries of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// What its queries have in common.
    pub kind: GroupKind,
    /// Which of that kind: `attribute`, `attribute+action`, `room`, `room attribute`, `while`, `small`, `room_gym/003`.
    pub name: String,
    /// Number of queries with at least one frame that shows the target.
    pub queries: usize,
    /// Number of scenes that they come from.
    pub scenes: usize,
    /// Whether there are too few scenes for the intervals to be trusted.
    pub few_scenes: bool,
    #[serde(flatten)]
    pub estimates: Estimates,
}

/// All groups of the wanted kinds that have a query, by kind, then in the order of the tables.
pub fn groups(
    tallies: &[QueryTally],
    eval_set: &EvalSet,
    is_wanted: impl Fn(GroupKind) -> bool,
    seed: u64,
) -> Vec<Group> {
    let traits: BTreeMap<&QueryId, Traits> = eval_set
        .scenes
        .iter()
        .flat_map(|scene| scene.queries.iter().zip(&scene.traits))
        .map(|(query, &traits)| (&query.id, traits))
        .collect();
    let mut members: BTreeMap<(GroupKind, usize, String), Vec<&QueryTally>> = BTreeMap::new();
    let scenes: Vec<&Name> = eval_set.scenes.iter().map(|scene| &scene.name).collect();
    for tally in tallies {
        let keys = group_keys(tally, traits.get(&tally.facts.id), &scenes);
        for key in keys.into_iter().filter(|(kind, ..)| is_wanted(*kind)) {
            members.entry(key).or_default().push(tally);
        }
    }
    members.into_iter().map(|((kind, _, name), tallies)| group(kind, name, &tallies, seed)).collect()
}

/// The groups that a query is in: kind, rank in the tables among groups of that kind, and name.
fn group_keys(
    tally: &QueryTally,
    traits: Option<&Traits>,
    scenes: &[&Name],
) -> Vec<(GroupKind, usize, String)> {
    let facts = &tally.facts;
    let scale = Scale::ALL.iter().position(|scale| *scale == facts.scale).unwrap_or_default();
    let scene = scenes.iter().position(|scene| **scene == facts.id.scene).unwrap_or(scenes.len());
    let mut keys = vec![
        (GroupKind::All, 0, "all".to_owned()),
        (GroupKind::Scale, scale, facts.scale.as_str().to_owned()),
        (GroupKind::Scene, scene, facts.id.scene.to_string()),
        (GroupKind::Query, scene, facts.id.to_string()),
    ];
    let rank =
        |category: Category| Category::ALL.iter().position(|other| *other == category).unwrap_or_default();
    for &category in &facts.categories {
        let name = category.as_str();
        keys.push((GroupKind::Category, rank(category), name.to_owned()));
        let of_scale = format!("{} {name}", facts.scale.as_str());
        keys.push((GroupKind::ScaleCategory, Category::ALL.len() * scale + rank(category), of_scale));
    }
    if let [first, second] = facts.categories[..] {
        let name = format!("{}+{}", first.as_str(), second.as_str());
        keys.push((GroupKind::Composite, Category::ALL.len() * rank(first) + rank(second), name));
    }
    if let Some(traits) = traits {
        let temporal = match traits.temporal {
            Temporal::Whole => (0, "whole"),
            Temporal::While => (1, "while"),
        };
        keys.push((GroupKind::Temporal, temporal.0, temporal.1.to_owned()));
        keys.extend(traits.size.map(|size| (GroupKind::Size, size as usize, size.to_string())));
        keys.extend(traits.occlusion.map(|found| (GroupKind::Occlusion, found as usize, found.to_string())));
    }
    keys
}

fn group(kind: GroupKind, name: String, tallies: &[&QueryTally], seed: u64) -> Group {
    let counted = || tallies.iter().filter(|tally| tally.is_counted());
    let scenes = counted().map(|tally| &tally.facts.id.scene).collect::<BTreeSet<_>>().len();
    Group {
        kind,
        name,
        queries: counted().count(),
        scenes,
        few_scenes: scenes < FEW_SCENES,
        estimates: Estimates::over(tallies, seed),
    }
}
