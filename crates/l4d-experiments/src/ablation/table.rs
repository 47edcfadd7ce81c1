//! The table: rows are settings, columns are kinds of queries. Measured numbers have intervals and sizes; published
//! ones are below them and belong to another data set.

use std::collections::BTreeSet;

use l4d_data::published::{self, Published};
use l4d_data::{Category, Scale};
use l4d_score::Estimate;
use l4d_score::metrics::{QueryTally, Ratios};
use serde::Serialize;

use super::grid::Grid;
use super::measure::Measured;
use crate::csv_file::rounded;

/// The column of all queries together, which the paper does not have.
const ALL: &str = "all";

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    Macc,
    Miou,
    /// IoU over all frames together.
    TubeIou,
    /// Share of queries whose referent is overlapped most.
    Select,
}

impl Metric {
    pub(super) const ALL: [Self; 4] = [Self::Macc, Self::Miou, Self::TubeIou, Self::Select];
    /// Those that the paper prints.
    pub(super) const PRINTED: [Self; 2] = [Self::Macc, Self::Miou];

    pub(super) fn of(self, ratios: &Ratios) -> Option<f64> {
        match self {
            Self::Macc => ratios.macc,
            Self::Miou => ratios.miou,
            Self::TubeIou => ratios.tube_iou,
            Self::Select => ratios.select,
        }
    }

    /// As people write it.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Macc => "mAcc",
            Self::Miou => "mIoU",
            Self::TubeIou => "tube IoU",
            Self::Select => "select",
        }
    }
}

impl From<published::Metric> for Metric {
    fn from(metric: published::Metric) -> Self {
        match metric {
            published::Metric::Macc => Self::Macc,
            published::Metric::Miou => Self::Miou,
        }
    }
}

/// Where a number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    Measured,
    /// Printed in the paper, of another data set.
    Published,
}

/// A row of the CSV.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// Row of the table.
    pub setting: String,
    /// Kind of queries.
    pub column: String,
    /// What is measured.
    pub metric: Metric,
    /// Percent, or percentage points.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// How many there are.
    pub queries: Option<usize>,
    /// In how many scenes.
    pub scenes: Option<usize>,
    /// Where it comes from.
    pub source: Source,
    /// Whether the truth was looked at.
    pub used_truth: bool,
}

impl Cell {
    pub(super) fn measured(
        setting: &str,
        column: &str,
        metric: Metric,
        found: &Estimate,
        used_truth: bool,
    ) -> Self {
        let [low, high] = found.interval.map_or([None; 2], |ends| ends.map(|end| Some(rounded(end))));
        Self {
            setting: setting.to_owned(),
            column: column.to_owned(),
            metric,
            value: rounded(found.value),
            low,
            high,
            queries: Some(found.queries),
            scenes: Some(found.scenes),
            source: Source::Measured,
            used_truth,
        }
    }
}

/// A kind of queries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// `attribute`, `action+spatial`, `all`.
    pub name: String,
    /// None for all queries.
    categories: Option<BTreeSet<Category>>,
}

impl Column {
    pub(super) fn has(&self, tally: &QueryTally) -> bool {
        let own: BTreeSet<Category> = tally.facts.categories.iter().copied().collect();
        self.categories.as_ref().is_none_or(|categories| *categories == own)
    }
}

/// Those of the paper in its order, kinds of queries that only this benchmark has, and all of them.
pub(super) fn columns(published: Option<&Published>, rows: &[Measured]) -> Vec<Column> {
    let parse = |name: &str| -> Option<BTreeSet<Category>> {
        let category = |word: &str| Category::ALL.into_iter().find(|category| category.as_str() == word);
        name.split('+').map(category).collect()
    };
    let printed = published.map(Published::columns).unwrap_or_default();
    let column = |name: &str| Some(Column { name: name.to_owned(), categories: Some(parse(name)?) });
    let mut columns: Vec<Column> = printed.into_iter().filter_map(column).collect();
    for tally in rows.iter().flat_map(|row| &row.tallies) {
        if !columns.iter().any(|column| column.has(tally)) {
            let categories: BTreeSet<Category> = tally.facts.categories.iter().copied().collect();
            let words: Vec<&str> = categories.iter().map(|category| category.as_str()).collect();
            columns.push(Column { name: words.join("+"), categories: Some(categories) });
        }
    }
    columns.push(Column { name: ALL.to_owned(), categories: None });
    columns
}

/// All numbers: measured rows, then published ones.
pub(super) fn cells(
    grid: Grid,
    rows: &[Measured],
    columns: &[Column],
    published: Option<&Published>,
    seed: u64,
) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut add = |setting: &str, row: &Measured, scale: Option<Scale>| {
        for column in columns {
            let belongs = |tally: &&QueryTally| {
                column.has(tally) && scale.is_none_or(|scale| tally.facts.scale == scale)
            };
            for metric in Metric::ALL {
                let tallies = row.tallies.iter().filter(belongs);
                if let Some(found) = Estimate::of_ratio(tallies, |ratios| metric.of(ratios), seed) {
                    cells.push(Cell::measured(setting, &column.name, metric, &found, row.uses_truth));
                }
            }
        }
    };
    for row in rows {
        if grid == Grid::Scales {
            for scale in Scale::ALL {
                add(scale.as_str(), row, Some(scale));
            }
        } else {
            add(&row.setting, row, None);
        }
    }
    let figures = published.map(Published::figures).unwrap_or_default();
    cells.extend(figures.iter().map(|figure| Cell {
        setting: figure.setting.clone(),
        column: figure.column.clone(),
        metric: figure.metric.into(),
        value: figure.value,
        low: None,
        high: None,
        queries: None,
        scenes: None,
        source: Source::Published,
        used_truth: false,
    }));
    cells
}

/// The settings of a source, in the order of the table.
pub(super) fn settings(cells: &[Cell], source: Source) -> Vec<&str> {
    let mut settings: Vec<&str> = Vec::new();
    for cell in cells.iter().filter(|cell| cell.source == source) {
        if !settings.contains(&cell.setting.as_str()) {
            settings.push(&cell.setting);
        }
    }
    settings
}

pub(super) fn cell<'a>(
    cells: &'a [Cell],
    source: Source,
    setting: &str,
    column: &str,
    metric: Metric,
) -> Option<&'a Cell> {
    cells.iter().find(|cell| {
        cell.source == source && cell.setting == setting && cell.column == column && cell.metric == metric
    })
}
