//! Made-up boards for tests.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Benchmark, Category, Name, Profile, Report, Scale};
use l4d_score::counts::{FrameCount, State, by_query};
use l4d_score::metrics::PerMetric;
use l4d_score::protocols::{LeftOut, Protocol};
use l4d_score::{
    Average, Breakdown, Comparison, Estimate, EvalSet, Group, GroupKind, Metric, Metrics, Options, Pair,
    QuerySet,
};

use crate::board::{
    Board, BoardScene, Comparisons, Heading, Method, PublishedRow, PublishedTable, SCHEMA, ScoredOn,
};
use crate::gather::{Source, board_scene, fill};
use crate::protocols::{ProtocolRow, ProtocolTable};
use crate::ranking::arrange;

pub(crate) fn heading(queries: usize, verified: usize) -> Heading {
    Heading { benchmark: "Panoptic-L4D".to_owned(), on: on(), queries, scenes: 21, verified, rejected: 0 }
}

fn on() -> ScoredOn {
    ScoredOn {
        profile: Profile::Small,
        protocol: "l4d".to_owned(),
        benchmark_version: "1.0.0".to_owned(),
        truth_digest: "3f2a91c0".to_owned(),
    }
}

/// Of 21 scenes, with a standard error of 2.
fn estimate(value: f64, [below, above]: [f64; 2], queries: usize) -> Estimate {
    let interval = Some([value - below, value + above]);
    Estimate { value, standard_error: Some(2.0), interval, queries, scenes: 21 }
}

/// A method with one number everywhere.
pub(crate) fn method(name: &str, queries: usize, value: f64) -> Method {
    let all = |queries| Metrics {
        percent: PerMetric::of(|metric| Some(if metric.higher_is_better() { value } else { 100.0 - value })),
        queries,
    };
    Method {
        name: Name::new(name).unwrap(),
        version: "0.1".to_owned(),
        link: String::new(),
        on: on(),
        track: Track::Colour,
        rank: None,
        unranked_because: Vec::new(),
        partial: false,
        seconds: None,
        asked: queries,
        resize: false,
        scores: Breakdown {
            headline: all(queries),
            categories: Category::ALL.map(|key| (key, all(queries / 4))).into(),
            scales: Scale::ALL.map(|key| (key, all(queries / 3))).into(),
            scenes: BTreeMap::from([(Name::new("room_living_cats").unwrap(), all(queries))]),
            averages: BTreeMap::from([(Average::Micro, all(queries))]),
        },
        miou: Some(estimate(value, [4.5, 4.0], queries).within(0.0, 100.0)),
        reported: BTreeMap::new(),
        groups: Vec::new(),
        iou_of_frames: (0..=96).step_by(2).map(|frame| (frame, value)).collect(),
        answers: Vec::new(),
        choices: BTreeMap::new(),
    }
}

/// A board with groups and comparisons as if all standard errors were 2.
pub(crate) fn board_of(queries: usize, methods: Vec<Method>) -> Board {
    let heading = heading(queries, 0);
    let (mut methods, _) = arrange(&heading, methods).unwrap();
    for method in &mut methods {
        method.groups = groups(method);
    }
    let comparisons = vec![Comparisons { metric: Metric::Miou, pairs: pairs(&heading, &methods) }];
    let schema = SCHEMA.to_owned();
    let published = vec![published("panoptic_l4d"), published("scales"), published("composites")];
    let (scenes, protocols) = (Vec::new(), Vec::new());
    Board { schema, heading, methods, comparisons, scenes, protocols, published, day: None }
}

fn groups(method: &Method) -> Vec<Group> {
    let group = |kind: GroupKind, name: &str, found: &Metrics| Group {
        kind,
        name: name.to_owned(),
        queries: found.queries,
        scenes: 21,
        few_scenes: false,
        estimates: PerMetric::of(|metric| {
            let value = [Metric::Miou, Metric::Macc, Metric::TubeIou, Metric::Select]
                .contains(&metric)
                .then(|| found.get(metric))??;
            Some(estimate(value, [4.5, 4.5], found.queries).within(0.0, 100.0))
        }),
    };
    let scores = &method.scores;
    let mut groups = vec![group(GroupKind::All, "all", &scores.headline)];
    groups
        .extend(scores.categories.iter().map(|(key, found)| group(GroupKind::Category, key.as_str(), found)));
    for (scale, found) in &scores.scales {
        groups.push(group(GroupKind::Scale, scale.as_str(), found));
        groups.extend(scores.categories.keys().map(|category| {
            group(GroupKind::ScaleCategory, &format!("{} {}", scale.as_str(), category.as_str()), found)
        }));
    }
    groups.extend(["whole", "while"].map(|name| group(GroupKind::Temporal, name, &scores.headline)));
    groups
}

