//! Which distributions of the set are drawn, in which bins.

use anyhow::Result;
use l4d_board::{Chart, Layout, Panel, draw_charts};
use l4d_data::Scale;
use l4d_query::stats::{QueryRow, SetStats};

use crate::out::Printer;

/// Rows of a panel of words.
const MOST_WORDS: usize = 18;

/// All figures of the set: name and bytes of each file.
pub(crate) fn draw_stats(stats: &SetStats, _: &Printer) -> Result<Vec<(String, Vec<u8>)>> {
    Ok(draw_charts(&all(stats))?)
}

fn all(stats: &SetStats) -> Vec<Chart> {
    let of = format!("Queries: {}. Scenes: {}.", stats.queries.len(), stats.scenes.len());
    let chart = |name, title: &str, note: &str, panels| Chart {
        name,
        title: title.to_owned(),
        notes: vec![of.clone(), note.to_owned()],
        panels,
    };
    let mut charts = vec![chart("words", "Words of the sentences", "most frequent first", words(stats))];
    for (name, title, what, edges, value) in SPREADS {
        let note = format!("{what}; each bin from its label to the next");
        charts.push(chart(name, title, &note, per_scale(stats, edges, value)));
    }
    let note = "canonical frames, 24 a second; each bin from its label to the next";
    charts.push(chart("intervals", "How long things last", note, intervals(stats)));
    charts
}

/// A chart of queries, a panel a scale: name, title, what is counted, edges of the bins, value of a query.
type Spread = (&'static str, &'static str, &'static str, &'static [f64], fn(&QueryRow) -> Option<f64>);

const SPREADS: [Spread; 4] = [
    (
        "sizes",
        "How large referents are",
        "diagonal of the box, metres",
        &[0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2],
        |row| Some(row.size_m),
    ),
    (
        "pixels",
        "Pixels of referents in the held-out view",
        "mean over the frames in which the query holds and they show",
        &[75.0, 150.0, 300.0, 600.0, 1200.0, 2400.0, 4800.0],
        |row| row.pixels,
    ),
    (
        "visibility",
        "How long the held-out view shows referents",
        "share of the frames in which the query holds, percent",
        &[50.0, 60.0, 70.0, 80.0, 90.0, 100.0],
        |row| row.visible_percent,
    ),
    (
        "motion",
        "How far referents move while the query holds",
        "path of the box centre, metres",
        &[0.01, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0],
        |row| Some(row.path_m),
    ),
];

fn words(stats: &SetStats) -> Vec<Panel> {
    let kinds =
        [("noun", "Nouns"), ("verb", "Verbs"), ("adjective", "Adjectives"), ("preposition", "Prepositions")];
    let panel = |(kind, title): (&str, &str)| {
        let of: Vec<_> = stats.words.iter().filter(|row| row.kind == kind).collect();
        let bars = of.iter().take(MOST_WORDS).map(|row| (row.word.clone(), row.count)).collect();
        Panel { title: title.to_owned(), note: format!("{} different", of.len()), bars, layout: Layout::Rows }
    };
    kinds.map(panel).into_iter().filter(|panel| !panel.bars.is_empty()).collect()
}

fn per_scale(stats: &SetStats, edges: &[f64], value: impl Fn(&QueryRow) -> Option<f64>) -> Vec<Panel> {
    let panel = |scale: Scale| {
        let of = stats.queries.iter().filter(|row| row.scale == scale.as_str());
        let values: Vec<f64> = of.filter_map(&value).collect();
        let note = if values.is_empty() {
            "no pictures of this profile".to_owned()
        } else {
            format!("{} queries", values.len())
        };
        Panel { title: title_case(scale.as_str()), note, bars: bins(&values, edges), layout: Layout::Columns }
    };
    Scale::ALL.map(panel).into()
}

fn intervals(stats: &SetStats) -> Vec<Panel> {
    let edges = [25.0, 37.0, 49.0, 61.0, 73.0, 85.0, 97.0];
    let panel = |title: &str, values: Vec<f64>| Panel {
        title: title.to_owned(),
        note: format!("{} of them", values.len()),
        bars: bins(&values, &edges),
        layout: Layout::Columns,
    };
    let gated = stats.queries.iter().filter(|row| row.temporal == "while");
    vec![
        panel("Gated queries", gated.map(|row| f64::from(row.frames)).collect()),
        panel("Declared events", stats.event_frames.iter().map(|&frames| f64::from(frames)).collect()),
    ]
}

/// Counts below the first edge, from each edge to the next, and from the last one on.
fn bins(values: &[f64], edges: &[f64]) -> Vec<(String, usize)> {
    let bin = |value: f64| edges.iter().take_while(|edge| value >= **edge).count();
    let label = |index: usize| match index {
        0 => format!("<{}", edges[0]),
        index => format!("{}", edges[index - 1]),
    };
    (0..=edges.len())
        .map(|index| (label(index), values.iter().filter(|value| bin(**value) == index).count()))
        .collect()
}

fn title_case(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
