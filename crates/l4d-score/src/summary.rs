//! `summary.json`: the scores of one method with everything that they depend on. Derived from `counts.csv`, kept so
//! that a leaderboard needs neither truth nor queries. Computes no score itself.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::results::{MethodCard, Used};
use l4d_data::{DataError, Name, Profile, QueryId, QuerySet, json};
use serde::{Deserialize, Serialize};

use crate::averages::Breakdown;
use crate::baseline::Baseline;
use crate::eval_set::EvalSet;
use crate::metrics::{Missing, Options, QueryTally};

/// Schema tag of a summary.
pub const SCHEMA: &str = "l4d/score/1";
/// Why a method that left out frames is not ranked.
pub const PARTIAL: &str = "partial";

fn is_headline(set: &QuerySet) -> bool {
    *set == QuerySet::default()
}

/// Scores of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// [`SCHEMA`].
    pub schema: String,
    pub name: Name,
    /// Of the method.
    pub version: String,
    /// Paper or code, may be empty.
    pub link: String,
    /// What the method looked at.
    pub used: Used,
    /// Whether its card says that it is a baseline.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub baseline: bool,
    /// Wall-clock time of the method for all queries, seconds.
    pub seconds: Option<f64>,
    /// What the method reports of itself; never scored.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reported: BTreeMap<String, f64>,
    /// Name of the protocol that the scores follow.
    pub protocol: String,
    /// Profile of truth and masks.
    pub profile: Profile,
    pub benchmark_version: String,
    /// [`l4d_data::Benchmark::truth_digest`].
    pub truth_digest: String,
    /// Which sentences were asked.
    #[serde(default, skip_serializing_if = "is_headline")]
    pub set: QuerySet,
    /// Options of scoring that change the numbers.
    pub options: Options,
    /// Whether frames without an answer were left out, which makes the scores incomparable.
    pub partial: bool,
    /// Frames without an answer.
    pub missing_frames: u64,
    /// Queries that were asked: the counted ones and those whose target is never present.
    pub asked_queries: usize,
    /// How many of them people have verified.
    pub verified_queries: usize,
    /// Queries of the same scenes that were not asked, because people rejected them.
    #[serde(default)]
    pub rejected_queries: usize,
    /// Queries whose target is visible in no scored frame; no mean includes them.
    pub never_present: Vec<QueryId>,
    #[serde(flatten)]
    pub scores: Breakdown,
}

/// Why a method is not ranked, as far as its name and card say.
pub(crate) fn handicaps(name: &Name, is_baseline: bool, used: &Used) -> Vec<&'static str> {
    let reasons = [
        (is_baseline || Baseline::is_name_of_one(name), "baseline"),
        (used.ground_truth, "used ground truth"),
        (used.test_view, "saw the held-out view"),
    ];
    reasons.into_iter().filter(|(holds, _)| *holds).map(|(_, reason)| reason).collect()
}

impl Summary {
    /// Averages the tallies of a method's queries.
    pub fn new(card: MethodCard, eval_set: &EvalSet, options: &Options, tallies: &[QueryTally]) -> Self {
        let missing_frames = tallies.iter().map(|tally| tally.missing_frames).sum();
        Self {
            schema: SCHEMA.to_owned(),
            name: card.name,
            version: card.version,
            link: card.link,
            used: card.used,
            baseline: card.baseline,
            seconds: card.seconds,
            reported: card.reported,
            protocol: card.protocol,
            profile: eval_set.profile,
            benchmark_version: card.benchmark_version,
            truth_digest: card.truth_digest,
            set: eval_set.set,
            options: *options,
            partial: options.missing == Missing::Skip && missing_frames > 0,
            missing_frames,
            asked_queries: tallies.len(),
            verified_queries: tallies.iter().filter(|tally| tally.facts.verified).count(),
            rejected_queries: eval_set.rejected(),
            never_present: tallies
                .iter()
                .filter(|tally| !tally.is_counted())
                .map(|tally| tally.facts.id.clone())
                .collect(),
            scores: Breakdown::of(tallies),
        }
    }

    /// Why the method is shown for comparison but not ranked; empty if it is ranked.
    pub fn unranked_because(&self) -> Vec<&'static str> {
        let mut reasons = handicaps(&self.name, self.baseline, &self.used);
        reasons.extend(self.partial.then_some(PARTIAL));
        reasons.extend(self.scores.headline.percent.miou.is_none().then_some("no query with a target"));
        reasons
    }

    /// Reads `summary.json`.
    ///
    /// # Errors
    /// A file that is no summary, or of another schema.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let summary: Self = json::read(path)?;
        if summary.schema != SCHEMA {
            let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", summary.schema);
            return Err(DataError::invalid(path, "field `schema`", message, "run `l4d score` again"));
        }
        Ok(summary)
    }
}
