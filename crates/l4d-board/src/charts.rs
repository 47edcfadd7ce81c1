//! Figures for other verbs, which say what was measured: counts, scores against a setting, cost against gain.

use std::path::{Path, PathBuf};

use l4d_data::store::write_atomic;
use l4d_score::cluster::FEW_SCENES;

use crate::error::BoardError;
use crate::figures::canvas::{self, Plot};
use crate::figures::{counts::Counts, scatter};

/// Panels of bars side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    pub name: &'static str,
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// At least one.
    pub panels: Vec<Panel>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
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

/// What a score does while a setting grows, in panels on common axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    pub name: &'static str,
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// What is set.
    pub setting: String,
    /// What is measured, percent.
    pub score: String,
    /// One for each kind of queries.
    pub panels: Vec<TrendPanel>,
}

/// One kind of queries.
#[derive(Debug, Clone, PartialEq)]
pub struct TrendPanel {
    /// What it is of.
    pub title: String,
    /// What was measured, in any order.
    pub measured: Vec<TrendPoint>,
    /// What a paper reports, of other data; in any order.
    pub reported: Vec<TrendPoint>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrendPoint {
    pub at: f64,
    /// Percent.
    pub value: f64,
    /// Low and high end of its interval, percent.
    pub interval: Option<[f64; 2]>,
    /// Whether it rests on too few scenes for its interval to be trusted.
    pub is_of_few_scenes: bool,
}

/// What is paid against what is had for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tradeoff {
    pub name: &'static str,
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// What is paid, with its unit; less is better.
    pub cost: String,
    /// What is had, with its unit; more is better.
    pub gain: String,
    /// In any order.
    pub points: Vec<TradePoint>,
}

/// One way to do it.
#[derive(Debug, Clone, PartialEq)]
pub struct TradePoint {
    /// What was changed.
    pub series: String,
    pub label: String,
    /// What it costs, above 0.
    pub cost: f64,
    /// What it gives.
    pub gain: f64,
    /// Whether the others are measured against it.
    pub is_base: bool,
}

/// Draws each chart as `<name>.svg` and `<name>.png`; gives names and bytes in order.
///
/// # Errors
/// What plotters refuses.
pub fn draw_charts(charts: &[Chart]) -> Result<Vec<(String, Vec<u8>)>, BoardError> {
    let draw = |chart: &Chart| canvas::files(chart.name, &chart.title, &chart.notes, &Counts(&chart.panels));
    Ok(charts.iter().map(draw).collect::<Result<Vec<_>, BoardError>>()?.into_iter().flatten().collect())
}

/// Writes the figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
///
/// # Errors
/// No points, values that are no percentages, and what plotters or the disk refuses.
pub fn publish_trend(trend: &Trend, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let is_percentage = |value: &f64| (0.0..=100.0 + 1e-6).contains(value);
    let is_sound = |point: &TrendPoint| {
        point.at.is_finite()
            && is_percentage(&point.value)
            && point.interval.iter().flatten().all(is_percentage)
    };
    let points: Vec<&TrendPoint> =
        trend.panels.iter().flat_map(|panel| panel.measured.iter().chain(&panel.reported)).collect();
    if let Some(point) = points.iter().find(|point| !is_sound(point)) {
        let message = format!("`{}` at {} is {}", trend.title, point.at, point.value);
        return Err(BoardError::render(trend.name, message));
    }
    if points.is_empty() {
        return Err(BoardError::render(trend.name, "there are no points"));
    }
    let mut notes = trend.notes.clone();
    if points.iter().any(|point| point.interval.is_some() && point.is_of_few_scenes) {
        notes.push(format!("Intervals from fewer than {FEW_SCENES} scenes may be too narrow."));
    }
    write((trend.name, &trend.title, &notes), trend, folder)
}

/// Writes the figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
///
/// # Errors
/// No points, a cost that is not positive, values that are not finite, and what plotters or the disk refuses.
pub fn publish_tradeoff(tradeoff: &Tradeoff, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let is_sound = |point: &&TradePoint| point.cost.is_finite() && point.cost > 0.0 && point.gain.is_finite();
    if let Some(point) = tradeoff.points.iter().find(|point| !is_sound(point)) {
        let message = format!("`{}` costs {} and gives {}", point.label, point.cost, point.gain);
        return Err(BoardError::render(tradeoff.name, message));
    }
    if tradeoff.points.is_empty() {
        return Err(BoardError::render(tradeoff.name, "there are no points"));
    }
    write((tradeoff.name, &tradeoff.title, &tradeoff.notes), &scatter::tradeoff(tradeoff), folder)
}

fn write(
    (name, title, notes): (&str, &str, &[String]),
    plot: &impl Plot,
    folder: &Path,
) -> Result<Vec<PathBuf>, BoardError> {
    let mut paths = Vec::new();
    for (file, bytes) in canvas::files(name, title, notes, plot)? {
        let path = folder.join(file);
        write_atomic(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chart_is_drawn_and_what_cannot_be_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let bars = |count: usize| (0..count).map(|bar| (format!("bar {bar}"), bar * 37)).collect();
        let panel = |layout| Panel { title: "Outdoor".into(), note: "pixels".into(), bars: bars(8), layout };
        let panels = vec![panel(Layout::Rows), panel(Layout::Columns), panel(Layout::Columns)];
        let chart = Chart { name: "sizes", title: "Sizes".into(), notes: Vec::new(), panels };
        assert_eq!(draw_charts(&[chart]).unwrap().len(), 2);

        let point = |at: f64, value: f64| TrendPoint {
            at,
            value,
            interval: Some([value - 6.0, value + 6.0]),
            is_of_few_scenes: true,
        };
        let panel = |measured: Vec<TrendPoint>| TrendPanel {
            title: "all".into(),
            measured,
            reported: vec![point(2.0, 45.0)],
        };
        let mut trend = Trend {
            name: "views",
            title: "Views".into(),
            notes: vec!["of scenes".into()],
            setting: "views".into(),
            score: "mIoU, %".into(),
            panels: vec![panel(vec![point(1.0, 40.0), point(4.0, 50.0)]), panel(Vec::new())],
        };
        assert_eq!(publish_trend(&trend, folder.path()).unwrap().len(), 2);
        trend.panels[0].measured[0].value = 101.0;
        let error = publish_trend(&trend, folder.path()).unwrap_err().to_string();
        assert_eq!(error, "cannot make views: `Views` at 1 is 101");
        trend.panels.clear();
        assert!(publish_trend(&trend, folder.path()).unwrap_err().to_string().contains("no points"));

        let point = |cost: f64, gain: f64| TradePoint {
            series: "fewer Gaussians".into(),
            label: "half".into(),
            cost,
            gain,
            is_base: cost == 2.0,
        };
        let made = |points| Tradeoff {
            name: "splats",
            title: "Speed against error".into(),
            notes: Vec::new(),
            cost: "milliseconds".into(),
            gain: "PSNR, dB".into(),
            points,
        };
        let publish = |points| publish_tradeoff(&made(points), folder.path());
        assert_eq!(publish(vec![point(2.0, 30.0), point(20.0, 39.0), point(3.0, 29.0)]).unwrap().len(), 2);
        let refused = |points| publish(points).unwrap_err().to_string();
        assert!(
            refused(Vec::new()).contains("no points") && refused(vec![point(0.0, 1.0)]).contains("costs 0")
        );
        assert!(refused(vec![point(1.0, f64::INFINITY)]).contains("gives inf"));
    }
}
