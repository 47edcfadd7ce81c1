//! Means with intervals of groups of queries: by what is asked, where, when, and how it looks.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name, QueryId, Scale, Temporal};
use serde::Serialize;

use crate::cluster::{Estimate, FEW_SCENES};
use crate::exam::Exam;
use crate::metrics::{QueryTally, Ratios};
use crate::traits::Traits;

/// Each number of a table with its interval, percent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Estimates {
    /// [`Ratios::miou`].
    pub miou: Option<Estimate>,
    /// [`Ratios::macc`].
    pub macc: Option<Estimate>,
    /// [`Ratios::acc25`].
    pub acc25: Option<Estimate>,
    /// [`Ratios::acc50`].
    pub acc50: Option<Estimate>,
    /// [`Ratios::tube_iou`].
    pub tube_iou: Option<Estimate>,
    /// [`Ratios::select`].
    pub select: Option<Estimate>,
    /// [`Ratios::false_positive_rate`].
    pub false_positive_rate: Option<Estimate>,
}

impl Estimates {
    /// Means over some queries.
    pub fn of(tallies: &[&QueryTally], seed: u64) -> Self {
        let of = |ratio: fn(&Ratios) -> Option<f64>| Estimate::of_ratio(tallies.iter().copied(), ratio, seed);
        Self {
            miou: of(|ratios| ratios.miou),
            macc: of(|ratios| ratios.macc),
            acc25: of(|ratios| ratios.acc25),
            acc50: of(|ratios| ratios.acc50),
            tube_iou: of(|ratios| ratios.tube_iou),
            select: of(|ratios| ratios.select),
            false_positive_rate: of(|ratios| ratios.false_positive_rate),
        }
    }
}

/// What the queries of a group have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Nothing: all of them.
    All,
    /// A category; a composite query is in each of its two.
    Category,
    /// Both categories, of composite queries.
    Composite,
    /// Scale of the scene.
    Scale,
    /// Scale of the scene and category, as the paper's table of scales has them.
    #[serde(rename = "scale_category")]
    ScaleCategory,
    /// How the sentence binds time ([`Temporal`]).
    Temporal,
    /// [`crate::traits::Size`] of the target.
    Size,
    /// [`crate::traits::Occlusion`] of the target.
    Occlusion,
    /// The scene.
    Scene,
    /// A single query.
    Query,
}

impl Kind {
    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Category => "category",
            Self::Composite => "composite",
            Self::Scale => "scale",
            Self::ScaleCategory => "scale_category",
            Self::Temporal => "temporal",
            Self::Size => "size",
            Self::Occlusion => "occlusion",
            Self::Scene => "scene",
            Self::Query => "query",
        }
    }
}

/// A group of queries of one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// What its queries have in common.
    pub kind: Kind,
    /// Which of that kind: `attribute`, `attribute+action`, `room`, `room attribute`, `while`, `small`, `room_gym/003`.
    pub name: String,
    /// Queries with at least one frame that shows the target.
    pub queries: usize,
    /// Scenes that they come from.
    pub scenes: usize,
    /// Whether these are too few scenes for its intervals to be trusted.
    pub few_scenes: bool,
    /// Its numbers.
    #[serde(flatten)]
    pub estimates: Estimates,
}

/// All groups that have a query, by kind, then in the order of the tables.
pub fn groups(tallies: &[QueryTally], exam: &Exam, seed: u64) -> Vec<Group> {
    let traits: BTreeMap<&QueryId, Traits> = exam
        .scenes
        .iter()
        .flat_map(|scene| scene.queries.iter().zip(&scene.traits))
        .map(|(query, &traits)| (&query.id, traits))
        .collect();
    let mut members: BTreeMap<(Kind, usize, String), Vec<&QueryTally>> = BTreeMap::new();
    let scenes: Vec<&Name> = exam.scenes.iter().map(|scene| &scene.name).collect();
    for tally in tallies {
        for place in places(tally, traits.get(&tally.facts.id), &scenes) {
            members.entry(place).or_default().push(tally);
        }
    }
    members.into_iter().map(|((kind, _, name), tallies)| group(kind, name, &tallies, seed)).collect()
}

/// Kind, rank among its kind, and name of the groups of a query.
fn places(tally: &QueryTally, traits: Option<&Traits>, scenes: &[&Name]) -> Vec<(Kind, usize, String)> {
    let facts = &tally.facts;
    let scale = Scale::ALL.iter().position(|scale| *scale == facts.scale).unwrap_or_default();
    let scene = scenes.iter().position(|scene| **scene == facts.id.scene).unwrap_or(scenes.len());
    let mut places = vec![
        (Kind::All, 0, "all".to_owned()),
        (Kind::Scale, scale, facts.scale.as_str().to_owned()),
        (Kind::Scene, scene, facts.id.scene.to_string()),
        (Kind::Query, scene, facts.id.to_string()),
    ];
    let rank =
        |category: Category| Category::ALL.iter().position(|other| *other == category).unwrap_or_default();
    for &category in &facts.categories {
        let name = category.as_str();
        places.push((Kind::Category, rank(category), name.to_owned()));
        let of_scale = format!("{} {name}", facts.scale.as_str());
        places.push((Kind::ScaleCategory, Category::ALL.len() * scale + rank(category), of_scale));
    }
    if let [first, second] = facts.categories[..] {
        let name = format!("{}+{}", first.as_str(), second.as_str());
        places.push((Kind::Composite, Category::ALL.len() * rank(first) + rank(second), name));
    }
    if let Some(traits) = traits {
        let temporal = match traits.temporal {
            Temporal::Whole => (0, "whole"),
            Temporal::While => (1, "while"),
        };
        places.push((Kind::Temporal, temporal.0, temporal.1.to_owned()));
        places.extend(traits.size.map(|size| (Kind::Size, size as usize, size.as_str().to_owned())));
        places.extend(
            traits.occlusion.map(|found| (Kind::Occlusion, found as usize, found.as_str().to_owned())),
        );
    }
    places
}

fn group(kind: Kind, name: String, tallies: &[&QueryTally], seed: u64) -> Group {
    let counted = || tallies.iter().filter(|tally| tally.is_counted());
    let scenes = counted().map(|tally| &tally.facts.id.scene).collect::<BTreeSet<_>>().len();
    Group {
        kind,
        name,
        queries: counted().count(),
        scenes,
        few_scenes: scenes < FEW_SCENES,
        estimates: Estimates::of(tallies, seed),
    }
}
