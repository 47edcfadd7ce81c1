//! Means with intervals of groups of queries: by what is asked, where, when, and how it looks.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name, QueryId, Scale, Temporal};
use serde::{Deserialize, Serialize};

use crate::cluster::{Estimate, FEW_SCENES};
use crate::exam::Exam;
use crate::metrics::{PerMetric, QueryTally};
use crate::traits::Traits;

/// Each number of a table with its interval, percent.
pub type Estimates = PerMetric<Option<Estimate>>;

impl Estimates {
    /// Means over some queries.
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
    /// Nothing: all of them.
    All,
    /// A category; a composite query is in each of its two.
    Category,
    /// Both categories, of composite queries.
    Composite,
    /// Scale of the scene.
    Scale,
    /// Scale of the scene and category, as the paper's table of scales has them.
    ScaleCategory,
    /// How the sentence binds time ([`Temporal`]).
    Temporal,
    /// [`crate::traits::Size`] of the target.
    Size,
    /// [`crate::traits::Occlusion`] of the target.
    Occlusion,
    Scene,
    /// A single query.
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
    /// Queries with at least one frame that shows the target.
    pub queries: usize,
    /// Scenes that they come from.
    pub scenes: usize,
    /// Whether these are too few scenes for its intervals to be trusted.
    pub few_scenes: bool,
    #[serde(flatten)]
    pub estimates: Estimates,
}

/// All groups of the wanted kinds that have a query, by kind, then in the order of the tables.
pub fn groups(
    tallies: &[QueryTally],
    exam: &Exam,
    is_wanted: impl Fn(GroupKind) -> bool,
    seed: u64,
) -> Vec<Group> {
    let traits: BTreeMap<&QueryId, Traits> = exam
        .scenes
        .iter()
        .flat_map(|scene| scene.queries.iter().zip(&scene.traits))
        .map(|(query, &traits)| (&query.id, traits))
        .collect();
    let mut members: BTreeMap<(GroupKind, usize, String), Vec<&QueryTally>> = BTreeMap::new();
    let scenes: Vec<&Name> = exam.scenes.iter().map(|scene| &scene.name).collect();
    for tally in tallies {
        let places = places(tally, traits.get(&tally.facts.id), &scenes);
        for place in places.into_iter().filter(|(kind, ..)| is_wanted(*kind)) {
            members.entry(place).or_default().push(tally);
        }
    }
    members.into_iter().map(|((kind, _, name), tallies)| group(kind, name, &tallies, seed)).collect()
}

/// GroupKind, rank among its kind, and name of the groups of a query.
fn places(tally: &QueryTally, traits: Option<&Traits>, scenes: &[&Name]) -> Vec<(GroupKind, usize, String)> {
    let facts = &tally.facts;
    let scale = Scale::ALL.iter().position(|scale| *scale == facts.scale).unwrap_or_default();
    let scene = scenes.iter().position(|scene| **scene == facts.id.scene).unwrap_or(scenes.len());
    let mut places = vec![
        (GroupKind::All, 0, "all".to_owned()),
        (GroupKind::Scale, scale, facts.scale.as_str().to_owned()),
        (GroupKind::Scene, scene, facts.id.scene.to_string()),
        (GroupKind::Query, scene, facts.id.to_string()),
    ];
    let rank =
        |category: Category| Category::ALL.iter().position(|other| *other == category).unwrap_or_default();
    for &category in &facts.categories {
        let name = category.as_str();
        places.push((GroupKind::Category, rank(category), name.to_owned()));
        let of_scale = format!("{} {name}", facts.scale.as_str());
        places.push((GroupKind::ScaleCategory, Category::ALL.len() * scale + rank(category), of_scale));
    }
    if let [first, second] = facts.categories[..] {
        let name = format!("{}+{}", first.as_str(), second.as_str());
        places.push((GroupKind::Composite, Category::ALL.len() * rank(first) + rank(second), name));
    }
    if let Some(traits) = traits {
        let temporal = match traits.temporal {
            Temporal::Whole => (0, "whole"),
            Temporal::While => (1, "while"),
        };
        places.push((GroupKind::Temporal, temporal.0, temporal.1.to_owned()));
        places.extend(traits.size.map(|size| (GroupKind::Size, size as usize, size.to_string())));
        places
            .extend(traits.occlusion.map(|found| (GroupKind::Occlusion, found as usize, found.to_string())));
    }
    places
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
