//! What a method did query by query and frame by frame: what the page and some figures drill down to.
//!
//! Read from `counts.csv` when it is asked for: a board of thousands of methods needs none of it.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::truth::InstanceTruth;
use l4d_data::{DataError, Name, Query, QueryId, Role, Scale};
use l4d_score::counts::{self, FrameCount, State};
use l4d_score::metrics::{QueryFacts, QueryTally, taken};
use l4d_score::score::{counts_path, summary_path};
use l4d_score::{Exam, Options, Summary};
use rayon::prelude::*;

use crate::rank::Board;

/// Methods beyond these are not drilled down into: those that come first on the board are.
pub const MOST_DETAILED: usize = 200;

/// What the foremost methods of a board did.
#[derive(Debug)]
pub struct Details<'a> {
    pub(crate) asked: Asked<'a>,
    /// In the order of the board.
    pub(crate) methods: Vec<Detail>,
}

impl<'a> Details<'a> {
    /// Reads the counts of the methods of `board`, whose scores stand in `scores`.
    pub fn read(board: &Board, scores: &Path, exam: &'a Exam) -> Result<Self, DataError> {
        let names: Vec<&Name> = board.rows().map(|(_, row)| &row.name).take(MOST_DETAILED).collect();
        // All methods of a board were asked the same queries.
        let options = names.first().map(|name| options(scores, name)).transpose()?.unwrap_or_default();
        let asked = Asked::of(exam, &options);
        let methods = names.par_iter().map(|name| read(scores, name, &asked));
        Ok(Self { methods: methods.collect::<Result<_, DataError>>()?, asked })
    }

    /// Every method on every query whose target is visible, method by method.
    pub fn choices(&self) -> impl Iterator<Item = MethodChoice<'_>> {
        self.methods.iter().flat_map(|detail| {
            detail.tallies.iter().filter_map(|tally| {
                let is_right = tally.ratios().select? > 0.5;
                Some(MethodChoice { method: &detail.method, query: &tally.facts.id, is_right })
            })
        })
    }
}

/// Whether a method chose what a query means.
#[derive(Debug, Clone, Copy)]
pub struct MethodChoice<'a> {
    /// The method.
    pub method: &'a Name,
    /// The query.
    pub query: &'a QueryId,
    /// Whether its prediction overlaps what is meant more than anything else (`select`).
    pub is_right: bool,
}

/// A method, query by query, in the order in which [`Asked`] lists them.
#[derive(Debug, Clone)]
pub(crate) struct Detail {
    /// Its name.
    pub(crate) method: Name,
    /// How it was scored.
    pub(crate) options: Options,
    /// The sums of each query that is asked.
    pub(crate) tallies: Vec<QueryTally>,
    /// What else is known of each of them.
    pub(crate) queries: Vec<QueryDetail>,
}

/// One query of a method.
#[derive(Debug, Clone)]
pub(crate) struct QueryDetail {
    /// The instance that the prediction overlaps most over the clip: the choice that `select` judges.
    pub(crate) taken: Option<Name>,
    /// Ascending.
    pub(crate) frames: Vec<FrameDetail>,
}

/// One frame of a query, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FrameDetail {
    pub(crate) frame: u32,
    pub(crate) state: State,
    pub(crate) intersection: u64,
    pub(crate) union: u64,
    pub(crate) predicted: u64,
}

impl FrameDetail {
    /// 0 to 1; none where there is nothing to find and nothing was found.
    pub(crate) fn iou(&self) -> Option<f64> {
        (self.union > 0).then(|| self.intersection as f64 / self.union as f64)
    }
}

/// What a board asks, scene by scene.
#[derive(Debug)]
pub(crate) struct Asked<'a> {
    /// In the order of the exam.
    pub(crate) scenes: Vec<AskedScene<'a>>,
}

/// The queries of a scene that are scored.
#[derive(Debug)]
pub(crate) struct AskedScene<'a> {
    pub(crate) scene: &'a l4d_score::exam::SceneExam,
    pub(crate) scale: Scale,
    pub(crate) queries: Vec<&'a Query>,
    /// What can be seen there.
    pub(crate) things: Vec<Thing>,
}

/// An instance of a scene.
#[derive(Debug)]
pub(crate) struct Thing {
    pub(crate) name: Name,
    pub(crate) role: Role,
    pub(crate) category: String,
}

impl<'a> Asked<'a> {
    /// The queries that methods scored with these options were asked.
    pub(crate) fn of(exam: &'a Exam, options: &Options) -> Self {
        let scenes = exam.scenes.iter().map(|scene| {
            let queries = scene.queries.iter().filter(|query| options.takes(query)).collect();
            let thing = |instance: &InstanceTruth| {
                let InstanceTruth { name, role, category, .. } = instance;
                Thing { name: name.clone(), role: *role, category: category.clone() }
            };
            let things = scene.truth.instances.iter().map(thing).collect();
            AskedScene { scene, scale: scene.scale, queries, things }
        });
        Self { scenes: scenes.collect() }
    }

    /// All queries with the scale of their scene.
    pub(crate) fn queries(&self) -> impl Iterator<Item = (&'a Query, Scale)> {
        self.scenes.iter().flat_map(|scene| scene.queries.iter().map(|&query| (query, scene.scale)))
    }
}

/// How a method of this board was scored.
fn options(scores: &Path, method: &Name) -> Result<Options, DataError> {
    Ok(Summary::read(&summary_path(scores, method))?.options)
}

/// Reads what a method did.
fn read(scores: &Path, method: &Name, asked: &Asked) -> Result<Detail, DataError> {
    let options = options(scores, method)?;
    Ok(derive(method, options, counts::read(&counts_path(scores, method))?, asked))
}

/// What counts say of a method.
pub(crate) fn derive(method: &Name, options: Options, counts: Vec<FrameCount>, asked: &Asked) -> Detail {
    let mut rows: BTreeMap<QueryId, Vec<FrameCount>> = BTreeMap::new();
    for count in counts {
        rows.entry(count.query.clone()).or_default().push(count);
    }
    let mut detail = Detail { method: method.clone(), options, tallies: Vec::new(), queries: Vec::new() };
    for (query, scale) in asked.queries() {
        let counts = rows.remove(&query.id).unwrap_or_default();
        detail.tallies.push(QueryTally::of(QueryFacts::of(query, scale), &counts, &options));
        let frames = counts.iter().map(frame).collect();
        detail.queries.push(QueryDetail { taken: taken(query, &counts).cloned(), frames });
    }
    detail
}

fn frame(count: &FrameCount) -> FrameDetail {
    let &FrameCount { frame, state, intersection, union, predicted, .. } = count;
    FrameDetail { frame, state, intersection, union, predicted }
}
