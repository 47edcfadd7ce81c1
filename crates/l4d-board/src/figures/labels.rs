//! Names of points: beside them where there is room, else numbers with a key below; and what their marks mean.

use l4d_data::results::Track;

use super::drawing::{AXIS, Anchor, Colour, Drawing, Extent, INK, Lettering, MARGIN, WIDTH, leading};
use super::lettering;
use super::place::{self, Leaders, Place};
use crate::rank::Board;

/// Names the first of `points`, one label each with its ink, within `bounds` and clear of all points. A key would
/// stand below `key_top` in so many columns; gives the lower edge of what was written below it, or `key_top`.
pub(super) fn name_points(
    drawing: &mut Drawing,
    points: &[(f64, f64)],
    labels: &[(String, Colour)],
    bounds: Extent,
    (key_top, columns): (f64, usize),
) -> f64 {
    let names: Vec<String> = labels.iter().map(|(name, _)| name.clone()).collect();
    let inks: Vec<Colour> = labels.iter().map(|(_, ink)| *ink).collect();
    let placed =
        |labels: &[String], leaders| place::beside_points(points, labels, Lettering::NUMBER, bounds, leaders);
    if let Some(places) = placed(&names, Leaders::Avoid) {
        write(drawing, points, &places, &names, &inks);
        return key_top;
    }
    let numbers: Vec<String> = (1..=names.len()).map(|number| number.to_string()).collect();
    let places = placed(&numbers, Leaders::Avoid).or_else(|| placed(&numbers, Leaders::Cross));
    // Where even numbers find no room, a label on the point is better than none.
    let fallback = |&(x, y): &(f64, f64)| Place {
        x: x + 7.0,
        baseline: y - 6.0,
        anchor: Anchor::Start,
        leader_to: None,
    };
    let places = places.unwrap_or_else(|| points.iter().take(names.len()).map(fallback).collect());
    write(drawing, points, &places, &numbers, &inks);
    key(drawing, &names, columns, key_top + 8.0)
}

fn write(drawing: &mut Drawing, points: &[(f64, f64)], places: &[Place], labels: &[String], inks: &[Colour]) {
    for (&(x, y), place) in points.iter().zip(places) {
        if let Some(end) = place.leader_to {
            drawing.line([(x, y), end], 0.5, AXIS);
        }
    }
    for ((place, label), &ink) in places.iter().zip(labels).zip(inks) {
        let lettering = Lettering::NUMBER.anchored(place.anchor).coloured(ink);
        drawing.knock_out(place.x, place.baseline, label, lettering);
        drawing.text(place.x, place.baseline, label, lettering);
    }
}

/// What the numbers stand for, in columns; gives its lower edge.
pub(super) fn key(drawing: &mut Drawing, names: &[String], columns: usize, top: f64) -> f64 {
    let pitch = (WIDTH - 2.0 * MARGIN) / columns as f64;
    let per_column = names.len().div_ceil(columns);
    let mut bottom = top;
    for column in 0..columns {
        let x = MARGIN + column as f64 * pitch;
        let mut baseline = top + 12.0;
        for (index, name) in names.iter().enumerate().skip(column * per_column).take(per_column) {
            let room = pitch - 30.0;
            let lines = lettering::wrap(name, |line| Lettering::NUMBER.width(line) <= room, "_-. ");
            let number = Lettering::NUMBER.bold().anchored(Anchor::End).coloured(INK);
            drawing.text(x + 16.0, baseline, &(index + 1).to_string(), number);
            drawing.lines(x + 21.0, baseline, &lines, Lettering::NUMBER);
            baseline += lines.len() as f64 * leading(Lettering::NUMBER) + 3.0;
        }
        bottom = bottom.max(baseline - 10.0);
    }
    bottom
}

/// What the marks of methods mean, where there are several kinds or the track has to be said; gives the first free
/// height below.
pub(super) fn methods_legend(drawing: &mut Drawing, board: &Board, above: f64) -> f64 {
    let mut kinds: Vec<(Option<Track>, String)> =
        board.tracks().map(|(track, _)| (Some(track), format!("ranked, track {}", track.title()))).collect();
    if !board.unranked.is_empty() {
        kinds.push((None, "not ranked, shown for scale".to_owned()));
    }
    if matches!(kinds[..], [] | [(Some(Track::Colour) | None, _)]) {
        return above + 8.0;
    }
    let baseline = above + 18.0;
    let mut x = MARGIN;
    for (ranked_in, text) in kinds {
        drawing.mark(x + 5.0, baseline - 3.5, ranked_in);
        drawing.text(x + 14.0, baseline, &text, Lettering::NOTE);
        x += 14.0 + Lettering::NOTE.width(&text) + 14.0;
    }
    baseline + 8.0
}
