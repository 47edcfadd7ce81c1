//! The figure of the grid of views: how much more each view buys, beside what the paper prints of its own data.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_board::{Trend, TrendPanel, TrendPoint, publish_trend};
use l4d_experiments::ablation::{Ablated, Cell, Column, Metric, Source};
use l4d_score::cluster::FEW_SCENES;

use crate::out::Printer;

/// Writes the figure, if any setting is a number.
pub(crate) fn publish_views(ablated: &Ablated, folder: &Path, _: &Printer) -> Result<Vec<PathBuf>> {
    match trend_of_views(&ablated.columns, &ablated.cells, &ablated.about) {
        Some(trend) => Ok(publish_trend(&trend, folder)?),
        None => Ok(Vec::new()),
    }
}

/// mIoU against the number of views; none for settings that are no numbers.
fn trend_of_views(columns: &[Column], cells: &[Cell], about: &[String]) -> Option<Trend> {
    let of_column = |column: &Column, source: Source| {
        let cells = cells.iter().filter(move |cell| {
            cell.source == source && cell.metric == Metric::Miou && cell.column == column.name
        });
        cells.filter_map(point).collect::<Vec<TrendPoint>>()
    };
    let panel = |column: &Column| TrendPanel {
        title: column.name.clone(),
        measured: of_column(column, Source::Measured),
        reported: of_column(column, Source::Published),
    };
    let mut panels: Vec<TrendPanel> = columns.iter().map(panel).collect();
    panels.retain(|panel| !(panel.measured.is_empty() && panel.reported.is_empty()));
    panels.iter().any(|panel| !panel.measured.is_empty()).then(|| Trend {
        name: "views",
        title: "Views against score".to_owned(),
        notes: about.to_vec(),
        setting: "training views that are asked".to_owned(),
        score: "mIoU, %".to_owned(),
        panels,
    })
}

fn point(cell: &Cell) -> Option<TrendPoint> {
    Some(TrendPoint {
        at: cell.setting.parse().ok()?,
        value: cell.value,
        interval: cell.low.zip(cell.high).map(|(low, high)| [low, high]),
        is_of_few_scenes: cell.scenes.is_some_and(|scenes| scenes < FEW_SCENES),
    })
}
