//! A setting against a score: one line a series with its intervals, named at its end.

use super::drawing::{
    AXIS, Anchor, BLUE, Colour, Drawing, GREEN, GRID, INK, Lettering, MARGIN, Marker, PAPER, PURPLE, QUIET,
    VERMILLION, WIDTH, leading,
};
use super::{lettering, place};
use crate::trend::{Trend, TrendPoint, TrendSeries};

const LEFT: f64 = MARGIN + 34.0;
const PLOT: f64 = 260.0;
const LONGEST_LABEL: f64 = 170.0;
const LEADER: f64 = 22.0;
/// Points of different series at one setting stand this far apart, so that their intervals can be told apart.
const DODGE: f64 = 5.0;
const COLOURS: [Colour; 5] = [BLUE, VERMILLION, GREEN, PURPLE, INK];

/// The figure.
pub(crate) fn draw(trend: &Trend) -> Drawing {
    let (mut drawing, above) = Drawing::headed(&trend.title, &trend.notes);
    let top = above + 36.0;
    let bottom = top + PLOT;
    let labels: Vec<Vec<String>> = trend
        .series
        .iter()
        .map(|series| {
            lettering::wrap(&series.name, |line| Lettering::NUMBER.width(line) <= LONGEST_LABEL, " ")
        })
        .collect();
    let label_width = labels.iter().flatten().map(|line| Lettering::NUMBER.width(line)).fold(0.0, f64::max);
    let right = WIDTH - MARGIN - label_width - LEADER - 8.0;
    let settings = settings(trend);
    let x_of = |at: f64| {
        let (low, high) = (settings[0], settings[settings.len() - 1]);
        let share = if high > low { (at - low) / (high - low) } else { 0.5 };
        LEFT + 18.0 + share * (right - LEFT - 36.0)
    };
    let (floor, ceiling) = range(trend);
    let y_of = |value: f64| bottom - (value - floor) / (ceiling - floor) * PLOT;

    axes(&mut drawing, trend, (right, top, bottom), (floor, ceiling), &y_of);
    for &setting in &settings {
        let x = x_of(setting);
        drawing.line([(x, bottom), (x, bottom + 4.0)], 0.75, AXIS);
        drawing.text(x, bottom + 16.0, &plain(setting), Lettering::NOTE.anchored(Anchor::Middle));
    }
    let measured = trend.series.iter().filter(|series| !series.is_reported).count();
    let mut ends = Vec::new();
    let (mut ours, mut theirs) = (0, 0);
    for series in &trend.series {
        let place = if series.is_reported { &mut theirs } else { &mut ours };
        let (colour, marker) = (COLOURS[*place % COLOURS.len()], Marker::ALL[*place % Marker::ALL.len()]);
        let shift =
            if series.is_reported { 0.0 } else { (*place as f64 - (measured as f64 - 1.0) / 2.0) * DODGE };
        *place += 1;
        let points = ascending(series);
        let at = |point: &TrendPoint| (x_of(point.at) + shift, y_of(point.value));
        curve(&mut drawing, series, &points.iter().map(at).collect::<Vec<_>>(), colour);
        for point in &points {
            if let Some([low, high]) = point.interval {
                let x = x_of(point.at) + shift;
                drawing.whisker((x, y_of(low)), (x, y_of(high)), colour);
            }
        }
        for point in &points {
            drawing.marker(marker, at(point), 4.2, colour);
            if series.is_reported {
                drawing.marker(marker, at(point), 2.6, PAPER);
            }
        }
        let end = points.last().map_or(((LEFT + right) / 2.0, bottom), at);
        ends.push((end, colour));
    }
    name_ends(&mut drawing, &ends, &labels, right, (top - 8.0, bottom + 8.0));
    drawing.height = bottom + 34.0 + MARGIN;
    drawing
}

fn ascending(series: &TrendSeries) -> Vec<TrendPoint> {
    let mut points = series.points.clone();
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    points
}

fn settings(trend: &Trend) -> Vec<f64> {
    let mut settings: Vec<f64> =
        trend.series.iter().flat_map(|series| series.points.iter().map(|point| point.at)).collect();
    settings.sort_by(f64::total_cmp);
    settings.dedup();
    settings
}

