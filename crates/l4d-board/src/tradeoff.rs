//! Speed against error for other verbs: points, and nothing that knows what was measured.

use std::path::{Path, PathBuf};

use crate::error::BoardError;
use crate::figures;

/// A figure of what is paid against what is had for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tradeoff {
    /// File stem.
    pub name: &'static str,
    /// Heading.
    pub title: String,
    /// Lines below the heading.
    pub notes: Vec<String>,
    /// What is paid, with its unit; less is better.
    pub cost: String,
    /// What is had, with its unit; more is better.
    pub gain: String,
    /// In any order; those of a series are joined in theirs.
    pub points: Vec<TradePoint>,
}

/// One way to do it.
#[derive(Debug, Clone, PartialEq)]
pub struct TradePoint {
    /// What was changed.
    pub series: String,
    /// To what.
    pub label: String,
    /// What it costs, above 0.
    pub cost: f64,
    /// What it gives.
    pub gain: f64,
    /// Whether the others are measured against it.
    pub is_base: bool,
}

/// Writes the figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
///
/// # Errors
/// No points, a cost that is not positive, values that are not finite, and what the disk refuses.
pub fn publish_tradeoff(tradeoff: &Tradeoff, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let figure = tradeoff.name;
    let failed = |message: String| BoardError::Figure { figure: figure.to_owned(), message };
    if tradeoff.points.is_empty() {
        return Err(failed("there are no points".to_owned()));
    }
    let is_sound = |point: &&TradePoint| point.cost.is_finite() && point.cost > 0.0 && point.gain.is_finite();
    if let Some(point) = tradeoff.points.iter().find(|point| !is_sound(point)) {
        return Err(failed(format!("`{}` costs {} and gives {}", point.label, point.cost, point.gain)));
    }
    figures::write(figure, &figures::tradeoff(tradeoff), folder)
}

/// The points that no other beats, cheapest first: nothing that costs as little or less gives as much or more. Of
/// equals the first.
pub fn front(points: &[TradePoint]) -> Vec<usize> {
    unbeaten(&points.iter().map(|point| (point.cost, point.gain)).collect::<Vec<_>>())
}

/// The same for bare pairs of cost and gain.
pub(crate) fn unbeaten(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((cost_a, gain_a), (cost_b, gain_b)) = (points[a], points[b]);
        cost_a.total_cmp(&cost_b).then(gain_b.total_cmp(&gain_a))
    });
    let mut best = f64::NEG_INFINITY;
    order.retain(|&index| {
        let gives_more = points[index].1 > best;
        best = best.max(points[index].1);
        gives_more
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(cost: f64, gain: f64) -> TradePoint {
        TradePoint { series: String::new(), label: String::new(), cost, gain, is_base: false }
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points =
            [point(3.0, 30.0), point(1.0, 20.0), point(2.0, 20.0), point(4.0, 29.0), point(1.0, 19.0)];
        assert_eq!(front(&points), [1, 0]);
        assert_eq!(front(&[point(1.0, 5.0), point(1.0, 5.0)]), [0]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn what_cannot_be_drawn_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let refused = |points| {
            let tradeoff = Tradeoff {
                name: "x",
                title: String::new(),
                notes: Vec::new(),
                cost: String::new(),
                gain: String::new(),
                points,
            };
            publish_tradeoff(&tradeoff, folder.path()).unwrap_err().to_string()
        };
        assert!(refused(Vec::new()).contains("no points"));
        assert!(refused(vec![point(0.0, 1.0)]).contains("costs 0"));
        assert!(refused(vec![point(1.0, f64::INFINITY)]).contains("gives inf"));
    }
}
