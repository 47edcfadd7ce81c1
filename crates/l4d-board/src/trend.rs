//! A setting against a score for other verbs: lines with intervals, and nothing that knows what was set.

use std::path::{Path, PathBuf};

use l4d_data::store::write_atomic;

use crate::error::BoardError;
use crate::figures;

/// A figure of what a score does while a setting grows.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// File stem.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// What is set.
    pub setting: String,
    /// What is measured, percent.
    pub score: String,
    /// One line each; those that are reported are dashed and without intervals.
    pub series: Vec<TrendSeries>,
}

/// One line.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendSeries {
    /// What it is of.
    pub name: String,
    /// Whether somebody else printed the numbers, of other data.
    pub is_reported: bool,
    /// In any order.
    pub points: Vec<TrendPoint>,
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendPoint {
    /// The setting.
    pub at: f64,
    /// Percent.
    pub value: f64,
    /// Low and high end of its interval, percent.
    pub interval: Option<[f64; 2]>,
}

/// Writes the figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
///
/// # Errors
/// No points, values that are no percentages, and what the disk refuses.
pub fn publish_trend(trend: &Trend, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let figure = trend.name;
    let failed = |message: String| BoardError::Figure { figure, message };
    let mut points =
        trend.series.iter().flat_map(|series| series.points.iter().map(move |point| (series, point)));
    if points.clone().next().is_none() {
        return Err(failed("there are no points".to_owned()));
    }
    let is_sound = |point: &TrendPoint| {
        let is_percentage = |value: &f64| (0.0..=100.0 + 1e-6).contains(value);
        point.at.is_finite()
            && is_percentage(&point.value)
            && point.interval.iter().flatten().all(is_percentage)
    };
    if let Some((series, point)) = points.find(|(_, point)| !is_sound(point)) {
        return Err(failed(format!("`{}` at {} is {}", series.name, point.at, point.value)));
    }
    let drawing = figures::trend(trend);
    let files = [
        (format!("{figure}.svg"), figures::svg(figure, &drawing)?.into_bytes()),
        (format!("{figure}.png"), figures::png(figure, &drawing)?),
    ];
    let mut paths = Vec::new();
    for (name, bytes) in files {
        let path = folder.join(name);
        write_atomic(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}
