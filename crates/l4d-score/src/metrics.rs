//! From counts to ratios. Nothing here sees a mask: every number follows from the rows of `counts.csv`, the queries
//! and the options. Definitions: `docs/scoring.md`.

use std::collections::BTreeMap;

use l4d_data::{Category, Name, Query, QueryId, Scale, Status};
use serde::{Deserialize, Serialize};

use crate::counts::{FrameCount, State};

/// What a frame without an answer means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Missing {
    /// The results are refused.
    #[default]
    Error,
    /// An empty mask.
    Zero,
    /// The frame is left out and the method is marked partial.
    Skip,
}

/// Choices that change numbers. They stand beside every score.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {
    /// What a frame without an answer means.
    pub missing: Missing,
    /// mAcc counts the frames whose IoU is above this.
    pub hit_iou: f64,
    /// Whether only queries that people verified are scored.
    pub verified_only: bool,
    /// Whether predictions of another size were resized (nearest).
    pub resize: bool,
}

impl Options {
    /// Whether a query is scored at all.
    pub fn takes(&self, query: &Query) -> bool {
        match query.status {
            Status::Verified => true,
            Status::Candidate => !self.verified_only,
            Status::Rejected => false,
        }
    }
}

/// What the metrics must know of a query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QueryFacts {
    /// The query.
    pub id: QueryId,
    /// Its categories.
    pub categories: Vec<Category>,
    /// Scale of its scene.
    pub scale: Scale,
    /// What it means.
    pub referents: Vec<Name>,
    /// Whether people verified it.
    pub verified: bool,
}

impl QueryFacts {
    /// The facts of a query in a scene of some scale.
    pub fn of(query: &Query, scale: Scale) -> Self {
        Self {
            id: query.id.clone(),
            categories: query.categories.clone(),
            scale,
            referents: query.referents.clone(),
            verified: query.status == Status::Verified,
        }
    }
}

/// Sums over the frames of one query or of many.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sums {
    present_frames: u64,
    iou: f64,
    hits: u64,
    hits_25: u64,
    hits_50: u64,
    pub(crate) intersection: u64,
    pub(crate) union: u64,
    absent_frames: u64,
    false_alarms: u64,
}

impl Sums {
    pub(crate) fn add(&mut self, other: &Self) {
        self.present_frames += other.present_frames;
        self.iou += other.iou;
        self.hits += other.hits;
        self.hits_25 += other.hits_25;
        self.hits_50 += other.hits_50;
        self.intersection += other.intersection;
        self.union += other.union;
        self.absent_frames += other.absent_frames;
        self.false_alarms += other.false_alarms;
    }

    pub(crate) fn ratios(&self, selected: Option<f64>) -> Ratios {
        let frames = self.present_frames;
        Ratios {
            miou: (frames > 0).then(|| self.iou / frames as f64),
            macc: ratio(self.hits, frames),
            acc25: ratio(self.hits_25, frames),
            acc50: ratio(self.hits_50, frames),
            tube_iou: if frames > 0 { ratio(self.intersection, self.union) } else { None },
            select: selected,
            false_positive_rate: ratio(self.false_alarms, self.absent_frames),
        }
    }
}

/// The sums of one query.
#[derive(Debug, Clone)]
pub struct QueryTally {
    /// The query.
    pub facts: QueryFacts,
    /// Frames without an answer.
    pub missing_frames: u64,
    pub(crate) sums: Sums,
    pub(crate) is_selected: bool,
}

impl QueryTally {
    /// Adds up the rows of one query.
    pub fn of(facts: QueryFacts, counts: &[FrameCount], options: &Options) -> Self {
        let mut sums = Sums::default();
        let mut missing_frames = 0;
        let mut overlaps: BTreeMap<&Name, u64> = BTreeMap::new();
        for count in counts {
            missing_frames += u64::from(count.state == State::Missing);
            let is_left_out = match count.state {
                State::NotAnnotated => true,
                State::Missing => options.missing != Missing::Zero,
                State::Hit | State::Miss | State::FalseAlarm | State::TrueAbsent => false,
            };
            if is_left_out {
                continue;
            }
            sums.intersection += count.intersection;
            sums.union += count.union;
            if count.truth > 0 {
                let iou = count.intersection as f64 / count.union as f64;
                sums.present_frames += 1;
                sums.iou += iou;
                sums.hits += u64::from(iou > options.hit_iou);
                sums.hits_25 += u64::from(iou > 0.25);
                sums.hits_50 += u64::from(iou > 0.5);
            } else {
                sums.absent_frames += 1;
                sums.false_alarms += u64::from(count.predicted > 0);
            }
            if let Some(instance) = &count.instance {
                *overlaps.entry(instance).or_default() += count.instance_overlap;
            }
        }
        let most = |meant: bool| {
            let side = overlaps.iter().filter(|(name, _)| facts.referents.contains(name) == meant);
            side.map(|(_, overlap)| *overlap).max().unwrap_or(0)
        };
        let is_selected = most(true) > most(false);
        Self { facts, missing_frames, sums, is_selected }
    }

