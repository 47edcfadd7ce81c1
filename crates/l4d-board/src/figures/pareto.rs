//! Cost against gain: all points in the colours and shapes of what was changed, and the front that nothing beats, by name.

use super::drawing::{
    BLUE, Colour, Drawing, Extent, GREEN, INK, Lettering, MARGIN, Marker, ORANGE, PAPER, PURPLE, QUIET,
    SHADE, SKY, VERMILLION, WIDTH,
};
use super::labels::name_points;
use super::scale::{LEFT, RIGHT, Scale};
use crate::tradeoff::{TradePoint, Tradeoff, front};

const PLOT: f64 = 340.0;
const BROWN: Colour = (0x8C, 0x56, 0x4B);
const COLOURS: [Colour; 9] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, QUIET, BROWN, INK];

/// The figure.
pub(crate) fn draw(tradeoff: &Tradeoff) -> Drawing {
    let (mut drawing, above) = Drawing::headed(&tradeoff.title, &tradeoff.notes);
    let series = series_of(&tradeoff.points);
    let top = legend(&mut drawing, &series, above) + 34.0;
    let bottom = top + PLOT;
    let measured: Vec<(f64, f64)> = tradeoff.points.iter().map(|point| (point.cost, point.gain)).collect();
    let scale = Scale::fitted(&measured, (top, bottom));
    scale.axes(&mut drawing, &tradeoff.cost, &tradeoff.gain);

    let best = front(&tradeoff.points);
    stairs(
        &mut drawing,
        &best.iter().map(|&index| position(&scale, &tradeoff.points[index])).collect::<Vec<_>>(),
        SHADE,
    );
    for (index, name) in series.iter().enumerate() {
        let of = tradeoff.points.iter().filter(|point| point.series == *name);
        drawing.line(of.map(|point| position(&scale, point)), 0.75, colour(index));
    }
    for point in &tradeoff.points {
        let (x, y) = position(&scale, point);
        let place = series.iter().position(|name| *name == point.series).unwrap_or(0);
        drawing.marker(marker(place), (x, y), 2.8, colour(place));
    }
    for &index in &best {
        let point = &tradeoff.points[index];
        let (x, y) = position(&scale, point);
        let place = series.iter().position(|name| *name == point.series).unwrap_or(0);
        drawing.marker(marker(place), (x, y), 5.4, PAPER);
        drawing.marker(marker(place), (x, y), 4.4, colour(place));
    }
    for point in tradeoff.points.iter().filter(|point| point.is_base) {
        let (x, y) = position(&scale, point);
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

fn marker(index: usize) -> Marker {
    Marker::ALL[index % Marker::ALL.len()]
}

fn position(scale: &Scale, point: &TradePoint) -> (f64, f64) {
    scale.position(point.cost, point.gain)
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

/// From each point of the front straight on to the cost at which more is had, then up; gives that
/// line.
pub(super) fn stairs(drawing: &mut Drawing, points: &[(f64, f64)], colour: Colour) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for &(x, y) in points {
        if let Some(&(_, before)) = line.last() {
            line.push((x, before));
        }
        line.push((x, y));
    }
    if let Some(&(_, y)) = line.last() {
        line.push((RIGHT, y));
        drawing.line(line.iter().copied(), 2.5, colour);
    }
    line
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
        drawing.marker(marker(index), (x + 5.0, baseline - 3.5), 4.0, colour(index));
        drawing.text(x + 14.0, baseline, name, Lettering::NOTE);
        x += width;
    }
    baseline
}

/// Names the front and the base; gives the lower edge of the figure.
fn labels(drawing: &mut Drawing, tradeoff: &Tradeoff, best: &[usize], scale: &Scale) -> f64 {
    let base = (0..tradeoff.points.len()).filter(|index| tradeoff.points[*index].is_base);
    let named: Vec<usize> = best.iter().copied().chain(base.filter(|index| !best.contains(index))).collect();
    // All points are kept clear of; labels go to the first of them.
    let others = (0..tradeoff.points.len()).filter(|index| !named.contains(index));
    let points: Vec<(f64, f64)> =
        named.iter().copied().chain(others).map(|index| position(scale, &tradeoff.points[index])).collect();
    let names: Vec<(String, Colour)> =
        named.iter().map(|&index| (tradeoff.points[index].label.clone(), INK)).collect();
    let bounds =
        Extent { left: LEFT + 2.0, top: scale.top - 6.0, right: WIDTH - 4.0, bottom: scale.bottom - 2.0 };
    name_points(drawing, &points, &names, bounds, (scale.bottom + 34.0, 2))
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
}
