//! Cost against gain: all points in the colours of what was changed, and the front that nothing beats, by name.

use super::drawing::{
    AXIS, Anchor, BLUE, Colour, Drawing, Extent, GREEN, GRID, INK, Lettering, MARGIN, ORANGE, PAPER, PURPLE,
    QUIET, SHADE, SKY, VERMILLION, WIDTH,
};
use super::place::{self, Leaders, Place};
use crate::tradeoff::{TradePoint, Tradeoff, front};

const LEFT: f64 = MARGIN + 34.0;
const RIGHT: f64 = WIDTH - MARGIN - 8.0;
const PLOT: f64 = 340.0;
/// Free space between the outermost points and the axes.
const INSET: f64 = 18.0;
const BROWN: Colour = (0x8C, 0x56, 0x4B);
const COLOURS: [Colour; 9] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, QUIET, BROWN, INK];

/// The figure.
pub(crate) fn draw(tradeoff: &Tradeoff) -> Drawing {
    let (mut drawing, above) = Drawing::headed(&tradeoff.title, &tradeoff.notes);
    let series = series_of(&tradeoff.points);
    let top = legend(&mut drawing, &series, above) + 34.0;
    let bottom = top + PLOT;
    let scale = Scale::of(&tradeoff.points, top, bottom);
    axes(&mut drawing, tradeoff, &scale);

    let best = front(&tradeoff.points);
    stairs(
        &mut drawing,
        &best.iter().map(|&index| scale.position(&tradeoff.points[index])).collect::<Vec<_>>(),
    );
    for (index, name) in series.iter().enumerate() {
        let of = tradeoff.points.iter().filter(|point| point.series == *name);
        drawing.line(of.map(|point| scale.position(point)), 0.75, colour(index));
    }
    for point in &tradeoff.points {
        let (x, y) = scale.position(point);
        let place = series.iter().position(|name| *name == point.series).unwrap_or(0);
        drawing.dot(x, y, 2.8, colour(place));
    }
    for &index in &best {
        let point = &tradeoff.points[index];
        let (x, y) = scale.position(point);
        let place = series.iter().position(|name| *name == point.series).unwrap_or(0);
        drawing.dot(x, y, 5.4, PAPER);
        drawing.dot(x, y, 4.4, colour(place));
    }
    for point in tradeoff.points.iter().filter(|point| point.is_base) {
        let (x, y) = scale.position(point);
        drawing.dot(x, y, 6.0, INK);
        drawing.dot(x, y, 4.2, PAPER);
        drawing.dot(x, y, 2.4, INK);
    }
    let below = labels(&mut drawing, tradeoff, &best, &scale);
    drawing.height = below + MARGIN;
    drawing
}

fn colour(index: usize) -> Colour {
    COLOURS.get(index).copied().unwrap_or(QUIET)
}

/// Names of the series in the order in which they first occur.
fn series_of(points: &[TradePoint]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for point in points.iter().filter(|point| !point.is_base) {
        if !names.contains(&point.series.as_str()) {
            names.push(&point.series);
        }
    }
    names
}

/// Where values lie: costs on a logarithmic axis, gains on a plain one.
struct Scale {
    cost: (f64, f64),
    gain: (f64, f64),
    top: f64,
    bottom: f64,
}

impl Scale {
    fn of(points: &[TradePoint], top: f64, bottom: f64) -> Self {
        let range = |value: fn(&TradePoint) -> f64, least: f64| {
            let low = points.iter().map(value).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
            let lacking = (least - (high - low)).max(0.0) / 2.0;
            (low - lacking, high + lacking)
        };
        Self { cost: range(|point| point.cost.ln(), 0.2), gain: range(|point| point.gain, 1.0), top, bottom }
    }

    fn x(&self, cost: f64) -> f64 {
        let share = (cost.ln() - self.cost.0) / (self.cost.1 - self.cost.0);
        LEFT + INSET + share * (RIGHT - LEFT - 2.0 * INSET)
    }

    fn y(&self, gain: f64) -> f64 {
        let share = (gain - self.gain.0) / (self.gain.1 - self.gain.0);
        self.bottom - INSET - share * (self.bottom - self.top - 2.0 * INSET)
    }

    fn position(&self, point: &TradePoint) -> (f64, f64) {
        (self.x(point.cost), self.y(point.gain))
    }
}