    /// Whether the referent is visible in a frame that counts. Other queries have no mIoU and enter no mean of it.
    pub fn is_counted(&self) -> bool {
        self.sums.present_frames > 0
    }

    /// The ratios of this query alone.
    pub fn ratios(&self) -> Ratios {
        self.sums.ratios(self.is_counted().then(|| f64::from(u8::from(self.is_selected))))
    }
}

/// The instance that the answer to a query overlaps most over the clip; `counts` are the rows of the query. Among equals
/// an instance that is not meant, as `select` has it, then the first by name.
pub fn taken<'a>(query: &Query, counts: impl IntoIterator<Item = &'a FrameCount>) -> Option<&'a Name> {
    let mut overlaps: BTreeMap<&Name, u64> = BTreeMap::new();
    for count in counts {
        if let Some(instance) = &count.instance {
            *overlaps.entry(instance).or_default() += count.instance_overlap;
        }
    }
    let order = |(name, overlap): &(&Name, u64)| (*overlap, !query.referents.contains(name));
    // The last of equals is taken, so the first by name has to come last.
    overlaps.into_iter().rev().max_by_key(order).map(|(name, _)| name)
}

/// Ratios, 0 to 1; none where the denominator is zero.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ratios {
    /// Mean IoU over the frames in which the target is present.
    pub miou: Option<f64>,
    /// Share of those frames that are hit.
    pub macc: Option<f64>,
    /// Share of those frames with IoU above 0.25.
    pub acc25: Option<f64>,
    /// Share of those frames with IoU above 0.5.
    pub acc50: Option<f64>,
    /// Intersections over unions, summed over the clip.
    pub tube_iou: Option<f64>,
    /// Whether the referent is the instance that the prediction overlaps most.
    pub select: Option<f64>,
    /// Share of the frames without a target in which something was predicted.
    pub false_positive_rate: Option<f64>,
}

impl Ratios {
    fn by_column(all: &[Self], combine: impl Fn(&mut dyn Iterator<Item = f64>) -> Option<f64>) -> Self {
        let column = |field: fn(&Self) -> Option<f64>| combine(&mut all.iter().filter_map(field));
        Self {
            miou: column(|ratios| ratios.miou),
            macc: column(|ratios| ratios.macc),
            acc25: column(|ratios| ratios.acc25),
            acc50: column(|ratios| ratios.acc50),
            tube_iou: column(|ratios| ratios.tube_iou),
            select: column(|ratios| ratios.select),
            false_positive_rate: column(|ratios| ratios.false_positive_rate),
        }
    }

    /// Column-wise means; a missing value is left out of its column.
    pub(crate) fn mean(all: &[Self]) -> Self {
        Self::by_column(all, |values| {
            let (sum, count) = values.fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
            (count > 0).then(|| sum / count as f64)
        })
    }
}

/// A row of a table: percentages and how many queries they rest on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Mean IoU over frames with the target, percent.
    pub miou: Option<f64>,
    /// Mean accuracy, percent.
    pub macc: Option<f64>,
    /// The same with IoU above 0.25, percent.
    pub acc25: Option<f64>,
    /// The same with IoU above 0.5, percent.
    pub acc50: Option<f64>,
    /// Spatio-temporal IoU, percent.
    pub tube_iou: Option<f64>,
    /// Share of queries whose most-overlapped instance is the referent, percent.
    pub select: Option<f64>,
    /// Share of frames without a target in which something was predicted, percent; lower is better.
    pub false_positive_rate: Option<f64>,
    /// Queries with at least one frame that shows the target.
    pub queries: usize,
}

impl Metrics {
    pub(crate) fn new(ratios: &Ratios, queries: usize) -> Self {
        let percent = |ratio: Option<f64>| ratio.map(|ratio| 100.0 * ratio);
        Self {
            miou: percent(ratios.miou),
            macc: percent(ratios.macc),
            acc25: percent(ratios.acc25),
            acc50: percent(ratios.acc50),
            tube_iou: percent(ratios.tube_iou),
            select: percent(ratios.select),
            false_positive_rate: percent(ratios.false_positive_rate),
            queries,
        }
    }
}

pub(crate) fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
