//! What the page knows when it opens: who stands where, in every group that it can be filtered by.

use l4d_data::results::Track;
use l4d_data::{Category, Name, Query, Scale, Status, Temporal};
use l4d_score::metrics::QueryTally;
use l4d_score::{Comparison, Estimate, Metrics, Pair};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::masks::{shown_frames, shown_size};
use crate::detail::{Asked, AskedScene, Detail};
use crate::rank::Board;
use crate::row::{BoardRow, Metric};
use crate::statistics::Statistics;

/// What is asked: scenes with their queries, in order.
pub(crate) fn scenes(asked: &Asked) -> Value {
    asked.scenes.iter().map(scene).collect()
}

fn scene(asked: &AskedScene) -> Value {
    let scene = asked.scene;
    let (width, height) = shown_size(scene.size);
    json!({
        "name": scene.name,
        "scale": asked.scale,
        "width": width,
        "height": height,
        "frames": scene.clip,
        "shown": shown_frames(scene),
        "queries": asked.queries.iter().map(|query| question(query)).collect::<Value>(),
    })
}

fn question(query: &Query) -> Value {
    json!({
        "number": query.id.number,
        "text": query.text,
        "categories": query.categories,
        "referents": query.referents,
        "gated": query.temporal == Temporal::While,
        "frames": query.frames,
        "verified": query.status == Status::Verified,
    })
}

/// The metrics, in the order of all columns.
pub(crate) fn metrics() -> Value {
    let metric = |metric: Metric| {
        json!({
            "key": metric.key(),
            "title": metric.title(),
            "about": about(metric),
            "higher": metric.higher_is_better(),
        })
    };
    Metric::ALL.into_iter().map(metric).collect()
}

fn about(metric: Metric) -> &'static str {
    match metric {
        Metric::Miou => "Mean IoU over the frames that show the target, then over queries. The headline.",
        Metric::Macc => {
            "Share of those frames in which prediction and truth share a pixel: kind to large masks."
        }
        Metric::Acc25 => "Share of those frames with IoU above 0.25.",
        Metric::Acc50 => "Share of those frames with IoU above 0.5.",
        Metric::TubeIou => "Intersections over unions, summed over the whole clip: time matters.",
        Metric::Select => "Share of queries whose most-overlapped thing is the one that is meant.",
        Metric::FalsePositiveRate => {
            "Share of frames without a target in which something was marked; lower is better."
        }
    }
}

/// The methods of the board: ranked, then those that are only shown. `details` are those of the first of them.
pub(crate) fn methods(board: &Board, asked: &Asked, details: &[Detail], seed: u64) -> Value {
    let entries: Vec<(Option<usize>, &BoardRow)> = board.rows().collect();
    let reasons: Vec<&[&str]> = board
        .ranked
        .iter()
        .map(|_| [].as_slice())
        .chain(board.unranked.iter().map(|entry| entry.reasons.as_slice()))
        .collect();
    let method = |(index, &(rank, row)): (usize, &(Option<usize>, &BoardRow))| {
        let groups = match details.get(index) {
            Some(detail) => groups(detail, seed),
            None => Map::from_iter([(group_key(None, None), bare(row))]),
        };
        json!({
            "name": row.name,
            "version": row.version,
            "link": link(&row.link),
            "rank": rank,
            "track": row.track,
            "reasons": reasons[index],
            "seconds": row.seconds,
            "queries": row.scores.headline.queries,
            "isDetailed": index < details.len(),
            "groups": groups,
            "scenes": asked.scenes.iter().map(|asked| row.scores.scenes.get(&asked.scene.name).map(values)).collect::<Value>(),
        })
    };
    let methods: Vec<Value> = entries.par_iter().enumerate().map(method).collect();
    Value::Array(methods)
}

/// Percent, in the order of all metrics.
fn values(metrics: &Metrics) -> Value {
    Metric::ALL.into_iter().map(|metric| metric.of(metrics).map(hundredths)).collect()
}

/// A link is only shown if it leads to the web: a page must not run what a method's card says.
pub(crate) fn link(link: &str) -> Option<&str> {
    (link.starts_with("https://") || link.starts_with("http://")).then_some(link)
}

