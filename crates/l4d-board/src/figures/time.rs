//! Mean IoU over the clip: when methods find the target and when they see what is not there.

use std::collections::{BTreeMap, BTreeSet};

use super::drawing::{
    AXIS, Anchor, BLUE, Colour, Drawing, GREEN, GRID, Lettering, MARGIN, Marker, ORANGE, PAPER, PURPLE,
    QUIET, SHADE, SKY, VERMILLION, WIDTH, leading,
};
use super::{lettering, named, place, shown};
use crate::rank::Board;
use crate::row::BoardRow;

const LEFT: f64 = MARGIN + 30.0;
const LEAST_PLOT: f64 = 230.0;
const LONGEST_LABEL: f64 = 180.0;
const LEADER: f64 = 22.0;
const COLOURS: [Colour; 6] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY];

/// One line a method, labelled at its end.
pub(crate) fn draw(board: &Board) -> Drawing {
    let (rows, left_out) = shown(board);
    let mut notes = vec![
        "Mean over the queries with a true or a predicted pixel in the frame; a false alarm counts 0."
            .to_owned(),
    ];
    if board.ranked.len() > COLOURS.len() {
        notes.push(format!("Colour and shape: the first {} of the tables; grey: the others.", COLOURS.len()));
    } else if !board.unranked.is_empty() && !board.ranked.is_empty() {
        notes.push("Colour and shape: ranked; grey: not ranked, shown for scale.".to_owned());
    }
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    let (mut drawing, above) = Drawing::titled("Mean IoU over the clip", board, &notes);
    let top = above + 34.0;

    let curves: Vec<Curve> = rows
        .iter()
        .enumerate()
        .filter_map(|(index, (rank, row))| curve(index, rank.is_some() || board.ranked.is_empty(), row))
        .collect();
    let label_width = curves
        .iter()
        .flat_map(|curve| &curve.label)
        .map(|line| Lettering::NUMBER.width(line))
        .fold(0.0, f64::max);
    let right = WIDTH - MARGIN - label_width - LEADER - 6.0;
    let label_heights: f64 = curves.iter().map(Curve::label_height).sum();
    let plot = LEAST_PLOT.max(label_heights - 8.0);
    let bottom = top + plot;

    let frames: BTreeSet<u32> = curves.iter().flat_map(|curve| curve.row.frames.keys().copied()).collect();
    let (first, last) = (frames.first().copied().unwrap_or(0), frames.last().copied().unwrap_or(0));
    let x_of = |frame: u32| {
        if last == first {
            LEFT
        } else {
            LEFT + f64::from(frame - first) / f64::from(last - first) * (right - LEFT)
        }
    };
    let y_of = |value: f64| bottom - value / 100.0 * plot;

    axes(&mut drawing, right, top, bottom);
    for frame in ticks(first, last) {
        let x = x_of(frame);
        drawing.line([(x, bottom), (x, bottom + 4.0)], 0.75, AXIS);
        drawing.text(x, bottom + 16.0, &frame.to_string(), Lettering::NOTE.anchored(Anchor::Middle));
    }
    if curves.is_empty() {
        let middle = ((LEFT + right) / 2.0, top + 0.375 * plot);
        drawing.text(middle.0, middle.1, "no frame with a target", Lettering::NOTE.anchored(Anchor::Middle));
    }
    // The best method is drawn last, on top.
    for curve in curves.iter().rev() {
        for run in curve.runs(first, last) {
            let points: Vec<(f64, f64)> =
                run.iter().map(|&(frame, value)| (x_of(frame), y_of(value))).collect();
            match points.as_slice() {
                [(x, y)] => drawing.dot(*x, *y, 2.0, curve.colour),
                _ => drawing.line(points, curve.stroke, curve.colour),
            }
        }
    }
    for curve in curves.iter().rev() {
        let Some(shape) = curve.shape else { continue };
        for (frame, value) in marked(&curve.row.frames, shape) {
            point(&mut drawing, shape, (x_of(frame), y_of(value)), curve.colour);
        }
    }
    end_labels(&mut drawing, &curves, right, top - 8.0, bottom + 8.0, y_of);
    drawing.height = bottom + 34.0 + MARGIN;
    drawing
}

struct Curve<'a> {
    row: &'a BoardRow,
    label: Vec<String>,
    colour: Colour,
    /// Place among the curves in colour: which shape its points have.
    shape: Option<usize>,
    ink: Colour,
    stroke: f64,
    /// Value at the last frame that has one.
    end: f64,
}

fn curve<'a>(index: usize, is_in_colour: bool, row: &'a BoardRow) -> Option<Curve<'a>> {
    let (_, &end) = row.frames.last_key_value()?;
    let label = lettering::wrap_name(&named(row), |line| Lettering::NUMBER.width(line) <= LONGEST_LABEL);
    let (colour, ink, stroke) = match (is_in_colour, COLOURS.get(index)) {
        (true, Some(&colour)) => (colour, super::drawing::INK, 1.75),
        (true, None) => (QUIET, QUIET, 1.0),
        (false, _) => (SHADE, QUIET, 1.25),
    };
    let shape = (is_in_colour && index < COLOURS.len()).then_some(index);
    Some(Curve { row, label, colour, shape, ink, stroke, end })
}

