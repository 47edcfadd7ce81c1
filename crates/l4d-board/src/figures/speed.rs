//! Seconds a query against mIoU, with the methods of each track that none of it beats in both.

use l4d_data::results::Track;
use l4d_score::cluster::FEW_SCENES;

use super::drawing::{
    BLUE, Colour, Drawing, Extent, INK, Lettering, MARGIN, QUIET, SHADE, SKY, WIDTH, leading,
};
use super::labels::{methods_legend, name_points};
use super::pareto::stairs;
use super::scale::{LEFT, Scale};
use super::{lettering, named, shown};
use crate::rank::Board;
use crate::row::BoardRow;
use crate::tradeoff::unbeaten;

const TITLE: &str = "Speed against error";
const PLOT: f64 = 300.0;

/// A method that says how long it took.
struct Timed<'a> {
    row: &'a BoardRow,
    /// None where it is not ranked.
    ranked_in: Option<Track>,
    seconds_a_query: f64,
    /// Percent.
    miou: f64,
}

/// The figure. Seconds are what methods say of themselves.
pub(crate) fn draw(board: &Board) -> Drawing {
    let (rows, left_out) = shown(board);
    let mut notes = vec![
        "Wall seconds a query as methods report them, each of its own machine: compare orders of magnitude."
            .to_owned(),
        format!(
            "{} Upright lines: 95 % intervals, dashed from fewer than {FEW_SCENES} scenes.",
            steps_note(board)
        ),
    ];
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    let (mut drawing, above) = Drawing::titled(TITLE, board, &notes);
    let timed: Vec<Timed> =
        rows.iter().filter_map(|(rank, row)| timed(rank.map(|_| row.track), row)).collect();
    let is_timed = |row: &BoardRow| timed.iter().any(|method| method.row.name == row.name);
    let untimed: Vec<String> =
        rows.iter().filter(|(_, row)| !is_timed(row)).map(|(_, row)| named(row)).collect();

    let below = match timed.is_empty() {
        true => {
            drawing.text(MARGIN, above + 40.0, "No method says how long it took.", Lettering::LABEL);
            above + 52.0
        }
        false => plot(&mut drawing, board, &timed, above),
    };
    let bottom = name_untimed(&mut drawing, &untimed, below);
    drawing.height = bottom + MARGIN;
    drawing
}

/// Nothing for methods without an answer to time, and for those that claim to take no time at all.
fn timed(ranked_in: Option<Track>, row: &BoardRow) -> Option<Timed<'_>> {
    let seconds_a_query = row.seconds? / row.asked as f64;
    let miou = row.scores.headline.miou?;
    (seconds_a_query.is_finite() && seconds_a_query > 0.0).then_some(Timed {
        row,
        ranked_in,
        seconds_a_query,
        miou,
    })
}

fn plot(drawing: &mut Drawing, board: &Board, timed: &[Timed], above: f64) -> f64 {
    let top = methods_legend(drawing, board, above) + 32.0;
    let bottom = top + PLOT;
    let scale = Scale::of_percentages(timed.iter().map(|method| method.seconds_a_query), (top, bottom));
    scale.axes(drawing, "seconds a query", "mIoU, %");
    let at = |method: &Timed| scale.position(method.seconds_a_query, method.miou);

    // Labels keep clear of the fronts and of intervals.
    let mut points: Vec<(f64, f64)> = timed.iter().map(at).collect();
    for track in Track::ALL {
        let ranked: Vec<&Timed> = timed.iter().filter(|method| method.ranked_in == Some(track)).collect();
        let measured: Vec<(f64, f64)> =
            ranked.iter().map(|method| (method.seconds_a_query, method.miou)).collect();
        let front: Vec<(f64, f64)> = unbeaten(&measured).into_iter().map(|index| at(ranked[index])).collect();
        let line = stairs(drawing, &front, steps_colour(track));
        points.extend(line.windows(2).flat_map(|ends| along(ends[0], ends[1])));
    }
    for method in timed {
        let Some(found) = method.row.miou else { continue };
        if let Some(ends) = found.interval {
            let [low, high] = ends.map(|value| scale.position(method.seconds_a_query, value));
            drawing.whisker(low, high, found.is_of_few_scenes(), ink(method, BLUE));
            points.extend(along(low, high));
        }
    }
    for method in timed {
        let (x, y) = at(method);
        drawing.mark(x, y, method.ranked_in);
    }
    let labels: Vec<(String, Colour)> =
        timed.iter().map(|method| (named(method.row), ink(method, INK))).collect();
    let bounds = Extent { left: LEFT + 2.0, top: top - 8.0, right: WIDTH - 4.0, bottom: bottom - 2.0 };
    name_points(drawing, &points, &labels, bounds, (bottom + 34.0, 2))
}

/// Points on a line, as near as labels have to know it.
fn along(from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let steps = ((to.0 - from.0).hypot(to.1 - from.1) / 8.0).ceil().max(1.0) as usize;
    (0..=steps).map(move |step| {
        let share = step as f64 / steps as f64;
        (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
    })
}

/// Which fronts there are, in words.
fn steps_note(board: &Board) -> String {
    let is_single = board.tracks().count() < 2;
    let steps = if is_single { "Grey steps" } else { "Steps (grey: colour, light blue: colour + depth)" };
    format!("{steps}: ranked methods that no ranked method of their track beats in both.")
}

fn steps_colour(track: Track) -> Colour {
    match track {
        Track::Colour => SHADE,
        Track::ColourDepth => SKY,
    }
}

fn ink(method: &Timed, of_ranked: Colour) -> Colour {
    if method.ranked_in.is_some() { of_ranked } else { QUIET }
}

fn name_untimed(drawing: &mut Drawing, names: &[String], below: f64) -> f64 {
    if names.is_empty() {
        return below;
    }
    let text = format!("No time reported: {}.", names.join(", "));
    let lines = lettering::wrap(&text, |line| Lettering::NOTE.width(line) <= WIDTH - 2.0 * MARGIN, " ");
    let first = below + 18.0;
    drawing.lines(MARGIN, first, &lines, Lettering::NOTE);
    first + (lines.len() as f64 - 1.0) * leading(Lettering::NOTE) + 2.0
}
