//! What was taken for the thing that was meant: one bar a method, cut by what its prediction overlaps most.

use super::drawing::{
    AXIS, Anchor, BLUE, Colour, Drawing, Extent, GRID, Hatch, INK, Lettering, MARGIN, ORANGE, PAPER, QUIET,
    SHADE, SKY, VERMILLION, WIDTH, leading,
};
use super::{lettering, name_in};
use crate::rank::Board;
use crate::taken::{Choice, Choices};

const BAR: f64 = 15.0;
const LONGEST_LABEL: f64 = 190.0;
/// Parts that are narrower have no room for their number.
const NARROWEST: f64 = 24.0;

fn look(choice: Choice) -> (Colour, Option<Hatch>, Colour) {
    match choice {
        Choice::Meant => (BLUE, None, PAPER),
        Choice::Tied => (SKY, Some(Hatch::Upright), INK),
        Choice::LookAlike => (VERMILLION, Some(Hatch::Rising), INK),
        Choice::OtherObject => (ORANGE, Some(Hatch::Falling), INK),
        Choice::Landmark => (SHADE, None, INK),
        Choice::Nothing => (PAPER, None, INK),
    }
}

/// The figure; one entry of `choices` a method, in the order of the board.
pub(crate) fn draw(board: &Board, choices: &[&Choices], left_out: usize) -> Drawing {
    let mut notes =
        vec!["Share of queries by the thing that the prediction overlaps most over the clip, %.".to_owned()];
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    let (mut drawing, above) = Drawing::titled("What was taken for the thing that was meant", board, &notes);
    let top = legend(&mut drawing, above) + 16.0;
    let label = Lettering::LABEL.anchored(Anchor::End);
    let labels: Vec<Vec<String>> = choices
        .iter()
        .map(|one| {
            lettering::wrap_name(&name_in(one.method, one.track), |line| label.width(line) <= LONGEST_LABEL)
        })
        .collect();
    let label_width = labels.iter().flatten().map(|line| label.width(line)).fold(0.0, f64::max);
    let left = MARGIN + label_width + 8.0;
    let scale = (WIDTH - MARGIN - 12.0 - left) / 100.0;

    let mut y = top;
    let mut middles = Vec::new();
    for (index, lines) in labels.iter().enumerate() {
        let group = |one: &Choices| one.is_ranked.then_some(one.track);
        let begins_group = index > 0 && group(choices[index]) != group(choices[index - 1]);
        y += if begins_group { 8.0 } else { 0.0 };
        let height = (BAR + 7.0).max(lines.len() as f64 * leading(label) + 5.0);
        middles.push(y + height / 2.0);
        y += height;
    }
    let bottom = y + 2.0;
    for tick in [0, 25, 50, 75, 100] {
        let x = left + f64::from(tick) * scale;
        drawing.line([(x, top - 4.0), (x, bottom)], 0.5, GRID);
        drawing.text(x, bottom + 13.0, &tick.to_string(), Lettering::NOTE.anchored(Anchor::Middle));
    }
    for ((one, lines), &middle) in choices.iter().zip(&labels).zip(&middles) {
        bar(&mut drawing, one, (left, middle - BAR / 2.0), scale);
        let first = middle + 4.0 - (lines.len() as f64 - 1.0) * leading(label) / 2.0;
        let ink = if one.is_ranked { label } else { label.coloured(QUIET) };
        drawing.lines(MARGIN + label_width, first, lines, ink);
    }
    drawing.text(left, bottom + 28.0, "queries, %", Lettering::NOTE);
    drawing.height = bottom + 28.0 + MARGIN;
    drawing
}

fn bar(drawing: &mut Drawing, one: &Choices, (left, top): (f64, f64), scale: f64) {
    let mut x = left;
    for (choice, share) in one.shares() {
        let (fill, hatch, ink) = look(choice);
        let width = share * scale;
        let extent = Extent { left: x, top, right: x + width, bottom: top + BAR };
        drawing.bar(x, top, width, BAR, fill);
        if let Some(hatch) = hatch {
            drawing.stripes(extent, hatch, PAPER);
        }
        if width >= NARROWEST {
            let number = Lettering::NUMBER.anchored(Anchor::Middle).coloured(ink);
            let text = format!("{share:.0}");
            if hatch.is_some() {
                // Letters on stripes need a ground of their own.
                let ground = number.width(&text) + 5.0;
                drawing.bar(x + width / 2.0 - ground / 2.0, top + 1.5, ground, BAR - 3.0, PAPER);
            }
            drawing.text(x + width / 2.0, top + BAR - 4.0, &text, number);
        }
        x += width;
    }
    let frame = [(left, top), (x, top), (x, top + BAR), (left, top + BAR), (left, top)];
    drawing.line(frame, 0.75, AXIS);
}

/// What the parts mean; gives the first free height below.
fn legend(drawing: &mut Drawing, above: f64) -> f64 {
    let mut baseline = above + 20.0;
    let mut x = MARGIN;
    for choice in Choice::ALL {
        let width = 17.0 + Lettering::NOTE.width(choice.title()) + 14.0;
        if x + width > WIDTH - MARGIN && x > MARGIN {
            (x, baseline) = (MARGIN, baseline + 17.0);
        }
        let (fill, hatch, _) = look(choice);
        let extent = Extent { left: x, top: baseline - 9.0, right: x + 12.0, bottom: baseline + 1.0 };
        drawing.bar(x, baseline - 9.0, 12.0, 10.0, fill);
        if let Some(hatch) = hatch {
            drawing.stripes(extent, hatch, PAPER);
        }
        let Extent { left, top, right, bottom } = extent;
        drawing.line([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], 0.5, AXIS);
        drawing.text(x + 17.0, baseline, choice.title(), Lettering::NOTE);
        x += width;
    }
    baseline
}