fn pairs(heading: &Heading, methods: &[Method]) -> Vec<Pair> {
    let mut pairs = Vec::new();
    let value = |index: usize| methods[index].headline(Metric::Miou).unwrap_or_default();
    for first in 0..methods.len() {
        for second in first + 1..methods.len() {
            let are_complete = [first, second].iter().all(|&index| methods[index].is_complete(heading));
            if are_complete && methods[first].track == methods[second].track {
                let difference = estimate(value(first) - value(second), [4.5, 4.5], 4).within(-100.0, 100.0);
                let p = if difference.value.abs() < 4.5 { 1.0 } else { 0.000_5 };
                let comparison = Comparison { difference, p, least_p: 1e-6, detectable: Some(6.2) };
                pairs.push(Pair { first, second, comparison, holm_p: p });
            }
        }
    }
    pairs
}

/// A table of a paper with one row.
fn published(name: &str) -> PublishedTable {
    let columns = match name {
        "composites" => vec!["spatial+action".to_owned()],
        _ => Category::ALL.map(|category| category.as_str().to_owned()).to_vec(),
    };
    let values = vec![[Some(47.79), Some(28.81)]; columns.len()];
    let rows = vec![PublishedRow { setting: "LangSplat".to_owned(), values }];
    PublishedTable { name: name.to_owned(), columns, rows }
}

/// Two methods under a protocol.
pub(crate) fn protocol() -> ProtocolTable {
    let row = |(name, remarks): (&str, &[&str])| ProtocolRow {
        name: Name::new(name).unwrap(),
        version: "1".to_owned(),
        link: "javascript:alert(1)".to_owned(),
        remarks: remarks.iter().map(|remark| (*remark).to_owned()).collect(),
        numbers: vec![Some(50.0), None],
        scenes: BTreeMap::from([(Name::new("room_living_cats").unwrap(), vec![Some(75.0), None])]),
        queries: 2,
        left_out: vec![LeftOut { what: "are dropped".into(), queries: 2, frames: 8 }],
        groups: BTreeMap::new(),
        values: BTreeMap::new(),
    };
    let rows = [("alpha", [].as_slice()), ("b_b", &["baseline"])].map(row);
    ProtocolTable { protocol: Protocol::LangSplat, rows: rows.into() }
}

/// The same board with made-up answers to the shipped queries of a few scenes: each method takes another instance now
/// and then, marks nothing, or overlaps a share of what is meant.
pub(crate) fn answered(mut board: Board) -> Board {
    let bench = Benchmark::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark")).unwrap();
    let wanted = ["room_living_cats", "tabletop_tea", "outdoor_dog_park"].map(str::to_owned);
    let eval_set =
        EvalSet::open(bench, Profile::Tiny, QuerySet::Queries, &wanted, &mut Report::default()).unwrap();
    let options = Options::default();
    let scenes: Vec<BoardScene> = eval_set.scenes.iter().map(|scene| board_scene(scene, &options)).collect();
    for (place, method) in board.methods.iter_mut().enumerate() {
        let counts = scenes.iter().flat_map(|scene| made_up(scene, place)).map(Ok);
        let scores = std::path::Path::new("scores");
        let source = Source { scores, eval_set: &eval_set, scenes: &scenes, seed: 0, options };
        fill(method, source.counted(by_query(counts), true).unwrap().answers);
    }
    board.scenes = scenes;
    board
}

fn made_up(scene: &BoardScene, place: usize) -> Vec<FrameCount> {
    let mut counts = Vec::new();
    for (index, query) in scene.queries.iter().enumerate() {
        let turn = index * 7 + place * 3;
        let taken = match turn % 5 {
            0 => Some(scene.things[turn % scene.things.len()].name.clone()),
            1 => None,
            _ => Some(query.referents[0].clone()),
        };
        let is_meant = taken.as_ref() == query.referents.first();
        for &frame in &scene.clip {
            let is_there = query.frames.iter().any(|interval| interval.contains(frame));
            let (truth, predicted) = (100 * u64::from(is_there), 100 * u64::from(taken.is_some()));
            let overlap = 20 * ((turn as u64 + u64::from(frame)) % 6);
            let intersection = if is_meant { overlap.min(truth) } else { 0 };
            let state = match (truth > 0, predicted > 0) {
                (true, _) if intersection > 0 => State::Hit,
                (true, _) => State::Miss,
                (false, true) => State::FalseAlarm,
                (false, false) => State::TrueAbsent,
            };
            counts.push(FrameCount {
                query: query.id.clone(),
                frame,
                state,
                intersection,
                union: truth + predicted - intersection,
                predicted,
                truth,
                instance: taken.clone(),
                instance_overlap: if is_meant { intersection } else { overlap },
            });
        }
    }
    counts
}

