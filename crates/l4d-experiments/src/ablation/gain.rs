//! What consensus changes: differences of two runs, query by query, on the same queries and the same errors.

use std::collections::BTreeMap;

use l4d_data::Name;
use l4d_data::published::Published;
use l4d_score::Estimate;
use l4d_score::metrics::QueryTally;

use super::grid::{Pair, WITH, WITHOUT};
use super::measure::Measured;
use super::table::{Cell, Column, Metric};

/// A difference of one kind of queries.
#[derive(Debug, Clone)]
pub(super) struct Gain {
    /// The row with consensus.
    pub(super) row: &'static str,
    /// Of the errors of the views, where they are made up.
    pub(super) correlation: Option<f64>,
    pub(super) column: String,
    pub(super) metric: Metric,
    /// With consensus less without, percentage points.
    pub(super) found: Estimate,
    /// The same of the paper, from its two rows.
    pub(super) published: Option<f64>,
    pub(super) used_truth: bool,
}

/// A scene in which consensus loses.
#[derive(Debug, Clone)]
pub(super) struct LosingScene {
    pub(super) correlation: Option<f64>,
    pub(super) scene: Name,
    /// Mean over its queries, mIoU, percentage points.
    pub(super) points: f64,
    pub(super) queries: usize,
}

impl Gain {
    /// What the interval says.
    pub(super) fn verdict(&self) -> &'static str {
        if self.found.is_above_zero() {
            "gains"
        } else if self.found.is_below_zero() {
            "loses"
        } else {
            "not told apart"
        }
    }

    pub(super) fn cell(&self) -> Cell {
        let rho = self.correlation.map(|rho| format!(", rho {rho}")).unwrap_or_default();
        Cell::measured(
            &format!("{} - {WITHOUT}{rho}", self.row),
            &self.column,
            self.metric,
            &self.found,
            self.used_truth,
        )
    }
}

/// All differences of the pairs.
pub(super) fn gains(
    pairs: &[Pair],
    rows: &[Measured],
    columns: &[Column],
    published: Option<&Published>,
    seed: u64,
) -> Vec<Gain> {
    let mut gains = Vec::new();
    for (pair, without, with) in both(pairs, rows) {
        for column in columns {
            for metric in Metric::ALL {
                let of = |row: &'_ Measured| -> Vec<QueryTally> {
                    row.tallies.iter().filter(|tally| column.has(tally)).cloned().collect()
                };
                let (before, after) = (of(without), of(with));
                let found = Estimate::of_gain(&before, &after, |ratios| metric.of(ratios), seed);
                let printed = |setting| published?.value(setting, &column.name, metric.published()?);
                gains.extend(found.map(|found| Gain {
                    row: pair.row,
                    correlation: pair.correlation,
                    column: column.name.clone(),
                    metric,
                    found,
                    published: printed(pair.row).zip(printed(WITHOUT)).map(|(with, without)| with - without),
                    used_truth: with.uses_truth,
                }));
            }
        }
    }
    gains
}

/// The scenes that lose with consensus as users get it, worst first.
pub(super) fn losing_scenes(pairs: &[Pair], rows: &[Measured]) -> Vec<LosingScene> {
    let mut losing = Vec::new();
    for (pair, without, with) in both(pairs, rows).filter(|(pair, ..)| pair.row == WITH) {
        let mut scenes: BTreeMap<&Name, (f64, usize)> = BTreeMap::new();
        let before: BTreeMap<_, _> =
            without.tallies.iter().map(|tally| (&tally.facts.id, tally.ratios().miou)).collect();
        for tally in &with.tallies {
            let known = before.get(&tally.facts.id).copied().flatten().zip(tally.ratios().miou);
            if let Some((before, after)) = known {
                let (sum, queries) = scenes.entry(&tally.facts.id.scene).or_default();
                *sum += 100.0 * (after - before);
                *queries += 1;
            }
        }
        let mut of_pair: Vec<LosingScene> = scenes
            .into_iter()
            .map(|(scene, (sum, queries))| LosingScene {
                correlation: pair.correlation,
                scene: scene.clone(),
                points: sum / queries as f64,
                queries,
            })
            .filter(|scene| scene.points < 0.0)
            .collect();
        of_pair.sort_by(|a, b| a.points.total_cmp(&b.points));
        losing.extend(of_pair);
    }
    losing
}

fn both<'a>(
    pairs: &'a [Pair],
    rows: &'a [Measured],
) -> impl Iterator<Item = (&'a Pair, &'a Measured, &'a Measured)> {
    pairs.iter().filter_map(|pair| Some((pair, rows.get(pair.without)?, rows.get(pair.with)?)))
}
