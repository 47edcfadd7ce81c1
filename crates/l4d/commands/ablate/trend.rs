//! The figure of the grid of views: how much more each view buys, beside what the paper prints of its own data.

use l4d_board::{Trend, TrendPoint, TrendSeries};

use super::table::{Cell, Column, Metric, Source};

/// mIoU against the number of views; none for settings that are no numbers.
pub(super) fn trend_of_views(columns: &[Column], cells: &[Cell], about: &[String]) -> Option<Trend> {
    let mut series = Vec::new();
    for source in [Source::Measured, Source::Published] {
        let is_reported = source == Source::Published;
        for column in columns {
            let of_column = cells.iter().filter(|cell| {
                cell.source == source && cell.metric == Metric::Miou && cell.column == column.name
            });
            let points: Vec<TrendPoint> = of_column
                .filter_map(|cell| {
                    let at = cell.setting.parse().ok()?;
                    let interval = cell.low.zip(cell.high).map(|(low, high)| [low, high]);
                    Some(TrendPoint { at, value: cell.value, interval })
                })
                .collect();
            if !points.is_empty() {
                let name = match is_reported {
                    true => format!("{} (paper)", column.name),
                    false => column.name.clone(),
                };
                series.push(TrendSeries { name, is_reported, points });
            }
        }
    }
    let is_measured = series.iter().any(|series: &TrendSeries| !series.is_reported);
    let mut notes = about.to_vec();
    notes.push(
        "Whiskers: 95 % intervals over scenes. Dashed: as the paper reports it, of other data.".to_owned(),
    );
    is_measured.then(|| Trend {
        name: "views",
        title: "Views against score".to_owned(),
        notes,
        setting: "training views that are asked".to_owned(),
        score: "mIoU, %".to_owned(),
        series,
    })
}
