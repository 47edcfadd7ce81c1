//! What consensus changes: differences of two runs, query by query, on the same queries and the same errors.

use l4d_data::published::{self, Published};
use l4d_score::Estimate;
use l4d_score::metrics::QueryTally;

use super::grid::{Pair, WITHOUT};
use super::measure::Measured;
use super::table::{Cell, Column, Metric};

/// Differences of one kind of queries: with consensus less without, percentage points.
#[derive(Debug, Clone)]
pub(super) struct Gain {
    pub(super) pair: Pair,
    pub(super) column: String,
    /// In the order of [`Metric::ALL`].
    pub(super) found: [Option<Estimate>; 4],
    /// mIoU of the paper, from its two rows.
    pub(super) published: Option<f64>,
    used_truth: bool,
}

impl Gain {
    pub(super) fn of(&self, metric: Metric) -> Option<&Estimate> {
        let found = std::iter::zip(Metric::ALL, &self.found).find(|(known, _)| *known == metric);
        found.and_then(|(_, found)| found.as_ref())
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = Cell> {
        let rho = self.pair.correlation.map(|rho| format!(", rho {rho}")).unwrap_or_default();
        let setting = format!("{} - {WITHOUT}{rho}", self.pair.row);
        std::iter::zip(Metric::ALL, &self.found).filter_map(move |(metric, found)| {
            Some(Cell::measured(&setting, &self.column, metric, found.as_ref()?, self.used_truth))
        })
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
    for pair in pairs {
        let [before, after] = [&rows[pair.without], &rows[pair.with]];
        for column in columns {
            let of = |row: &Measured| -> Vec<QueryTally> {
                row.tallies.iter().filter(|tally| column.has(tally)).cloned().collect()
            };
            let (without, with) = (of(before), of(after));
            let gain = |metric: Metric| Estimate::of_gain(&without, &with, |ratios| metric.of(ratios), seed);
            let printed = |setting| published?.value(setting, &column.name, published::Metric::Miou);
            let gain = Gain {
                pair: *pair,
                column: column.name.clone(),
                found: Metric::ALL.map(gain),
                published: printed(pair.row).zip(printed(WITHOUT)).map(|(with, without)| with - without),
                used_truth: after.uses_truth,
            };
            gains.extend(gain.found.iter().any(Option::is_some).then_some(gain));
        }
    }
    gains
}
