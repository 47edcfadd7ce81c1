//! A setting against a score: one panel a kind of queries on common axes, what was measured with its intervals beside
//! what others report.

use l4d_score::cluster::FEW_SCENES;

use super::drawing::{
    AXIS, Anchor, BLUE, Drawing, GRID, Lettering, MARGIN, Marker, PAPER, QUIET, WIDTH, leading,
};
use super::lettering;
use crate::trend::{Trend, TrendPanel, TrendPoint};

const LEFT: f64 = MARGIN + 30.0;
const PLOT: f64 = 150.0;
const GAP: f64 = 24.0;
const ABREAST: usize = 3;
/// Free space between the outermost settings and the edges.
const INSET: f64 = 14.0;
/// What is measured and what is reported stand this far apart, so that a whisker hides no point.
const DODGE: f64 = 3.0;

/// Axes that all panels share.
struct Axes {
    settings: Vec<f64>,
    floor: f64,
    ceiling: f64,
    width: f64,
}

impl Axes {
    fn x(&self, at: f64) -> f64 {
        let (low, high) = (self.settings[0], self.settings[self.settings.len() - 1]);
        let share = if high > low { (at - low) / (high - low) } else { 0.5 };
        INSET + share * (self.width - 2.0 * INSET)
    }

    /// Below the top of a panel.
    fn y(&self, value: f64) -> f64 {
        (self.ceiling - value) / (self.ceiling - self.floor) * PLOT
    }
}

/// The figure. There is at least one point.
pub(crate) fn draw(trend: &Trend) -> Drawing {
    let (mut drawing, above) = Drawing::headed(&trend.title, &trend.notes);
    let abreast = trend.panels.len().clamp(1, ABREAST);
    let pitch = (WIDTH - MARGIN - LEFT + GAP) / abreast as f64;
    let (floor, ceiling) = range(trend);
    let axes = Axes { settings: settings(trend), floor, ceiling, width: pitch - GAP };
    let mut above = legend(&mut drawing, trend, above);
    for line in trend.panels.chunks(abreast) {
        let titles: Vec<Vec<String>> = line.iter().map(|panel| title(&panel.title, axes.width)).collect();
        let most = titles.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let top = above + 14.0 + most * leading(Lettering::HEAD);
        for (index, (shown, title)) in line.iter().zip(&titles).enumerate() {
            let left = LEFT + index as f64 * pitch;
            let first = top - 10.0 - (title.len() as f64 - 1.0) * leading(Lettering::HEAD);
            drawing.lines(left, first, title, Lettering::HEAD);
            panel(&mut drawing, &axes, shown, (left, top), index == 0);
        }
        above = top + PLOT + 22.0;
    }
    let below = format!("across: {}; upwards: {}", trend.setting, trend.score);
    let lines = lettering::wrap(&below, |line| Lettering::NOTE.width(line) <= WIDTH - MARGIN - LEFT, " ");
    drawing.lines(LEFT, above + 14.0, &lines, Lettering::NOTE);
    drawing.height = above + lines.len() as f64 * leading(Lettering::NOTE) + 6.0 + MARGIN;
    drawing
}

fn title(text: &str, room: f64) -> Vec<String> {
    lettering::wrap(text, |line| Lettering::HEAD.width(line) <= room, " +_-.")
}