/// Zero to a hundred, or the tens around all values where they leave most of it empty.
fn range(trend: &Trend) -> (f64, f64) {
    let values = trend.series.iter().flat_map(|series| &series.points);
    let values =
        values.flat_map(|point| [point.value].into_iter().chain(point.interval.into_iter().flatten()));
    let (low, high) =
        values.fold((100.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let (low, high) = ((low / 10.0).floor() * 10.0, ((high / 10.0).ceil() * 10.0).min(100.0));
    if high - low >= 50.0 { (0.0, 100.0) } else { (low, f64::max(high, low + 10.0)) }
}

fn axes(
    drawing: &mut Drawing,
    trend: &Trend,
    (right, top, bottom): (f64, f64, f64),
    (floor, ceiling): (f64, f64),
    y_of: &impl Fn(f64) -> f64,
) {
    let step = if ceiling - floor > 60.0 { 25.0 } else { 10.0 };
    let mut tick = floor;
    while tick <= ceiling {
        let y = y_of(tick);
        drawing.line([(LEFT, y), (right, y)], 0.5, GRID);
        drawing.text(LEFT - 6.0, y + 3.5, &plain(tick), Lettering::NOTE.anchored(Anchor::End));
        tick += step;
    }
    drawing.line([(LEFT, top), (LEFT, bottom), (right, bottom)], 0.75, AXIS);
    drawing.text(MARGIN, top - 14.0, &trend.score, Lettering::HEAD);
    drawing.text(right, bottom + 31.0, &trend.setting, Lettering::HEAD.anchored(Anchor::End));
}

fn curve(drawing: &mut Drawing, series: &TrendSeries, points: &[(f64, f64)], colour: Colour) {
    if series.is_reported {
        for pair in points.windows(2).filter(|pair| pair[0] != pair[1]) {
            drawing.dashes(pair[0], pair[1], 1.0, colour);
        }
    } else if points.len() > 1 {
        drawing.line(points.iter().copied(), 1.75, colour);
    }
}

fn name_ends(
    drawing: &mut Drawing,
    ends: &[((f64, f64), Colour)],
    labels: &[Vec<String>],
    right: f64,
    (top, bottom): (f64, f64),
) {
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by(|&a, &b| ends[a].0.1.total_cmp(&ends[b].0.1));
    let wanted: Vec<f64> = order.iter().map(|&index| ends[index].0.1).collect();
    let height = |index: &usize| labels[*index].len() as f64 * leading(Lettering::NUMBER) + 2.0;
    let heights: Vec<f64> = order.iter().map(height).collect();
    for (&index, middle) in order.iter().zip(place::spread(&wanted, &heights, top, bottom)) {
        let ((x, y), colour) = ends[index];
        let bend = [(x + 6.0, y), (right + LEADER - 7.0, middle), (right + LEADER - 1.0, middle)];
        drawing.line(bend, 0.5, QUIET);
        let first = middle + 3.5 - (labels[index].len() as f64 - 1.0) * leading(Lettering::NUMBER) / 2.0;
        drawing.lines(right + LEADER + 2.0, first, &labels[index], Lettering::NUMBER.coloured(colour));
    }
}

fn plain(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Extent, Shape};
    use super::*;

    fn trend(series: usize, points: usize) -> Trend {
        let one = |index: usize| TrendSeries {
            name: format!("{} of kind {index}", if index % 2 == 1 { "paper" } else { "measured" }),
            is_reported: index % 2 == 1,
            points: (0..points)
                .map(|at| {
                    let value = 40.0 + 4.0 * (at as f64).sqrt() + index as f64;
                    let interval = index.is_multiple_of(2).then_some([value - 6.0, value + 6.0]);
                    TrendPoint { at: 1.0 + 2.0 * at as f64, value, interval }
                })
                .collect(),
        };
        Trend {
            name: "x",
            title: "Views".into(),
            notes: vec!["of scenes".into()],
            setting: "views".into(),
            score: "mIoU, %".into(),
            series: (0..series).map(one).collect(),
        }
    }

    #[test]
    fn nothing_leaves_the_canvas_and_names_do_not_meet() {
        for (series, points) in [(1, 1), (1, 6), (2, 3), (8, 6), (10, 2)] {
            let drawing = draw(&trend(series, points));
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            let mut texts: Vec<(Extent, &str)> = Vec::new();
            for shape in &drawing.shapes {
                match shape {
                    Shape::Text { x, baseline, text, lettering } => {
                        let extent = Extent::of_text(*x, *baseline, text, *lettering);
                        assert!(canvas.holds(extent), "{series} {points}: {text} at {extent:?}");
                        let met = texts.iter().find(|(other, _)| extent.overlaps(*other));
                        assert!(met.is_none(), "{series} {points}: {text} meets {met:?}");
                        texts.push((extent, text));
                    }
                    Shape::Line { points, .. } | Shape::Polygon { points, .. } => {
                        let inside = |&(x, y): &(f64, f64)| {
                            (0.0..=WIDTH).contains(&x) && (0.0..=drawing.height).contains(&y)
                        };
                        assert!(points.iter().all(inside), "{series}: {points:?}");
                    }
                    _ => {}
                }
            }
        }
    }

    #[test]
    fn the_axis_starts_at_zero_unless_that_would_waste_it() {
        assert_eq!(range(&trend(2, 4)), (30.0, 60.0));
        let mut wide = trend(1, 2);
        wide.series[0].points[0].value = 5.0;
        wide.series[0].points[0].interval = None;
        assert_eq!(range(&wide), (0.0, 100.0));
    }
}