fn axes(drawing: &mut Drawing, tradeoff: &Tradeoff, scale: &Scale) {
    let (top, bottom) = (scale.top, scale.bottom);
    let inside = |at: f64, from: f64, to: f64| (from..=to).contains(&at);
    let mut free_from = f64::NEG_INFINITY;
    for tick in round_costs(scale.cost) {
        let x = scale.x(tick);
        let label = plain(tick);
        let half = Lettering::NOTE.width(&label) / 2.0;
        if inside(x, LEFT + half, RIGHT - half) && x - half > free_from {
            drawing.line([(x, top), (x, bottom)], 0.5, GRID);
            drawing.text(x, bottom + 16.0, &label, Lettering::NOTE.anchored(Anchor::Middle));
            free_from = x + half + 6.0;
        }
    }
    for tick in round_gains(scale.gain) {
        let y = scale.y(tick);
        if inside(y, top, bottom) {
            drawing.line([(LEFT, y), (RIGHT, y)], 0.5, GRID);
            drawing.text(LEFT - 6.0, y + 3.5, &plain(tick), Lettering::NOTE.anchored(Anchor::End));
        }
    }
    drawing.line([(LEFT, top), (LEFT, bottom), (RIGHT, bottom)], 0.75, AXIS);
    drawing.text(MARGIN, top - 12.0, &tradeoff.gain, Lettering::HEAD);
    drawing.text(RIGHT, bottom + 32.0, &tradeoff.cost, Lettering::HEAD.anchored(Anchor::End));
}

/// 1, 2 and 5 times powers of ten, within a range of logarithms with some room.
fn round_costs((low, high): (f64, f64)) -> Vec<f64> {
    let first = (low / std::f64::consts::LN_10).floor() as i32 - 1;
    let last = (high / std::f64::consts::LN_10).ceil() as i32 + 1;
    let decade = |power: i32| [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|digit| digit * 10_f64.powi(power));
    let ticks: Vec<f64> = (first..=last).flat_map(decade).collect();
    // Few ticks on a wide axis, more on a narrow one.
    let is_wide = high - low > 2.5;
    ticks.into_iter().filter(|tick| !is_wide || ![1.5, 3.0, 7.0].contains(&leading_digit(*tick))).collect()
}

fn leading_digit(value: f64) -> f64 {
    let digit = value / 10_f64.powf(value.log10().floor());
    (digit * 10.0).round() / 10.0
}

/// Multiples of a round step, about six of them.
fn round_gains((low, high): (f64, f64)) -> Vec<f64> {
    let steps = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0];
    let step = steps.into_iter().find(|step| (high - low) / step <= 7.0).unwrap_or((high - low) / 6.0);
    // One tick more on each side: the axes reach beyond the outermost points.
    let (first, last) = ((low / step).floor() as i64 - 1, (high / step).ceil() as i64 + 1);
    (first..=last).map(|index| index as f64 * step).collect()
}

