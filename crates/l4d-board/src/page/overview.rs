//! What the page knows when it opens: the order of methods, in every group that it can be filtered by.

use l4d_data::results::Track;
use l4d_data::{Category, Scale, Temporal};
use l4d_score::cluster::FEW_SCENES;
use l4d_score::protocols::Measure;
use l4d_score::{Comparison, Estimate, GroupKind, Metric, Metrics, Pair};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use serde_json::{Map, Value, json};

use super::masks::{shown_frames, shown_size};
use crate::board::{Board, BoardQuery, BoardScene, Method, PublishedRow, PublishedTable};
use crate::protocols::{ProtocolRow, ProtocolTable, group_filters, group_key};

/// The first element of data. Keys are those of the scripts. Methods and scenes, which may be many, become values one
/// after another.
pub(crate) struct Overview<'a>(pub(crate) &'a Board);

impl Serialize for Overview<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let board = self.0;
        let heading = &board.heading;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("software", env!("CARGO_PKG_VERSION"))?;
        map.serialize_entry("day", &board.day)?;
        map.serialize_entry("benchmark", &heading.benchmark)?;
        map.serialize_entry("version", &heading.on.benchmark_version)?;
        map.serialize_entry("truthDigest", &heading.on.truth_digest)?;
        map.serialize_entry("protocol", &heading.on.protocol)?;
        map.serialize_entry("profile", &heading.on.profile)?;
        map.serialize_entry("queries", &heading.queries)?;
        map.serialize_entry("sceneCount", &heading.scenes)?;
        map.serialize_entry("verified", &heading.verified)?;
        map.serialize_entry("rejected", &heading.rejected)?;
        map.serialize_entry("line", &heading.line())?;
        map.serialize_entry("metrics", &list(|| Metric::ALL.into_iter().map(metric)))?;
        map.serialize_entry("tracks", &list(|| Track::ALL.into_iter().map(track)))?;
        map.serialize_entry("fewScenes", &FEW_SCENES)?;
        map.serialize_entry("methods", &list(|| board.methods.iter().map(|one| method(board, one))))?;
        map.serialize_entry("comparisons", &comparisons(board))?;
        map.serialize_entry(
            "protocols",
            &list(|| board.protocols.iter().map(|table| protocol(board, table))),
        )?;
        map.serialize_entry("scenes", &list(|| board.scenes.iter().map(scene)))?;
        map.serialize_entry("published", &list(|| board.published.iter().map(published)))?;
        map.end()
    }
}

/// A list whose members are made as they are written.
struct List<F>(F);

fn list<I: Iterator<Item: Serialize>, F: Fn() -> I>(members: F) -> List<F> {
    List(members)
}

impl<I: Iterator<Item: Serialize>, F: Fn() -> I> Serialize for List<F> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq((self.0)())
    }
}

fn track(track: Track) -> Value {
    json!({ "key": track, "title": track.title() })
}

fn metric(metric: Metric) -> Value {
    json!({
        "key": metric.key(),
        "title": metric.title(),
        "about": metric.about(),
        "higher": metric.higher_is_better(),
    })
}

fn method(board: &Board, method: &Method) -> Value {
    let is_detailed = !method.answers.is_empty();
    let groups = match is_detailed {
        true => groups(method),
        false => Map::from_iter([(group_key(None, None), bare(method))]),
    };
    json!({
        "name": method.name,
        "version": method.version,
        "link": link(&method.link),
        "rank": method.rank,
        "track": method.track,
        "reasons": method.unranked_because,
        "seconds": method.seconds,
        "queries": method.scores.headline.queries,
        "isDetailed": is_detailed,
        "groups": groups,
        "scenes": board.scenes.iter().map(|scene| method.scores.scenes.get(&scene.name).map(values)).collect::<Value>(),
    })
}

/// Percent, in the order of all metrics.
fn values(metrics: &Metrics) -> Value {
    Metric::ALL.into_iter().map(|metric| metrics.get(metric).map(hundredths)).collect()
}

/// A link is only shown if it leads to the web: a page must not run what a method's card says.
fn link(link: &str) -> Option<&str> {
    (link.starts_with("https://") || link.starts_with("http://")).then_some(link)
}

