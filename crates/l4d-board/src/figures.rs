//! Figures: each is a pure function from a board to a [`Drawing`]; `paint` turns drawings into SVG and PNG.
//!
//! House style: one accent and greys (Okabe-Ito), direct labels, thin axes, percentages from zero, print size.

mod bars;
mod confusion;
mod drawing;
mod labels;
mod lettering;
mod metrics;
mod multiples;
mod paint;
mod pareto;
mod place;
mod queries;
mod reliability;
mod scale;
mod speed;
mod taken;
mod time;
mod trend;

pub(crate) use drawing::Drawing;
pub(crate) use multiples::draw as chart;
pub(crate) use pareto::draw as tradeoff;
pub(crate) use reliability::draw as reliability;
pub(crate) use trend::draw as trend;

use std::path::{Path, PathBuf};

use l4d_data::Name;
use l4d_data::results::Track;
use l4d_data::store::write_atomic;

use crate::detail::{Detail, Details};
use crate::error::BoardError;
use crate::rank::Board;
use crate::row::BoardRow;
use crate::statistics::Statistics;
use crate::taken::{Choices, choices, confusions};

/// A figure and what to call it.
pub(crate) struct Figure {
    /// File stem.
    pub(crate) name: String,
    /// What it shows, one sentence without markup.
    pub(crate) caption: String,
    /// Whether the page of the board shows it; the others stand beside it in the folder.
    pub(crate) is_on_page: bool,
    /// The picture.
    pub(crate) drawing: Drawing,
}

impl Figure {
    fn of_board(name: &str, caption: &str, drawing: Drawing) -> Self {
        Self { name: name.to_owned(), caption: caption.to_owned(), is_on_page: true, drawing }
    }

    /// The files of the figure: their names and what they hold.
    pub(crate) fn files(&self) -> Result<[(String, Vec<u8>); 2], BoardError> {
        files(&self.name, &self.drawing)
    }
}

/// Writes a figure as `<name>.svg` and `<name>.png` into `folder`; gives the paths.
pub(crate) fn write(name: &str, drawing: &Drawing, folder: &Path) -> Result<Vec<PathBuf>, BoardError> {
    let mut paths = Vec::new();
    for (file, bytes) in files(name, drawing)? {
        let path = folder.join(file);
        write_atomic(&path, &bytes)?;
        paths.push(path);
    }
    Ok(paths)
}

fn files(name: &str, drawing: &Drawing) -> Result<[(String, Vec<u8>); 2], BoardError> {
    Ok([
        (format!("{name}.svg"), paint::svg(name, drawing)?.into_bytes()),
        (format!("{name}.png"), paint::png(name, drawing)?),
    ])
}

/// All figures of a board, in the order of the page.
pub(crate) fn all(board: &Board, statistics: &Statistics) -> Vec<Figure> {
    let metrics = "What mIoU cannot tell apart: tube IoU and select against mIoU";
    let speed = "Speed against error: seconds a query, as reported, against mIoU";
    vec![
        Figure::of_board("per_category", "mIoU per category", bars::per_category(board, statistics)),
        Figure::of_board("per_scale", "mIoU per scale", bars::per_scale(board, statistics)),
        Figure::of_board("metrics", metrics, metrics::draw(board)),
        Figure::of_board("speed", speed, speed::draw(board)),
        Figure::of_board("over_time", "Mean IoU over the clip", time::draw(board)),
    ]
}

/// Figures of what methods did query by query.
pub(crate) fn detailed(board: &Board, details: &Details) -> Vec<Figure> {
    let (rows, left_out) = shown(board);
    let is_shown = |name: &Name| rows.iter().any(|(_, row)| row.name == *name);
    let all: Vec<Choices> = choices(board, details);
    let shown: Vec<&Choices> = all.iter().filter(|choices| is_shown(choices.method)).collect();
    let taken = taken::draw(board, &shown, left_out);
    let mut figures = vec![Figure::of_board("taken", "What was taken for the thing that was meant", taken)];
    // Ranked methods come first; a board without any shows its first.
    let drawn = board.ranked.len().clamp(1, MOST_ALONE);
    for (index, (detail, choices)) in details.methods.iter().zip(&all).take(drawn).enumerate() {
        figures.extend(alone(board, details, detail, choices, index == 0));
    }
    figures
}

/// Figures of a single method, named after it: a [`l4d_data::Name`] has no letter that a file could not have.
fn alone(
    board: &Board,
    details: &Details,
    detail: &Detail,
    choices: &Choices,
    is_on_page: bool,
) -> [Figure; 2] {
    let method = choices.method;
    [
        Figure {
            name: format!("queries_{method}"),
            caption: format!("IoU over time, query by query: {method}"),
            is_on_page,
            drawing: queries::draw(board, method, details, detail),
        },
        Figure {
            name: format!("confusion_{method}"),
            caption: format!("Which thing was taken for which: {method}"),
            is_on_page,
            drawing: confusion::draw(board, method, &confusions(choices, details)),
        },
    ]
}

/// The name of a method with its track, unless that is the headline: no two of different tracks compete.
fn named(row: &BoardRow) -> String {
    name_in(&row.name, row.track)
}

fn name_in(name: &Name, track: Track) -> String {
    match track {
        Track::Colour => name.to_string(),
        Track::ColourDepth => format!("{name} + depth"),
    }
}

/// The track in which a row is ranked; none for rows without a rank.
fn group_of((rank, row): &(Option<usize>, &BoardRow)) -> Option<Track> {
    rank.map(|_| row.track)
}

/// Ranked methods that have figures of their own; those that come first.
const MOST_ALONE: usize = 12;
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
