//! A setting against a score for other verbs: panels of lines with intervals, and nothing that knows what was set.

use std::path::{Path, PathBuf};

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
    /// One for each kind of queries, on common axes.
    pub panels: Vec<TrendPanel>,
}

/// One kind of queries.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendPanel {
    /// What it is of.
    pub title: String,
    /// What was measured, in any order.
    pub measured: Vec<TrendPoint>,
    /// What somebody else printed, of other data; in any order.
    pub reported: Vec<TrendPoint>,
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
    /// Whether it rests on too few scenes for its interval to be trusted.
    pub is_of_few_scenes: bool,
}

/// Writes the figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
///
/// # Errors
/// No points, values that are no percentages, and what the disk refuses.
pub fn publish_trend(trend: &Trend, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let figure = trend.name;
    let failed = |message: String| BoardError::Figure { figure: figure.to_owned(), message };
    let mut points = trend
        .panels
        .iter()
        .flat_map(|panel| panel.measured.iter().chain(&panel.reported).map(move |point| (panel, point)));
    if points.clone().next().is_none() {
        return Err(failed("there are no points".to_owned()));
    }
    let is_sound = |point: &TrendPoint| {
        let is_percentage = |value: &f64| (0.0..=100.0 + 1e-6).contains(value);
        point.at.is_finite()
            && is_percentage(&point.value)
            && point.interval.iter().flatten().all(is_percentage)
    };
    if let Some((panel, point)) = points.find(|(_, point)| !is_sound(point)) {
        return Err(failed(format!("`{}` at {} is {}", panel.title, point.at, point.value)));
    }
    figures::write(figure, &figures::trend(trend), folder)
}
