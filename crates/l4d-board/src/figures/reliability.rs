//! Certainty against being right: one panel a method. On the dashed line a method is as often right as it is sure.

use l4d_score::cluster::FEW_SCENES;

use super::drawing::{AXIS, Anchor, BLUE, Drawing, GRID, Lettering, MARGIN, Marker, QUIET, leading};
use super::{MOST_METHODS, lettering};
use crate::reliability::{BINS, Reliability};

const PLOT: f64 = 170.0;
const GAP: f64 = 56.0;
const LEFT: f64 = MARGIN + 44.0;
const ABREAST: usize = 3;

/// The figure.
pub(crate) fn draw(methods: &[Reliability], about: &[String]) -> Drawing {
    let intervals = format!(
        "Lines: 95 % intervals, clustered by scene; dashed: from fewer than {FEW_SCENES} scenes, may be too narrow."
    );
    let mut notes = [about, &[intervals]].concat();
    let (methods, left_out) = methods.split_at(methods.len().min(MOST_METHODS));
    if !left_out.is_empty() {
        notes.push(format!("{} more methods are left out.", left_out.len()));
    }
    let (mut drawing, above) = Drawing::headed("Certainty against being right", &notes);
    let mut bottom = above;
    for line in methods.chunks(ABREAST) {
        let names: Vec<Vec<String>> = line.iter().map(|method| name(&method.method)).collect();
        let most = names.iter().map(Vec::len).max().unwrap_or(1);
        let top = bottom + 38.0 + most as f64 * leading(Lettering::HEAD);
        for (index, (method, name)) in line.iter().zip(&names).enumerate() {
            panel(&mut drawing, method, name, (LEFT + index as f64 * (PLOT + GAP), top));
        }
        bottom = top + PLOT + 48.0;
    }
    drawing.height = bottom + MARGIN;
    drawing
}

fn name(method: &str) -> Vec<String> {
    lettering::wrap_name(method, |line| Lettering::HEAD.width(line) <= PLOT + 12.0)
}

fn panel(drawing: &mut Drawing, method: &Reliability, name: &[String], (left, top): (f64, f64)) {
    let (right, bottom) = (left + PLOT, top + PLOT);
    let first = top - 26.0 - (name.len() as f64 - 1.0) * leading(Lettering::HEAD);
    drawing.lines(left, first, name, Lettering::HEAD);
    let without = match method.uncertain {
        0 => String::new(),
        count => format!(", {count} without a vote"),
    };
    drawing.text(left, top - 12.0, &format!("{} answers{without}", method.answers.len()), Lettering::NOTE);
    for tick in [0, 25, 50, 75, 100] {
        let share = f64::from(tick) / 100.0;
        let (x, y) = (left + share * PLOT, bottom - share * PLOT);
        drawing.line([(x, top), (x, bottom)], 0.5, GRID);
        drawing.line([(left, y), (right, y)], 0.5, GRID);
        drawing.text(left - 6.0, y + 3.5, &tick.to_string(), Lettering::NOTE.anchored(Anchor::End));
        if tick % 50 == 0 {
            drawing.text(x, bottom + 28.0, &tick.to_string(), Lettering::NOTE.anchored(Anchor::Middle));
        }
    }
    drawing.dashes((left, bottom), (right, top), 0.75, AXIS);
    drawing.line([(left, top), (left, bottom), (right, bottom)], 0.75, AXIS);
    let bins = method.bins();
    let at = |certainty: f64, right: f64| (left + certainty * PLOT, bottom - right / 100.0 * PLOT);
    drawing.line(bins.iter().map(|bin| at(bin.certainty, bin.right.value)), 1.0, QUIET);
    for bin in &bins {
        if let Some([low, high]) = bin.right.interval {
            let ends = (at(bin.certainty, low), at(bin.certainty, high));
            drawing.whisker(ends.0, ends.1, bin.right.is_of_few_scenes(), BLUE);
        }
    }
    for bin in &bins {
        drawing.marker(Marker::Circle, at(bin.certainty, bin.right.value), 4.0, BLUE);
        // Below the axis, in the middle of the bin, so that counts of near points do not meet.
        let middle = ((bin.certainty * BINS as f64).floor().min(BINS as f64 - 1.0) + 0.5) / BINS as f64;
        let count = Lettering::NOTE.anchored(Anchor::Middle);
        drawing.text(left + middle * PLOT, bottom + 13.0, &format!("n {}", bin.right.queries), count);
    }
    drawing.text(right, bottom + 44.0, "views that agree, %", Lettering::NOTE.anchored(Anchor::End));
    drawing.text(left - 8.0, top - 12.0, "right, %", Lettering::NOTE.anchored(Anchor::End));
}

#[cfg(test)]
mod tests {
    use l4d_data::Name;

    use super::super::drawing::{Extent, Shape, WIDTH};
    use super::*;
    use crate::reliability::Answered;

    #[test]
    fn nothing_leaves_the_canvas_and_texts_do_not_meet() {
        for count in [1, 2, 5] {
            let method = |index: usize| Reliability {
                method: format!("panopticquery-grounder-{index}-with-a-long-name"),
                answers: (0..40)
                    .map(|at| Answered {
                        scene: Name::new(format!("scene{}", at % 6)).unwrap(),
                        certainty: f64::from(at) / 39.0,
                        is_right: at % 3 > 0,
                    })
                    .collect(),
                uncertain: index,
            };
            let drawing = draw(&(0..count).map(method).collect::<Vec<_>>(), &["about".to_owned()]);
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            let mut texts: Vec<(Extent, &str)> = Vec::new();
            for shape in &drawing.shapes {
                if let Shape::Text { x, baseline, text, lettering } = shape {
                    let extent = Extent::of_text(*x, *baseline, text, *lettering);
                    assert!(canvas.holds(extent), "{count}: {text} at {extent:?}");
                    let met = texts.iter().find(|(other, _)| extent.overlaps(*other));
                    assert!(met.is_none(), "{count}: {text} meets {met:?}");
                    texts.push((extent, text));
                }
            }
        }
    }
}