fn plain(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// From each point of the front straight on to the cost at which more is had, then up.
fn stairs(drawing: &mut Drawing, points: &[(f64, f64)]) {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for &(x, y) in points {
        if let Some(&(_, before)) = line.last() {
            line.push((x, before));
        }
        line.push((x, y));
    }
    if let Some(&(_, y)) = line.last() {
        line.push((RIGHT, y));
    }
    drawing.line(line, 2.5, SHADE);
}

fn legend(drawing: &mut Drawing, series: &[&str], above: f64) -> f64 {
    let mut baseline = above + 18.0;
    let mut x = MARGIN;
    for (index, name) in series.iter().enumerate() {
        let width = 14.0 + Lettering::NOTE.width(name) + 14.0;
        if x + width > WIDTH - MARGIN && x > MARGIN {
            x = MARGIN;
            baseline += 16.0;
        }
        drawing.dot(x + 5.0, baseline - 3.5, 4.0, colour(index));
        drawing.text(x + 14.0, baseline, name, Lettering::NOTE);
        x += width;
    }
    baseline
}

/// Names the front and the base, beside their points or below by number; gives the lower edge of the figure.
fn labels(drawing: &mut Drawing, tradeoff: &Tradeoff, best: &[usize], scale: &Scale) -> f64 {
    let below_axis = scale.bottom + 34.0;
    let base = (0..tradeoff.points.len()).filter(|index| tradeoff.points[*index].is_base);
    let named: Vec<usize> = best.iter().copied().chain(base.filter(|index| !best.contains(index))).collect();
    // All points are kept clear of; labels go to the first of them.
    let others = (0..tradeoff.points.len()).filter(|index| !named.contains(index));
    let points: Vec<(f64, f64)> =
        named.iter().copied().chain(others).map(|index| scale.position(&tradeoff.points[index])).collect();
    let names: Vec<String> = named.iter().map(|&index| tradeoff.points[index].label.clone()).collect();
    let bounds =
        Extent { left: LEFT + 2.0, top: scale.top - 6.0, right: WIDTH - 4.0, bottom: scale.bottom - 2.0 };
    let placed = |labels: &[String], leaders| {
        place::beside_points(&points, labels, Lettering::NUMBER, bounds, leaders)
    };
    if let Some(places) = placed(&names, Leaders::Avoid) {
        write(drawing, &points, &places, &names);
        return below_axis;
    }
    let numbers: Vec<String> = (1..=named.len()).map(|number| number.to_string()).collect();
    let places = placed(&numbers, Leaders::Avoid).or_else(|| placed(&numbers, Leaders::Cross));
    let fallback = |&(x, y): &(f64, f64)| Place {
        x: x + 7.0,
        baseline: y - 6.0,
        anchor: Anchor::Start,
        leader_to: None,
    };
    let places = places.unwrap_or_else(|| points.iter().take(named.len()).map(fallback).collect());
    write(drawing, &points, &places, &numbers);
    key(drawing, tradeoff, &named, below_axis + 8.0)
}

fn write(drawing: &mut Drawing, points: &[(f64, f64)], places: &[Place], labels: &[String]) {
    for (&(x, y), place) in points.iter().zip(places) {
        if let Some(end) = place.leader_to {
            drawing.line([(x, y), end], 0.5, AXIS);
        }
    }
    for (place, label) in places.iter().zip(labels) {
        let lettering = Lettering::NUMBER.anchored(place.anchor);
        drawing.knock_out(place.x, place.baseline, label, lettering);
        drawing.text(place.x, place.baseline, label, lettering);
    }
}

/// What the numbers stand for, in two columns; gives its lower edge.
fn key(drawing: &mut Drawing, tradeoff: &Tradeoff, named: &[usize], top: f64) -> f64 {
    const ROW: f64 = 15.0;
    let rows = named.len().div_ceil(2);
    let pitch = (WIDTH - 2.0 * MARGIN) / 2.0;
    for (place, &index) in named.iter().enumerate() {
        let (x, baseline) =
            (MARGIN + (place / rows) as f64 * pitch, top + 12.0 + (place % rows) as f64 * ROW);
        let number = Lettering::NUMBER.bold().anchored(Anchor::End);
        drawing.text(x + 16.0, baseline, &(place + 1).to_string(), number);
        drawing.text(x + 21.0, baseline, &tradeoff.points[index].label, Lettering::NUMBER);
    }
    top + 6.0 + rows as f64 * ROW
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Shape;
    use super::*;

    fn tradeoff(count: usize, crowded: bool) -> Tradeoff {
        let spread = if crowded { 0.02 } else { 1.0 };
        let points = (0..count).map(|index| {
            let at = index as f64 / count.max(2) as f64;
            TradePoint {
                series: ["fewer Gaussians", "lower degree", "cutoffs"][index % 3].to_owned(),
                label: format!("setting {index} of many"),
                cost: 2.0 + spread * 20.0 * at,
                gain: 30.0 + spread * 9.0 * at.sqrt(),
                is_base: index + 1 == count,
            }
        });
        Tradeoff {
            name: "x",
            title: "Speed against error".into(),
            notes: vec!["of a scene".into()],
            cost: "milliseconds a picture".into(),
            gain: "PSNR, dB".into(),
            points: points.collect(),
        }
    }

    #[test]
    fn nothing_leaves_the_canvas_and_labels_do_not_meet() {
        for (count, crowded) in [(1, false), (2, false), (9, false), (24, false), (24, true), (40, true)] {
            let drawing = draw(&tradeoff(count, crowded));
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            let mut texts: Vec<(Extent, &str)> = Vec::new();
            for shape in &drawing.shapes {
                match shape {
                    Shape::Text { x, baseline, text, lettering } => {
                        let extent = Extent::of_text(*x, *baseline, text, *lettering);
                        assert!(canvas.holds(extent), "{count} {crowded}: {text} at {extent:?}");
                        let met = texts.iter().find(|(other, _)| extent.overlaps(*other));
                        assert!(met.is_none() || crowded, "{count} {crowded}: {text} meets {met:?}");
                        texts.push((extent, text));
                    }
                    Shape::Line { points, .. } => {
                        assert!(points.iter().all(|&(x, y)| (0.0..=WIDTH).contains(&x) && y >= 0.0));
                    }
                    _ => {}
                }
            }
            let named = (0..count).all(|index| {
                let label = format!("setting {index} of many");
                texts.iter().any(|(_, text)| *text == label)
            });
            assert!(named, "{count} {crowded}: the front is not named");
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(round_gains((30.2, 35.1)), [29.0, 30.0, 31.0, 32.0, 33.0, 34.0, 35.0, 36.0, 37.0]);
        let wide: Vec<f64> = round_costs((1_f64.ln(), 100_f64.ln()))
            .into_iter()
            .filter(|t| (1.0..=100.0).contains(t))
            .collect();
        assert_eq!(wide, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!([plain(0.5), plain(20.0), plain(1.0)], ["0.5", "20", "1"]);
    }

    #[test]
    fn gains_grow_upwards_and_costs_to_the_right() {
        let tradeoff = tradeoff(9, false);
        let scale = Scale::of(&tradeoff.points, 0.0, 300.0);
        let (cheap, dear) = (scale.position(&tradeoff.points[0]), scale.position(&tradeoff.points[8]));
        assert!(cheap.0 < dear.0 && cheap.1 > dear.1);
    }
}
