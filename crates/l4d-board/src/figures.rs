//! Figures: each is a pure function from a board to a [`Drawing`]; `paint` turns drawings into SVG and PNG.
//!
//! House style: one accent and greys (Okabe-Ito), direct labels, thin axes, percentages from zero, print size.

mod bars;
mod drawing;
mod lettering;
mod metrics;
mod multiples;
mod paint;
mod pareto;
mod place;
mod queries;
mod reliability;
mod taken;
mod time;
mod trend;

pub(crate) use drawing::Drawing;
pub(crate) use multiples::draw as chart;
pub(crate) use paint::{png, svg};
pub(crate) use pareto::draw as tradeoff;
pub(crate) use reliability::draw as reliability;
pub(crate) use trend::draw as trend;

use crate::detail::Details;
use crate::rank::Board;
use crate::row::BoardRow;
use crate::taken::choices;

/// A figure and what to call it.
pub(crate) struct Figure {
    /// File stem.
    pub(crate) name: &'static str,
    /// What it shows, one sentence without markup.
    pub(crate) caption: &'static str,
    /// The picture.
    pub(crate) drawing: Drawing,
}

/// All figures of a board, in the order of the page.
pub(crate) fn all(board: &Board) -> Vec<Figure> {
    vec![
        Figure { name: "per_category", caption: "mIoU per category", drawing: bars::per_category(board) },
        Figure { name: "per_scale", caption: "mIoU per scale", drawing: bars::per_scale(board) },
        Figure {
            name: "metrics",
            caption: "What mIoU cannot tell apart: tube IoU and select against mIoU",
            drawing: metrics::draw(board),
        },
        Figure { name: "over_time", caption: "Mean IoU over the clip", drawing: time::draw(board) },
    ]
}

/// Figures of what methods did query by query.
pub(crate) fn detailed(board: &Board, details: &Details) -> Vec<Figure> {
    let (rows, left_out) = shown(board);
    let is_shown = |name: &l4d_data::Name| rows.iter().any(|(_, row)| row.name == *name);
    let choices: Vec<_> =
        choices(board, details).into_iter().filter(|choices| is_shown(choices.method)).collect();
    let mut figures = vec![Figure {
        name: "taken",
        caption: "What was taken for the thing that was meant",
        drawing: taken::draw(board, &choices, left_out),
    }];
    if let Some(((_, row), detail)) = board.rows().zip(&details.methods).next() {
        figures.push(Figure {
            name: "queries",
            caption: "IoU over time of the first method, query by query",
            drawing: queries::draw(board, &row.name, details, detail),
        });
    }
    figures
}

/// More methods than this make a figure that nobody reads; the tables have them all.
const MOST_METHODS: usize = 24;

/// The methods that a figure shows, and how many it leaves out. The unranked bracket the scale, so they stay.
fn shown(board: &Board) -> (Vec<(Option<usize>, &BoardRow)>, usize) {
    let total = board.ranked.len() + board.unranked.len();
    let unranked = board.unranked.len().min(MOST_METHODS / 2);
    let ranked = board.ranked.len().min(MOST_METHODS - unranked);
    let is_shown = |index: &usize| {
        *index < ranked || (board.ranked.len()..board.ranked.len() + unranked).contains(index)
    };
    let rows: Vec<_> =
        board.rows().enumerate().filter(|(index, _)| is_shown(index)).map(|(_, row)| row).collect();
    let left_out = total - rows.len();
    (rows, left_out)
}

#[cfg(test)]
mod tests;