/// Points by which a curve is told from others without its colour: about eight, at other frames than those of the
/// curves before it where there are enough.
fn marked(frames: &BTreeMap<u32, f64>, shape: usize) -> impl Iterator<Item = (u32, f64)> {
    let step = frames.len().div_ceil(8).max(1);
    frames.iter().map(|(&frame, &value)| (frame, value)).skip(shape % step).step_by(step)
}

fn point(drawing: &mut Drawing, shape: usize, at: (f64, f64), colour: Colour) {
    let marker = Marker::ALL[shape % Marker::ALL.len()];
    drawing.marker(marker, at, 3.6, colour);
    // Beyond the shapes there are, hollow ones.
    if shape >= Marker::ALL.len() {
        drawing.marker(marker, at, 2.0, PAPER);
    }
}

impl Curve<'_> {
    fn label_height(&self) -> f64 {
        self.label.len() as f64 * leading(Lettering::NUMBER) + 2.0
    }

    /// Stretches of frames without a hole. A hole is a step that is more than twice the usual one.
    fn runs(&self, first: u32, last: u32) -> Vec<Vec<(u32, f64)>> {
        let frames: Vec<(u32, f64)> = self.row.frames.iter().map(|(&frame, &value)| (frame, value)).collect();
        let usual = frames.windows(2).map(|pair| pair[1].0 - pair[0].0).min().unwrap_or(last - first);
        let mut runs: Vec<Vec<(u32, f64)>> = Vec::new();
        for point in frames {
            match runs.last_mut() {
                Some(run) if run.last().is_some_and(|before| point.0 - before.0 <= 2 * usual) => {
                    run.push(point);
                }
                _ => runs.push(vec![point]),
            }
        }
        runs
    }
}

fn axes(drawing: &mut Drawing, right: f64, top: f64, bottom: f64) {
    for tick in [0, 25, 50, 75, 100] {
        let y = bottom - f64::from(tick) / 100.0 * (bottom - top);
        drawing.line([(LEFT, y), (right, y)], 0.5, GRID);
        drawing.text(LEFT - 6.0, y + 3.5, &tick.to_string(), Lettering::NOTE.anchored(Anchor::End));
    }
    drawing.line([(LEFT, top), (LEFT, bottom), (right, bottom)], 0.75, AXIS);
    drawing.text(MARGIN, top - 14.0, "mean IoU, %", Lettering::HEAD);
    drawing.text(right, bottom + 31.0, "canonical frame", Lettering::HEAD.anchored(Anchor::End));
}

fn end_labels(
    drawing: &mut Drawing,
    curves: &[Curve],
    right: f64,
    top: f64,
    bottom: f64,
    y_of: impl Fn(f64) -> f64,
) {
    let mut order: Vec<&Curve> = curves.iter().collect();
    order.sort_by(|a, b| b.end.total_cmp(&a.end));
    let wanted: Vec<f64> = order.iter().map(|curve| y_of(curve.end)).collect();
    let heights: Vec<f64> = order.iter().map(|curve| curve.label_height()).collect();
    for ((curve, middle), from) in
        order.iter().zip(place::spread(&wanted, &heights, top, bottom)).zip(&wanted)
    {
        let bend = [(right + 3.0, *from), (right + LEADER - 7.0, middle), (right + LEADER - 1.0, middle)];
        drawing.line(bend, 0.75, curve.colour);
        if let Some(shape) = curve.shape {
            point(drawing, shape, (right + LEADER - 3.0, middle), curve.colour);
        }
        let first = middle + 3.5 - (curve.label.len() as f64 - 1.0) * leading(Lettering::NUMBER) / 2.0;
        drawing.lines(right + LEADER + 4.0, first, &curve.label, Lettering::NUMBER.coloured(curve.ink));
    }
}

/// Round frame numbers, at most seven; seconds (24 frames) on the canonical timeline.
fn ticks(first: u32, last: u32) -> Vec<u32> {
    let steps = [1, 2, 5, 10, 24, 48, 96, 240, 480, 960, 2400];
    let step = steps.into_iter().find(|step| (last - first) / step <= 6).unwrap_or((last - first) / 6);
    (first.div_ceil(step)..=last / step).map(|index| index * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(ticks(0, 96), [0, 24, 48, 72, 96]);
        assert_eq!(ticks(0, 0), [0]);
        assert_eq!(ticks(3, 9), [3, 4, 5, 6, 7, 8, 9]);
        for last in [1, 50, 97, 300, 5000, 1_000_000, u32::MAX] {
            assert!((1..=8).contains(&ticks(0, last).len()), "{last}: {:?}", ticks(0, last));
        }
    }
}
