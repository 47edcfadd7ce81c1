//! Rows, and how they reach people: CSV, text, a figure.

use serde::Serialize;

use super::measure::Sums;
use super::variants::BASE;
use crate::csv_file::rounded;

/// One lift, as means over queries. Fields that end in `_seconds` are times; everything else is the same in every run.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Rows that belong together.
    pub series: String,
    /// The lift and its settings.
    pub setting: String,
    /// Per query.
    pub lift_seconds: f64,
    /// Per query.
    pub mask_seconds: f64,
    /// Of the held-out view, percent.
    pub miou: f64,
    /// The same over all frames together.
    pub tube_iou: f64,
    /// Pixels that come and go, percent of the true area per frame.
    pub flicker: Option<f64>,
    /// That were measured.
    pub queries: usize,
}

impl Row {
    /// Whether it is the lift that users get by default.
    pub fn is_base(&self) -> bool {
        self.setting == BASE
    }

    /// None without a query whose target is ever present.
    pub(super) fn new(series: String, setting: String, sums: &Sums) -> Option<Self> {
        let queries = sums.queries;
        let mean = |sum: f64| rounded(sum / queries as f64);
        (queries > 0).then(|| Self {
            series,
            setting,
            lift_seconds: mean(sums.lift_seconds),
            mask_seconds: mean(sums.mask_seconds),
            miou: mean(100.0 * sums.miou),
            tube_iou: mean(100.0 * sums.tube_iou),
            flicker: (sums.flicker_queries > 0).then(|| rounded(sums.flicker / sums.flicker_queries as f64)),
            queries,
        })
    }
}

/// The table for a terminal.
pub fn text(rows: &[Row]) -> String {
    let titles = ("setting", "lift, s", "masks, s", "mIoU", "tube IoU", "flicker");
    let mut lines = vec![format!(
        "{:<42}{:>10}{:>10}{:>9}{:>10}{:>9}",
        titles.0, titles.1, titles.2, titles.3, titles.4, titles.5
    )];
    for row in rows {
        let flicker = row.flicker.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        lines.push(format!(
            "{:<42}{:>10.3}{:>10.3}{:>9.2}{:>10.2}{flicker:>9}",
            row.setting, row.lift_seconds, row.mask_seconds, row.miou, row.tube_iou
        ));
    }
    lines.join("\n")
}
