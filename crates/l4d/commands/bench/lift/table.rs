//! Rows, and how they reach people: CSV, text, a figure.

use anyhow::Result;
use l4d_board::{TradePoint, Tradeoff};
use serde::Serialize;

use super::measure::Sums;
use super::ways::BASE;

/// One lift, as means over queries. Fields that end in `_seconds` are times; everything else is the same in every run.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    series: String,
    setting: String,
    lift_seconds: f64,
    mask_seconds: f64,
    /// Of the held-out view, percent.
    miou: f64,
    tube_iou: f64,
    /// Pixels that come and go, percent of the true area a frame.
    flicker: Option<f64>,
    pub(super) queries: usize,
}

impl Row {
    /// None without a query whose target is ever present.
    pub(super) fn new(series: String, setting: String, sums: &Sums) -> Option<Self> {
        let rounded = |value: f64| (value * 1e4).round() / 1e4;
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

pub(super) fn csv_of(rows: &[Row]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.into_inner()?)
}

/// The table for a terminal.
pub(super) fn text(rows: &[Row]) -> String {
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

pub(super) fn figure(about: &str, machine: &str, rows: &[Row]) -> Tradeoff {
    let points = rows.iter().map(|row| TradePoint {
        series: row.series.clone(),
        label: row.setting.clone(),
        cost: row.lift_seconds.max(1e-3),
        gain: row.miou,
        is_base: row.setting == BASE,
    });
    Tradeoff {
        name: "lift",
        title: "Lifting an answer: speed against error".to_owned(),
        notes: vec![
            format!("{about}."),
            format!("{machine}."),
            "Evidence is what training views truly show: this measures lifting alone. Ring: the default. Grey: what nothing \
             beats."
                .to_owned(),
        ],
        cost: "seconds a lift".to_owned(),
        gain: "mIoU of the held-out view, percent".to_owned(),
        points: points.collect(),
    }
}
