//! What the board is made of: one row a method, with the ratios that the judge derived.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Name, Profile};
use l4d_score::metrics::Ratios;
use l4d_score::{Breakdown, Estimate, Estimates, Metrics};

use crate::error::BoardError;

/// What every table and figure of a board says about itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Heading {
    /// Title of the benchmark.
    pub benchmark: String,
    /// Version of the benchmark.
    pub version: String,
    /// Digest of its truth; results made against another truth are another board's.
    pub truth_digest: String,
    /// Scoring protocol.
    pub protocol: String,
    /// Profile of the masks.
    pub profile: Profile,
    /// Queries that a complete method answers.
    pub queries: usize,
    /// Scenes that they are of.
    pub scenes: usize,
    /// How many of them people have verified.
    pub verified: usize,
    /// Queries that nobody is asked, because people rejected them.
    pub rejected: usize,
}

impl Heading {
    /// `Panoptic-L4D 1.0.0 · protocol l4d · profile small · 281 queries, 281 verified by people, 8 rejected`; what
    /// they rejected is not among the queries.
    pub fn line(&self) -> String {
        let Self { benchmark, version, protocol, profile, queries, verified, rejected, .. } = self;
        let noun = if *queries == 1 { "query" } else { "queries" };
        let left_out = if *rejected == 0 { String::new() } else { format!(", {rejected} rejected") };
        format!(
            "{benchmark} {version} · protocol {protocol} · profile {profile} · {queries} {noun}, {verified} verified by people{left_out}"
        )
    }
}

/// The columns of a table, as data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// [`Metrics::miou`].
    Miou,
    /// [`Metrics::macc`].
    Macc,
    /// [`Metrics::acc25`].
    Acc25,
    /// [`Metrics::acc50`].
    Acc50,
    /// [`Metrics::tube_iou`].
    TubeIou,
    /// [`Metrics::select`].
    Select,
    /// [`Metrics::false_positive_rate`].
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

    /// Column name in CSV files.
    pub fn key(self) -> &'static str {
        match self {
            Self::Miou => "miou",
            Self::Macc => "macc",
            Self::Acc25 => "acc25",
            Self::Acc50 => "acc50",
            Self::TubeIou => "tube_iou",
            Self::Select => "select",
            Self::FalsePositiveRate => "false_positive_rate",
        }
    }

    /// Column title for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Miou => "mIoU",
            Self::Macc => "mAcc",
            Self::Acc25 => "Acc@0.25",
            Self::Acc50 => "Acc@0.5",
            Self::TubeIou => "tube IoU",
            Self::Select => "select",
            Self::FalsePositiveRate => "FPR",
        }
    }

    /// Whether more is better.
    pub fn higher_is_better(self) -> bool {
        self != Self::FalsePositiveRate
    }

    /// The value of this metric, 0 to 1.
    pub fn of_ratios(self, ratios: &Ratios) -> Option<f64> {
        match self {
            Self::Miou => ratios.miou,
            Self::Macc => ratios.macc,
            Self::Acc25 => ratios.acc25,
            Self::Acc50 => ratios.acc50,
            Self::TubeIou => ratios.tube_iou,
            Self::Select => ratios.select,
            Self::FalsePositiveRate => ratios.false_positive_rate,
        }
    }

    /// The value of this metric with its interval, percent.
    pub fn of_estimates(self, estimates: &Estimates) -> Option<Estimate> {
        match self {
            Self::Miou => estimates.miou,
            Self::Macc => estimates.macc,
            Self::Acc25 => estimates.acc25,
            Self::Acc50 => estimates.acc50,
            Self::TubeIou => estimates.tube_iou,
            Self::Select => estimates.select,
            Self::FalsePositiveRate => estimates.false_positive_rate,
        }
    }

    /// The value of this metric, percent.
    pub fn of(self, metrics: &Metrics) -> Option<f64> {
        match self {
            Self::Miou => metrics.miou,
            Self::Macc => metrics.macc,
            Self::Acc25 => metrics.acc25,
            Self::Acc50 => metrics.acc50,
            Self::TubeIou => metrics.tube_iou,
            Self::Select => metrics.select,
            Self::FalsePositiveRate => metrics.false_positive_rate,
        }
    }
}

/// One scored method.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardRow {
    /// Method.
    pub name: Name,
    /// Its version.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// Profile that it was scored on.
    pub profile: Profile,
    /// Protocol that it was scored with.
    pub protocol: String,
    /// Version of the benchmark that it was scored on.
    pub benchmark_version: String,
    /// Digest of the truth that it was scored against.
    pub truth_digest: String,
    /// With whom it is ranked, if at all.
    pub track: Track,
    /// Why it is not ranked on any board ([`l4d_score::Summary::unranked_because`]); empty for a method that competes.
    pub unranked_because: Vec<&'static str>,
    /// Some answers were missing and skipped.
    pub partial: bool,
    /// Wall seconds of the method, where measured.
    pub seconds: Option<f64>,
    /// Queries that it was asked.
    pub asked: usize,
    /// Its numbers: headline, per group, other averages.
    pub scores: Breakdown,
    /// mIoU with its interval; none for methods of other boards, whose counts are not read.
    pub miou: Option<Estimate>,
    /// Numbers that the method reports of itself, by name; shown beside ours and never ranked.
    pub reported: BTreeMap<String, f64>,
    /// Canonical frame -> mean IoU, percent, over the queries with a true or predicted pixel in that frame.
    pub frames: BTreeMap<u32, f64>,
}

impl BoardRow {
    /// Whether it answered exactly what the board asks, so that it can be compared.
    pub fn is_complete(&self, heading: &Heading) -> bool {
        !self.partial && self.asked == heading.queries
    }

    /// Refuses values that are no percentages and times that are no times.
    pub(crate) fn check(&self) -> Result<(), BoardError> {
        let Breakdown { headline, categories, scales, scenes, averages } = &self.scores;
        let mut groups = vec![(String::new(), headline)];
        groups.extend(
            categories.iter().map(|(key, metrics)| (format!(" of category {}", key.as_str()), metrics)),
        );
        groups.extend(scales.iter().map(|(key, metrics)| (format!(" of scale {}", key.as_str()), metrics)));
        groups.extend(scenes.iter().map(|(key, metrics)| (format!(" of scene {key}"), metrics)));
        groups.extend(averages.iter().map(|(key, metrics)| (format!(" of average {key:?}"), metrics)));
        for (place, metrics) in groups {
            for metric in Metric::ALL {
                let value = metric.of(metrics).unwrap_or(0.0);
                self.must(is_percentage(value), format!("{}{place}", metric.key()), value, "from 0 to 100")?;
            }
        }
        for (frame, &value) in &self.frames {
            self.must(is_percentage(value), format!("mean IoU of frame {frame}"), value, "from 0 to 100")?;
        }
        let seconds = self.seconds.unwrap_or(0.0);
        self.must(seconds.is_finite() && seconds >= 0.0, "seconds".to_owned(), seconds, "a time")
    }

    fn must(&self, holds: bool, field: String, value: f64, must: &'static str) -> Result<(), BoardError> {
        if holds {
            Ok(())
        } else {
            Err(BoardError::Value { method: self.name.to_string(), field, value, must })
        }
    }
}

fn is_percentage(value: f64) -> bool {
    // A mean of ones times a hundred may miss 100 by a rounding step.
    (0.0..=100.0 + 1e-6).contains(&value)
}