fn panel(drawing: &mut Drawing, axes: &Axes, panel: &TrendPanel, (left, top): (f64, f64), is_first: bool) {
    let (right, bottom) = (left + axes.width, top + PLOT);
    let step = if axes.ceiling - axes.floor > 60.0 { 25.0 } else { 10.0 };
    let mut tick = axes.floor;
    while tick <= axes.ceiling {
        let y = top + axes.y(tick);
        drawing.line([(left, y), (right, y)], 0.5, GRID);
        if is_first {
            drawing.text(left - 6.0, y + 3.5, &plain(tick), Lettering::NOTE.anchored(Anchor::End));
        }
        tick += step;
    }
    let mut free_from = f64::NEG_INFINITY;
    for &setting in &axes.settings {
        let (x, text) = (left + axes.x(setting), plain(setting));
        drawing.line([(x, bottom), (x, bottom + 4.0)], 0.75, AXIS);
        let half = Lettering::NOTE.width(&text) / 2.0;
        if x - half > free_from {
            drawing.text(x, bottom + 16.0, &text, Lettering::NOTE.anchored(Anchor::Middle));
            free_from = x + half + 4.0;
        }
    }
    drawing.line([(left, top), (left, bottom), (right, bottom)], 0.75, AXIS);
    if panel.measured.is_empty() && panel.reported.is_empty() {
        let middle = (f64::midpoint(left, right), f64::midpoint(top, bottom));
        drawing.text(middle.0, middle.1, "no query", Lettering::NOTE.anchored(Anchor::Middle));
    }
    let is_dodged = !panel.measured.is_empty() && !panel.reported.is_empty();
    let aside = if is_dodged { DODGE } else { 0.0 };
    let at = |at: f64, value: f64, aside: f64| (left + axes.x(at) + aside, top + axes.y(value));

    let reported = ascending(&panel.reported);
    let points: Vec<(f64, f64)> = reported.iter().map(|point| at(point.at, point.value, aside)).collect();
    for pair in points.windows(2).filter(|pair| pair[0] != pair[1]) {
        drawing.dashes(pair[0], pair[1], 1.0, QUIET);
    }
    for point in points {
        reported_mark(drawing, point);
    }
    let measured = ascending(&panel.measured);
    let points: Vec<(f64, f64)> = measured.iter().map(|point| at(point.at, point.value, -aside)).collect();
    if points.len() > 1 {
        drawing.line(points.iter().copied(), 1.75, BLUE);
    }
    for point in &measured {
        if let Some(ends) = point.interval {
            let [low, high] = ends.map(|end| at(point.at, end, -aside));
            drawing.whisker(low, high, point.is_of_few_scenes, BLUE);
        }
    }
    for point in points {
        drawing.marker(Marker::Circle, point, 3.8, BLUE);
    }
}

fn reported_mark(drawing: &mut Drawing, at: (f64, f64)) {
    drawing.marker(Marker::Square, at, 4.0, QUIET);
    drawing.marker(Marker::Square, at, 2.4, PAPER);
}

/// Draws what an entry of the legend is about, from a point to the right.
type Sample = fn(&mut Drawing, f64, f64);

/// What marks and lines mean; gives the first free height below.
fn legend(drawing: &mut Drawing, trend: &Trend, above: f64) -> f64 {
    const LINE: f64 = 26.0;
    let mut baseline = above + 18.0;
    let mut x = MARGIN;
    let measured = || trend.panels.iter().flat_map(|panel| &panel.measured);
    let with_interval =
        |few: bool| measured().any(|point| point.interval.is_some() && point.is_of_few_scenes == few);
    let few = format!("95 % interval from fewer than {FEW_SCENES} scenes: may be too narrow");
    let entries: [(bool, &str, Sample); 4] = [
        (measured().next().is_some(), "measured", |drawing, x, y| {
            drawing.line([(x, y), (x + LINE, y)], 1.75, BLUE);
            drawing.marker(Marker::Circle, (x + LINE / 2.0, y), 3.8, BLUE);
        }),
        (
            trend.panels.iter().any(|panel| !panel.reported.is_empty()),
            "reported, of other data",
            |drawing, x, y| {
                drawing.dashes((x, y), (x + LINE, y), 1.0, QUIET);
                reported_mark(drawing, (x + LINE / 2.0, y));
            },
        ),
        (with_interval(false), "95 % interval, clustered by scene", |drawing, x, y| {
            drawing.whisker((x, y), (x + LINE, y), false, BLUE);
        }),
        (with_interval(true), &few, |drawing, x, y| {
            drawing.whisker((x, y), (x + LINE, y), true, BLUE);
        }),
    ];
    for (is_there, text, sample) in entries {
        let width = LINE + 6.0 + Lettering::NOTE.width(text);
        if !is_there {
            continue;
        }
        if x + width > WIDTH - MARGIN {
            (x, baseline) = (MARGIN, baseline + 16.0);
        }
        sample(drawing, x, baseline - 3.5);
        drawing.text(x + LINE + 6.0, baseline, text, Lettering::NOTE);
        x += width + 16.0;
    }
    baseline + 8.0
}

fn ascending(points: &[TrendPoint]) -> Vec<TrendPoint> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.at.total_cmp(&b.at));
    points
}