/// Two tied methods, a third, an oracle, a partial one, and one of another profile; four queries.
pub(crate) fn hand_made() -> Board {
    let mut alpha = method("alpha", 4, 62.5);
    alpha.link = "https://example.org/alpha".to_owned();
    alpha.seconds = Some(12.34);
    let mut beta = method("beta", 4, 62.5);
    beta.scores.headline.percent.macc = Some(75.0);
    let mut gamma = method("gamma", 4, 50.0);
    gamma.scores.headline.percent.select = None;
    gamma.scores.categories.remove(&Category::Spatial);
    let mut oracle = method("oracle", 4, 100.0);
    oracle.unranked_because = ["baseline", "used ground truth"].map(str::to_owned).to_vec();
    let partial = method("half", 2, 80.0);
    let mut foreign = method("elsewhere", 4, 99.0);
    foreign.on.profile = Profile::Tiny;
    let mut board = board_of(4, vec![gamma, foreign, beta, partial, oracle, alpha]);
    board.heading.verified = 1;
    board.protocols = vec![protocol()];
    board
}

/// Two methods of either track, those that learned from depth ahead in every number, and an oracle.
pub(crate) fn tracks() -> Board {
    let mut methods = Vec::new();
    for (name, value, track) in [
        ("dim", 30.0, Track::Colour),
        ("deep", 90.0, Track::ColourDepth),
        ("bright", 40.0, Track::Colour),
        ("deeper", 95.0, Track::ColourDepth),
    ] {
        methods.push(Method { track, seconds: Some(100.0 + value), ..method(name, 4, value) });
    }
    methods.push(Method { unranked_because: vec!["baseline".to_owned()], ..method("oracle", 4, 100.0) });
    board_of(4, methods)
}

/// The baselines as they come out in truth, and made-up methods.
pub(crate) fn board(count: usize) -> Board {
    let names = ["panopticquery", "panopticquery-fast", "4dlangsplat", "langsplat-per-frame"];
    let mut methods = Vec::new();
    for index in 0..count.saturating_sub(6).max(count.min(1)) {
        let value = 71.3 * 0.9_f64.powi(index as i32);
        let name = names.get(index).map_or_else(|| format!("method-{index}"), |&name| name.to_owned());
        let mut method = varied(&name, value, index as f64);
        method.scores.headline.percent.tube_iou = Some((value - 6.0 - 2.0 * index as f64).max(0.0));
        method.scores.headline.percent.select = Some((value + 8.0 - 3.0 * index as f64).max(0.0));
        method.seconds = Some(120.0 * (index + 1) as f64);
        methods.push(method);
    }
    let baselines = [
        ("oracle", 100.0, 100.0, 100.0),
        ("time-agnostic", 100.0, 58.4, 100.0),
        ("look-alike-union", 47.9, 31.0, 2.0),
        ("random-look-alike", 33.1, 24.2, 34.6),
        ("all", 2.4, 2.1, 0.0),
        ("none", 0.0, 0.0, 0.0),
    ];
    for (name, miou, tube, select) in baselines.into_iter().take(count.saturating_sub(1)) {
        let mut method = varied(name, miou, 0.0);
        method.unranked_because = ["baseline", "used ground truth"].map(str::to_owned).to_vec();
        method.scores.headline.percent.tube_iou = Some(tube);
        method.scores.headline.percent.select = Some(select);
        methods.push(method);
    }
    board_of(289, methods)
}

/// Names as long as names can be, missing values, an empty category.
pub(crate) fn long_names() -> Board {
    let mut methods = Vec::new();
    for index in 0..12 {
        let name =
            format!("panopticquery-robust-farthest-point-sampling-without-consensus-seed{index:02}-v1.2.3");
        let mut method = varied(&name[..80.min(name.len())], 45.0 + 0.6 * f64::from(index), f64::from(index));
        method.scores.categories.insert(Category::Spatial, Metrics::default());
        methods.push(method);
    }
    methods.push(method(&"x".repeat(80), 289, 100.0));
    methods.push(method("none", 289, 0.0));
    board_of(289, methods)
}

fn varied(name: &str, value: f64, phase: f64) -> Method {
    let mut method = method(name, 289, value);
    let spread = if value == 0.0 || value == 100.0 { 0.0 } else { 9.0 };
    let wobble = |at: f64| (value + spread * (at * 1.7 + phase).sin()).clamp(0.0, 100.0);
    let categories = method.scores.categories.values_mut();
    for (at, metrics) in categories.chain(method.scores.scales.values_mut()).enumerate() {
        metrics.percent.miou = Some(wobble(at as f64));
    }
    for (&frame, value) in &mut method.iou_of_frames {
        *value = wobble(f64::from(frame) / 9.0);
    }
    method
}
