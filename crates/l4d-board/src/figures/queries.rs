//! IoU of every query over the clip: one row a query, best first, one panel a category.

use l4d_data::Category;
use l4d_score::counts::State;

use super::drawing::{
    AXIS, Anchor, Colour, Drawing, Extent, INK, Lettering, MARGIN, PAPER, VERMILLION, WIDTH,
};
use crate::detail::{Detail, Details, FrameDetail};
use crate::rank::Board;

const GAP: f64 = 22.0;
/// Height of a row where there are few, and where there are many.
const ROWS: (f64, f64) = (9.0, 2.5);
const TALLEST: f64 = 420.0;
/// Light to dark in even steps of luminance, so that grey says the same: a miss is the lightest.
const MISSED: Colour = (0xFB, 0xDC, 0x9C);
const BLUES: [Colour; 5] =
    [(0x8F, 0xBD, 0xE0), (0x5B, 0x9B, 0xCB), (0x35, 0x79, 0xB0), (0x18, 0x53, 0x88), (0x08, 0x25, 0x52)];

/// What a cell shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cell {
    /// Something is to be found and was, at least a little: place among [`BLUES`].
    Found(usize),
    /// Something is to be found and was not.
    Missed,
    /// Nothing is to be found, and something was marked.
    FalseAlarm,
    /// Nothing is to be found, nothing was.
    Empty,
}

impl Cell {
    fn of(frame: &FrameDetail) -> Self {
        match frame.state {
            State::Hit => {
                let step = frame.iou().unwrap_or(0.0) * BLUES.len() as f64;
                Self::Found((step as usize).min(BLUES.len() - 1))
            }
            State::Miss | State::Missing if frame.union > 0 => Self::Missed,
            State::FalseAlarm => Self::FalseAlarm,
            _ => Self::Empty,
        }
    }
}

/// The figure of one method.
pub(crate) fn draw(board: &Board, method: &str, details: &Details, detail: &Detail) -> Drawing {
    let notes = ["One row a query, best first; canonical frames from left to right.".to_owned()];
    let title = format!("IoU over time, query by query: {method}");
    let (mut drawing, above) = Drawing::titled(&title, board, &notes);
    let top = legend(&mut drawing, above) + 36.0;
    let panels: Vec<(Category, Vec<Vec<&FrameDetail>>)> =
        Category::ALL.into_iter().map(|category| (category, rows(category, details, detail))).collect();
    let most = panels.iter().map(|(_, rows)| rows.len()).max().unwrap_or(0).max(1);
    let row = (TALLEST / most as f64).clamp(ROWS.1, ROWS.0);
    let pitch = (WIDTH - 2.0 * MARGIN + GAP) / panels.len() as f64;
    let width = pitch - GAP;
    for (index, (category, rows)) in panels.iter().enumerate() {
        let left = MARGIN + index as f64 * pitch;
        let noun = if rows.len() == 1 { "query" } else { "queries" };
        drawing.text(
            left,
            top - 10.0,
            &format!("{}: {} {noun}", category.as_str(), rows.len()),
            Lettering::HEAD,
        );
        for (place, frames) in rows.iter().enumerate() {
            line(
                &mut drawing,
                frames,
                Extent {
                    left,
                    top: top + place as f64 * row,
                    right: left + width,
                    bottom: top + (place + 1) as f64 * row,
                },
            );
        }
        let bottom = top + rows.len() as f64 * row;
        let border = [(left, top), (left + width, top), (left + width, bottom), (left, bottom), (left, top)];
        drawing.line(border, 0.75, AXIS);
        ends(&mut drawing, rows, left, width, bottom);
    }
    drawing.height = top + most as f64 * row + 18.0 + MARGIN;
    drawing
}

/// Frames of the queries of a category that have a target, the best query first.
fn rows<'a>(category: Category, details: &Details, detail: &'a Detail) -> Vec<Vec<&'a FrameDetail>> {
    let queries = details.asked.queries().zip(detail.tallies.iter().zip(&detail.queries));
    let of_category = queries.filter(|((query, _), _)| query.categories.first() == Some(&category));
    let mut rows: Vec<(f64, Vec<&FrameDetail>)> = of_category
        .filter_map(|(_, (tally, found))| {
            let frames = found.frames.iter().filter(|frame| frame.state != State::NotAnnotated);
            Some((tally.ratios().miou?, frames.collect()))
        })
        .collect();
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    rows.into_iter().map(|(_, frames)| frames).collect()
}

/// Neighbours that look the same become one bar.
fn line(drawing: &mut Drawing, frames: &[&FrameDetail], extent: Extent) {
    let step = (extent.right - extent.left) / frames.len().max(1) as f64;
    let cells: Vec<Cell> = frames.iter().map(|frame| Cell::of(frame)).collect();
    let mut first = 0;
    while first < cells.len() {
        let last = (first..cells.len()).take_while(|&at| cells[at] == cells[first]).count() + first;
        let x = extent.left + first as f64 * step;
        let width = (last - first) as f64 * step;
        fill(drawing, cells[first], Extent { left: x, right: x + width, ..extent });
        first = last;
    }
}

fn fill(drawing: &mut Drawing, cell: Cell, extent: Extent) {
    let Extent { left, top, right, bottom } = extent;
    match cell {
        Cell::Found(step) => drawing.bar(left, top, right - left, bottom - top, BLUES[step]),
        Cell::Missed => drawing.bar(left, top, right - left, bottom - top, MISSED),
        Cell::FalseAlarm => {
            let middle = f64::midpoint(top, bottom);
            drawing.line([(left, middle), (right, middle)], 1.0, VERMILLION);
        }
        Cell::Empty => {}
    }
}

fn ends(drawing: &mut Drawing, rows: &[Vec<&FrameDetail>], left: f64, width: f64, bottom: f64) {
    let frames = || rows.iter().flatten().map(|frame| frame.frame);
    let (Some(first), Some(last)) = (frames().min(), frames().max()) else { return };
    drawing.text(left, bottom + 13.0, &first.to_string(), Lettering::NOTE);
    drawing.text(left + width, bottom + 13.0, &last.to_string(), Lettering::NOTE.anchored(Anchor::End));
}

fn legend(drawing: &mut Drawing, above: f64) -> f64 {
    let baseline = above + 20.0;
    let mut x = MARGIN;
    let swatch = |drawing: &mut Drawing, x: f64, cell: Cell| {
        let extent = Extent { left: x, top: baseline - 9.0, right: x + 16.0, bottom: baseline + 1.0 };
        drawing.bar(x, extent.top, 16.0, 10.0, PAPER);
        fill(drawing, cell, extent);
        let Extent { left, top, right, bottom } = extent;
        drawing.line([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], 0.5, AXIS);
    };
    drawing.text(x, baseline, "IoU", Lettering::NOTE.coloured(INK));
    x += Lettering::NOTE.width("IoU") + 6.0;
    for step in 0..BLUES.len() {
        swatch(drawing, x, Cell::Found(step));
        x += 16.0;
    }
    for (cell, text) in [
        (None, "0 to 100 in steps of 20"),
        (Some(Cell::Missed), "missed"),
        (Some(Cell::FalseAlarm), "marked where there is nothing"),
        (Some(Cell::Empty), "nothing to find, nothing marked"),
    ] {
        if let Some(cell) = cell {
            swatch(drawing, x, cell);
            x += 16.0;
        }
        drawing.text(x + 5.0, baseline, text, Lettering::NOTE);
        x += 5.0 + Lettering::NOTE.width(text) + 16.0;
    }
    baseline
}