fn all_points(trend: &Trend) -> impl Iterator<Item = &TrendPoint> {
    trend.panels.iter().flat_map(|panel| panel.measured.iter().chain(&panel.reported))
}

fn settings(trend: &Trend) -> Vec<f64> {
    let mut settings: Vec<f64> = all_points(trend).map(|point| point.at).collect();
    settings.sort_by(f64::total_cmp);
    settings.dedup();
    settings
}

/// Zero to a hundred, or the tens around all values where they leave most of it empty.
fn range(trend: &Trend) -> (f64, f64) {
    let values = all_points(trend)
        .flat_map(|point| [point.value].into_iter().chain(point.interval.into_iter().flatten()));
    let (low, high) =
        values.fold((100.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let (low, high) = ((low / 10.0).floor() * 10.0, ((high / 10.0).ceil() * 10.0).min(100.0));
    if high - low >= 50.0 { (0.0, 100.0) } else { (low, f64::max(high, low + 10.0)) }
}

fn plain(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Extent, Shape};
    use super::*;

    fn trend(panels: usize, points: usize) -> Trend {
        let point = |at: usize, value: f64, interval| TrendPoint {
            at: 1.0 + 2.0 * at as f64,
            value,
            interval,
            is_of_few_scenes: at == 1,
        };
        let one = |index: usize| TrendPanel {
            title: format!("queries of a kind with a long name, number {index}"),
            measured: (0..points)
                .map(|at| {
                    let value = 40.0 + 4.0 * (at as f64).sqrt() + index as f64;
                    point(at, value, Some([value - 6.0, value + 6.0]))
                })
                .collect(),
            reported: (0..if index.is_multiple_of(2) { points + 1 } else { 0 })
                .map(|at| point(at, 45.0 + at as f64 / 4.0, None))
                .collect(),
        };
        Trend {
            name: "x",
            title: "Views".into(),
            notes: vec!["of scenes".into()],
            setting: "views".into(),
            score: "mIoU, %".into(),
            panels: (0..panels).map(one).collect(),
        }
    }

    #[test]
    fn nothing_leaves_the_canvas_and_texts_do_not_meet() {
        for (panels, points) in [(1, 1), (1, 6), (2, 3), (5, 6), (8, 2), (3, 40)] {
            let drawing = draw(&trend(panels, points));
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            let mut texts: Vec<(Extent, &str)> = Vec::new();
            for shape in &drawing.shapes {
                match shape {
                    Shape::Text { x, baseline, text, lettering } => {
                        let extent = Extent::of_text(*x, *baseline, text, *lettering);
                        assert!(canvas.holds(extent), "{panels} {points}: {text} at {extent:?}");
                        let met = texts.iter().find(|(other, _)| extent.overlaps(*other));
                        assert!(met.is_none(), "{panels} {points}: {text} meets {met:?}");
                        texts.push((extent, text));
                    }
                    Shape::Line { points, .. } | Shape::Polygon { points, .. } => {
                        let inside = |&(x, y): &(f64, f64)| {
                            (0.0..=WIDTH).contains(&x) && (0.0..=drawing.height).contains(&y)
                        };
                        assert!(points.iter().all(inside), "{panels}: {points:?}");
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
        wide.panels[0].measured[0].value = 5.0;
        wide.panels[0].measured[0].interval = None;
        assert_eq!(range(&wide), (0.0, 100.0));
    }

    #[test]
    fn whiskers_reach_from_the_low_to_the_high_end() {
        let mut one = trend(1, 1);
        (one.panels[0].reported, one.panels[0].measured[0].value) = (Vec::new(), 45.0);
        one.panels[0].measured[0].interval = Some([40.0, 50.0]);
        let drawing = draw(&one);
        let circle = drawing.shapes.iter().rev().find_map(|shape| match shape {
            Shape::Dot { x, y, .. } => Some((*x, *y)),
            _ => None,
        });
        let (x, y) = circle.unwrap();
        let stem = [(x, y + PLOT / 2.0), (x, y - PLOT / 2.0)];
        let is_stem = |shape: &Shape| matches!(shape, Shape::Line { points, .. } if points[..] == stem);
        assert!(drawing.shapes.iter().any(is_stem), "no stem {stem:?}");
    }
}