/// The name of a group of queries: `category|scale`, each empty where all are meant.
pub(crate) fn group_key(category: Option<Category>, scale: Option<Scale>) -> String {
    format!("{}|{}", category.map_or("", Category::as_str), scale.map_or("", Scale::as_str))
}

/// Every group of queries that the page can show: its metrics with intervals. Groups without queries are left out.
fn groups(detail: &Detail, seed: u64) -> Map<String, Value> {
    let categories = || [None].into_iter().chain(Category::ALL.map(Some));
    let scales = || [None].into_iter().chain(Scale::ALL.map(Some));
    let mut groups = Map::new();
    for (category, scale) in categories().flat_map(|category| scales().map(move |scale| (category, scale))) {
        let belongs = |tally: &&QueryTally| {
            category.is_none_or(|category| tally.facts.categories.contains(&category))
                && scale.is_none_or(|scale| tally.facts.scale == scale)
        };
        let members: Vec<&QueryTally> = detail.tallies.iter().filter(belongs).collect();
        if members.is_empty() {
            continue;
        }
        let cells: Vec<Value> = Metric::ALL
            .into_iter()
            .map(|metric| {
                let estimate =
                    Estimate::of_ratio(members.iter().copied(), |ratios| metric.of_ratios(ratios), seed);
                estimate.as_ref().map_or(Value::Null, cell)
            })
            .collect();
        groups.insert(group_key(category, scale), Value::Array(cells));
    }
    groups
}

/// `[value, low, high, queries, scenes]` in percent; low and high are null where one scene says nothing of others.
pub(crate) fn cell(estimate: &Estimate) -> Value {
    let [low, high] = estimate.interval.map_or([None; 2], |interval| interval.map(Some));
    json!([
        hundredths(estimate.value),
        low.map(hundredths),
        high.map(hundredths),
        estimate.queries,
        estimate.scenes
    ])
}

/// The numbers of a row without intervals.
fn bare(row: &BoardRow) -> Value {
    let queries = row.scores.headline.queries;
    let cell = |metric: Metric| {
        let value = metric.of(&row.scores.headline)?;
        Some(json!([hundredths(value), null, null, queries, null]))
    };
    Metric::ALL.into_iter().map(cell).collect()
}

/// The digits that tables print.
pub(crate) fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// The tracks, the headline first.
pub(crate) fn tracks() -> Value {
    Track::ALL.into_iter().map(|track| json!({ "key": track, "title": track.title() })).collect()
}

/// How each method compares with each behind it in its track, in mIoU.
pub(crate) fn comparisons(statistics: &Statistics) -> Value {
    let name = |index: usize| &statistics.methods[index].name;
    let pair = |pair: &Pair| {
        let Comparison { difference, p, least_p, detectable } = &pair.comparison;
        json!({
            "a": name(pair.first),
            "b": name(pair.second),
            "gain": cell(difference),
            "p": p,
            "holm": pair.holm_p,
            "detectable": detectable.map(hundredths),
            "leastP": least_p,
        })
    };
    let pairs = statistics.headline();
    let is_compared = |index: &usize| pairs.iter().any(|pair| pair.first == *index || pair.second == *index);
    let names: Vec<&Name> = (0..statistics.methods.len()).filter(is_compared).map(name).collect();
    json!({ "names": names, "pairs": pairs.iter().map(pair).collect::<Value>() })
}

/// Methods that were scored on something else: one board each, numbers alone.
pub(crate) fn others(board: &Board) -> Value {
    let other = |other: &crate::rank::OtherBoard| {
        let method = |row: &BoardRow| {
            json!({
                "name": row.name,
                "version": row.version,
                "link": link(&row.link),
                "rank": null,
                "track": row.track,
                "reasons": ["scored on something else"],
                "seconds": row.seconds,
                "queries": row.scores.headline.queries,
                "isDetailed": false,
                "groups": { "|": bare(row) },
            })
        };
        json!({
            "line": other.line(),
            "protocol": other.protocol,
            "profile": other.profile,
            "methods": other.rows.iter().map(method).collect::<Value>(),
        })
    };
    board.others.iter().map(other).collect()
}
