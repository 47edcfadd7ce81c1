//! Tube IoU and select against mIoU: what the paper's metric cannot tell apart.
//!
//! On the dashed line both metrics say the same. Far below it in the left panel stand methods that ignore time, in
//! the right one those that outline well what was not asked for.

use l4d_data::results::Track;

use super::drawing::{AXIS, Anchor, Drawing, Extent, GRID, INK, Lettering, MARGIN, QUIET, WIDTH};
use super::place::Leaders;
use super::{labels, named, place, shown};
use crate::rank::Board;
use crate::row::{BoardRow, Metric};

const PLOT: f64 = 270.0;
const GAP: f64 = 64.0;
const LEFT: f64 = MARGIN + 34.0;

/// Two scatters side by side.
pub(crate) fn draw(board: &Board) -> Drawing {
    let (rows, left_out) = shown(board);
    let mut notes = vec![
        "Under the dashed line: tube IoU sees masks at times when there is no target; select sees outlines of the wrong thing."
            .to_owned(),
    ];
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    let (mut drawing, above) = Drawing::titled("What mIoU cannot tell apart", board, &notes);
    let top = labels::methods_legend(&mut drawing, board, above) + 32.0;

    let panels = [Metric::TubeIou, Metric::Select].map(|metric| clusters(&rows, metric));
    let names: Vec<String> = rows.iter().map(|(_, row)| named(row)).collect();
    let numbers: Vec<String> = (1..=rows.len()).map(|number| number.to_string()).collect();
    let by_name = panels
        .iter()
        .enumerate()
        .all(|(index, clusters)| places(clusters, &names, index, top, Leaders::Avoid).is_some());
    let texts = if by_name { &names } else { &numbers };

    for (index, (clusters, metric)) in panels.iter().zip([Metric::TubeIou, Metric::Select]).enumerate() {
        axes(&mut drawing, panel_left(index), top, metric);
        scatter(&mut drawing, clusters, texts, index, top);
    }
    let mut bottom = top + PLOT + 37.0;
    if !by_name {
        bottom = labels::key(&mut drawing, &names, 3, bottom + 8.0);
    }
    drawing.height = bottom + MARGIN;
    drawing
}

/// Methods that fall on one spot, with one label for all.
struct Cluster {
    /// mIoU and the other metric, percent.
    at: (f64, f64),
    members: Vec<usize>,
    ranked_in: Option<Track>,
}

fn clusters(rows: &[(Option<usize>, &BoardRow)], metric: Metric) -> Vec<Cluster> {
    let mut clusters: Vec<Cluster> = Vec::new();
    for (index, (rank, row)) in rows.iter().enumerate() {
        let (Some(miou), Some(other)) = (row.scores.headline.miou, metric.of(&row.scores.headline)) else {
            continue;
        };
        let ranked_in = rank.map(|_| row.track);
        let same_spot = |cluster: &&mut Cluster| {
            (cluster.at.0 - miou).hypot(cluster.at.1 - other) < 0.75 && cluster.ranked_in == ranked_in
        };
        match clusters.iter_mut().find(same_spot) {
            Some(cluster) => cluster.members.push(index),
            None => clusters.push(Cluster { at: (miou, other), members: vec![index], ranked_in }),
        }
    }
    clusters
}

fn panel_left(index: usize) -> f64 {
    LEFT + index as f64 * (PLOT + GAP)
}

fn position((x, y): (f64, f64), index: usize, top: f64) -> (f64, f64) {
    (panel_left(index) + x / 100.0 * PLOT, top + (1.0 - y / 100.0) * PLOT)
}

fn joined(cluster: &Cluster, labels: &[String]) -> String {
    let members: Vec<&str> = cluster.members.iter().map(|&member| labels[member].as_str()).collect();
    members.join(", ")
}

fn places(
    clusters: &[Cluster],
    labels: &[String],
    index: usize,
    top: f64,
    leaders: Leaders,
) -> Option<Vec<place::Place>> {
    let points: Vec<(f64, f64)> = clusters.iter().map(|cluster| position(cluster.at, index, top)).collect();
    let labels: Vec<String> = clusters.iter().map(|cluster| joined(cluster, labels)).collect();
    let left = panel_left(index);
    let bounds = Extent {
        left: left + 2.0,
        top: top - 8.0,
        right: (left + PLOT + GAP - 30.0).min(WIDTH - 4.0),
        bottom: top + PLOT - 1.0,
    };
    place::beside_points(&points, &labels, Lettering::NUMBER, bounds, leaders)
}

fn scatter(drawing: &mut Drawing, clusters: &[Cluster], labels: &[String], index: usize, top: f64) {
    let placed = places(clusters, labels, index, top, Leaders::Avoid)
        .or_else(|| places(clusters, labels, index, top, Leaders::Cross));
    for (at, cluster) in clusters.iter().enumerate() {
        let (x, y) = position(cluster.at, index, top);
        let place = placed.as_ref().map(|placed| placed[at]);
        if let Some(end) = place.and_then(|place| place.leader_to) {
            drawing.line([(x, y), end], 0.5, AXIS);
        }
    }
    for cluster in clusters {
        let (x, y) = position(cluster.at, index, top);
        drawing.mark(x, y, cluster.ranked_in);
    }
    for (at, cluster) in clusters.iter().enumerate() {
        let (x, y) = position(cluster.at, index, top);
        // Where even numbers find no room, a label on the point is better than none.
        let fallback = place::Place { x: x + 7.0, baseline: y + 3.5, anchor: Anchor::Start, leader_to: None };
        let place = placed.as_ref().map_or(fallback, |placed| placed[at]);
        let ink = if cluster.ranked_in.is_some() { INK } else { QUIET };
        let lettering = Lettering::NUMBER.coloured(ink).anchored(place.anchor);
        let label = joined(cluster, labels);
        if placed.is_some() {
            drawing.knock_out(place.x, place.baseline, &label, lettering);
        }
        drawing.text(place.x, place.baseline, &label, lettering);
    }
}

fn axes(drawing: &mut Drawing, left: f64, top: f64, metric: Metric) {
    let (right, bottom) = (left + PLOT, top + PLOT);
    for tick in [0, 25, 50, 75, 100] {
        let share = f64::from(tick) / 100.0;
        let (x, y) = (left + share * PLOT, bottom - share * PLOT);
        drawing.line([(x, top), (x, bottom)], 0.5, GRID);
        drawing.line([(left, y), (right, y)], 0.5, GRID);
        drawing.text(x, bottom + 17.0, &tick.to_string(), Lettering::NOTE.anchored(Anchor::Middle));
        drawing.text(left - 8.0, y + 3.5, &tick.to_string(), Lettering::NOTE.anchored(Anchor::End));
    }
    drawing.dashes((left, bottom), (right, top), 0.5, AXIS);
    drawing.line([(left, top), (left, bottom), (right, bottom)], 0.75, AXIS);
    drawing.text(left - 26.0, top - 14.0, &format!("{}, %", metric.title()), Lettering::HEAD);
    drawing.text(right, bottom + 32.0, "mIoU, %", Lettering::HEAD.anchored(Anchor::End));
}
