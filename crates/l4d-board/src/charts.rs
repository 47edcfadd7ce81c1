//! Plain charts of counts and distributions for other verbs: panels of bars, and nothing that knows what they mean.

use std::path::{Path, PathBuf};

use crate::error::BoardError;
use crate::figures;

/// A figure of panels side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// File stem.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// At least one.
    pub panels: Vec<Panel>,
}

/// One distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Heading.
    pub title: String,
    /// What the numbers count, or what the bins measure.
    pub note: String,
    /// Label and count of each bar, in order.
    pub bars: Vec<(String, usize)>,
    /// How the bars lie.
    pub layout: Layout,
}

/// How bars lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Labels left of bars, for names.
    Rows,
    /// Bars side by side, for bins in order.
    Columns,
}

/// Writes each chart as `<name>.svg` and `<name>.png` into `folder`; gives the paths in order.
pub fn publish_charts(charts: &[Chart], folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let mut paths = Vec::new();
    for chart in charts {
        paths.extend(figures::write(chart.name, &figures::chart(chart), folder)?);
    }
    Ok(paths)
}
