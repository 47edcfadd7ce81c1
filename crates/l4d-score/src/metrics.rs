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

/// Choices that change numbers. They are beside every score.
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
    pub id: QueryId,
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
    pub facts: QueryFacts,
    /// Frames without an answer.
    pub missing_frames: u64,
    pub(crate) sums: Sums,
    pub(crate) is_selected: bool,
}

impl QueryTally {
    /// Adds up the rows of one query.
    pub fn of<'a>(
        facts: QueryFacts,
        counts: impl IntoIterator<Item = &'a FrameCount>,
        options: &Options,
    ) -> Self {
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

/// The instance that the answer to a query overlaps most over the clip; `counts` are its rows. Among equals
/// an instance that is not meant, as `select` has it, then the first by name.
pub fn taken<'a>(referents: &[Name], counts: impl IntoIterator<Item = &'a FrameCount>) -> Option<&'a Name> {
    let mut overlaps: BTreeMap<&Name, u64> = BTreeMap::new();
    for count in counts {
        if let Some(instance) = &count.instance {
            *overlaps.entry(instance).or_default() += count.instance_overlap;
        }
    }
    let order = |(name, overlap): &(&Name, u64)| (*overlap, !referents.contains(name));
    // The last of equals is taken, so the first by name has to come last.
    overlaps.into_iter().rev().max_by_key(order).map(|(name, _)| name)
}

/// What is measured; docs/scoring.md defines each.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Metric {
    /// Mean IoU over the frames in which the target is present. The headline.
    Miou,
    /// Share of those frames that are hit.
    Macc,
    /// Share of those frames with IoU above 0.25.
    Acc25,
    /// Share of those frames with IoU above 0.5.
    Acc50,
    /// Intersections over unions, summed over the clip.
    TubeIou,
    /// Whether the referent is the instance that the prediction overlaps most.
    Select,
    /// Share of the frames without a target in which something was predicted; lower is better.
    FalsePositiveRate,
}

impl Metric {
    /// All metrics in column order; the first is the headline.
    pub const ALL: [Self; 7] = [
        Self::Miou,
        Self::Macc,
        Self::Acc25,
        Self::Acc50,
        Self::TubeIou,
        Self::Select,
        Self::FalsePositiveRate,
    ];

    /// Name in files.
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// Title of a column.
    pub fn title(self) -> &'static str {
        self.texts().0
    }

    /// Title of a narrow column, at most 7 letters.
    pub(crate) fn short_title(self) -> &'static str {
        self.texts().1
    }

    /// What it says, in a sentence for readers of tables.
    pub fn about(self) -> &'static str {
        self.texts().2
    }

    fn texts(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Miou => (
                "mIoU",
                "mIoU",
                "Mean IoU over the frames that show the target, then over queries. The headline.",
            ),
            Self::Macc => (
                "mAcc",
                "mAcc",
                "Share of those frames in which prediction and truth share a pixel: kind to large masks.",
            ),
            Self::Acc25 => ("Acc@0.25", "Acc@.25", "Share of those frames with IoU above 0.25."),
            Self::Acc50 => ("Acc@0.5", "Acc@.5", "Share of those frames with IoU above 0.5."),
            Self::TubeIou => {
                ("tube IoU", "tube", "Intersections over unions, summed over the whole clip: time matters.")
            }
            Self::Select => {
                ("select", "select", "Share of queries whose most-overlapped thing is the one that is meant.")
            }
            Self::FalsePositiveRate => (
                "FPR",
                "FPR",
                "Share of frames without a target in which something was marked; lower is better.",
            ),
        }
    }

    /// Whether more is better.
    pub fn higher_is_better(self) -> bool {
        self != Self::FalsePositiveRate
    }
}

/// One value per metric.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PerMetric<T> {
    /// [`Metric::Miou`].
    pub miou: T,
    /// [`Metric::Macc`].
    pub macc: T,
    /// [`Metric::Acc25`].
    pub acc25: T,
    /// [`Metric::Acc50`].
    pub acc50: T,
    /// [`Metric::TubeIou`].
    pub tube_iou: T,
    /// [`Metric::Select`].
    pub select: T,
    /// [`Metric::FalsePositiveRate`].
    pub false_positive_rate: T,
}

impl<T: Copy> PerMetric<T> {
    /// Makes each value.
    pub fn of(value: impl Fn(Metric) -> T) -> Self {
        Self {
            miou: value(Metric::Miou),
            macc: value(Metric::Macc),
            acc25: value(Metric::Acc25),
            acc50: value(Metric::Acc50),
            tube_iou: value(Metric::TubeIou),
            select: value(Metric::Select),
            false_positive_rate: value(Metric::FalsePositiveRate),
        }
    }

    /// The value of a metric.
    pub fn get(&self, metric: Metric) -> T {
        match metric {
            Metric::Miou => self.miou,
            Metric::Macc => self.macc,
            Metric::Acc25 => self.acc25,
            Metric::Acc50 => self.acc50,
            Metric::TubeIou => self.tube_iou,
            Metric::Select => self.select,
            Metric::FalsePositiveRate => self.false_positive_rate,
        }
    }
}

/// Ratios, 0 to 1; none where the denominator is zero.
pub type Ratios = PerMetric<Option<f64>>;

impl Ratios {
    /// Means by metric; a missing value is left out.
    pub(crate) fn mean(all: &[Self]) -> Self {
        Self::of(|metric| mean(all.iter().filter_map(|ratios| ratios.get(metric))))
    }
}

/// The mean of some values, summed in their order; none without any.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0_u64), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// A row of a table: percentages and how many queries they rest on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Percent.
    #[serde(flatten)]
    pub percent: PerMetric<Option<f64>>,
    /// Queries with at least one frame that shows the target.
    pub queries: usize,
}

impl Metrics {
    pub(crate) fn new(ratios: &Ratios, queries: usize) -> Self {
        Self { percent: PerMetric::of(|metric| ratios.get(metric).map(|ratio| 100.0 * ratio)), queries }
    }

    /// A metric, percent.
    pub fn get(&self, metric: Metric) -> Option<f64> {
        self.percent.get(metric)
    }
}

pub(crate) fn ratio(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

/// A query of a scene with one row per (intersection, union, truth); predicted follows.
#[cfg(test)]
pub(crate) fn made_up(id: &str, category: Category, scale: Scale, rows: &[(u64, u64, u64)]) -> QueryTally {
    let id: QueryId = id.parse().expect("an id");
    let thing = Name::new("a").expect("a name");
    let count = |(frame, &(intersection, union, truth)): (usize, &(u64, u64, u64))| FrameCount {
        query: id.clone(),
        frame: frame as u32,
        state: State::Hit,
        intersection,
        union,
        predicted: union + intersection - truth,
        truth,
        instance: (intersection > 0).then(|| thing.clone()),
        instance_overlap: intersection,
    };
    let counts: Vec<FrameCount> = rows.iter().enumerate().map(count).collect();
    let (categories, referents) = (vec![category], vec![thing.clone()]);
    let facts = QueryFacts { id: id.clone(), categories, scale, referents, verified: false };
    QueryTally::of(facts, &counts, &Options::default())
}