/// Every group of queries that the page filters by: its metrics with intervals. Groups without queries are left out.
fn groups(method: &Method) -> Map<String, Value> {
    let named = |(category, scale): (Option<Category>, Option<Scale>)| match (category, scale) {
        (None, None) => (GroupKind::All, "all".to_owned()),
        (Some(category), None) => (GroupKind::Category, category.as_str().to_owned()),
        (None, Some(scale)) => (GroupKind::Scale, scale.as_str().to_owned()),
        (Some(category), Some(scale)) => {
            (GroupKind::ScaleCategory, format!("{} {}", scale.as_str(), category.as_str()))
        }
    };
    let entry = |filter: (Option<Category>, Option<Scale>)| {
        let (kind, name) = named(filter);
        let estimates = method.group(kind, &name)?.estimates;
        let cells = Metric::ALL.into_iter().map(|metric| estimates.get(metric).as_ref().map(cell));
        Some((group_key(filter.0, filter.1), cells.collect()))
    };
    group_filters().filter_map(entry).collect()
}

/// `[value, low, high, queries, scenes]` in percent; low and high are null where one scene says nothing of others.
fn cell(estimate: &Estimate) -> Value {
    let [low, high] = estimate.interval.map_or([None; 2], |interval| interval.map(Some));
    json!([
        hundredths(estimate.value),
        low.map(hundredths),
        high.map(hundredths),
        estimate.queries,
        estimate.scenes
    ])
}

/// The numbers of a method without intervals.
fn bare(method: &Method) -> Value {
    let queries = method.scores.headline.queries;
    let cell = |metric: Metric| {
        let value = method.headline(metric)?;
        Some(json!([hundredths(value), null, null, queries, null]))
    };
    Metric::ALL.into_iter().map(cell).collect()
}

/// The digits that tables print.
pub(crate) fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// How each method compares with each behind it in its track, in mIoU.
fn comparisons(board: &Board) -> Value {
    let name = |index: usize| &board.methods[index].name;
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
    let pairs = board.headline_pairs();
    let is_compared = |index: &usize| pairs.iter().any(|pair| pair.first == *index || pair.second == *index);
    let names: Vec<_> = (0..board.compared().len()).filter(is_compared).map(name).collect();
    json!({ "names": names, "pairs": pairs.iter().map(pair).collect::<Value>() })
}

fn protocol(board: &Board, table: &ProtocolTable) -> Value {
    let shown =
        |numbers: &Vec<Option<f64>>| numbers.iter().map(|number| number.map(hundredths)).collect::<Value>();
    let method = |row: &ProtocolRow| {
        let mut groups = Map::from_iter([(group_key(None, None), shown(&row.numbers))]);
        let keys = group_filters().map(|(category, scale)| group_key(category, scale));
        groups.extend(keys.filter_map(|key| Some((key.clone(), shown(row.groups.get(&key)?)))));
        json!({
            "name": row.name,
            "version": row.version,
            "link": link(&row.link),
            "rank": null,
            "reasons": row.remarks,
            "queries": row.queries,
            "leftOut": row.left_out,
            "isDetailed": !row.values.is_empty(),
            "groups": groups,
            "scenes": board.scenes.iter().map(|scene| row.scenes.get(&scene.name).map(shown)).collect::<Value>(),
        })
    };
    let measure = |one: &Measure| json!({ "key": one.key, "title": one.title });
    json!({
        "name": table.protocol.as_str(),
        "source": table.protocol.rules().source,
        "remark": table.protocol.rules().remark,
        "line": table.line(&board.heading),
        "measures": table.protocol.rules().measures.iter().map(measure).collect::<Value>(),
        "methods": table.rows.iter().map(method).collect::<Value>(),
    })
}

fn scene(scene: &BoardScene) -> Value {
    let (width, height) = shown_size((scene.width, scene.height));
    json!({
        "name": scene.name,
        "scale": scene.scale,
        "width": width,
        "height": height,
        "frames": scene.clip,
        "shown": shown_frames(scene),
        "queries": scene.queries.iter().map(question).collect::<Value>(),
    })
}

fn question(query: &BoardQuery) -> Value {
    json!({
        "number": query.id.number,
        "text": query.text,
        "categories": query.categories,
        "referents": query.referents,
        "gated": query.temporal == Temporal::While,
        "frames": query.frames,
        "verified": query.verified,
    })
}

/// A table of a paper.
fn published(table: &PublishedTable) -> Value {
    let title = match table.name.as_str() {
        "panoptic_l4d" => "Query types on the authors' Panoptic-L4D",
        "neu3d" => "Query types on Neu3D",
        "composites" => "Queries of two categories",
        "scales" => "Spatial scales, PanopticQuery",
        "mvsc" => "Without and with multi-view semantic consensus",
        "views" => "Number of cameras",
        "vlm" => "Vision-language models",
        name => name,
    };
    let row = |row: &PublishedRow| json!({ "setting": row.setting, "values": row.values.concat() });
    json!({
        "title": title,
        "columns": table.columns,
        "rows": table.rows.iter().map(row).collect::<Value>(),
    })
}
