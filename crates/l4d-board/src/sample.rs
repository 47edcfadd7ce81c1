//! Made-up boards for tests.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Benchmark, Category, Name, Profile, Report, Scale};
use l4d_score::counts::{FrameCount, State};
use l4d_score::groups::Kind;
use l4d_score::protocols::{Judged, Row, Sheet, Value};
use l4d_score::{
    Average, Breakdown, Comparison, Estimate, Estimates, Exam, Group, Metrics, Options, Pair, Protocol,
    QuerySet,
};

use crate::detail::{self, Asked, Details};
use crate::protocols::{ProtocolRow, ProtocolTable, by_scene, numbers};
use crate::rank::Board;
use crate::row::{BoardRow, Heading, Metric};
use crate::statistics::{Comparisons, MethodGroups, Statistics};

pub(crate) fn heading(queries: usize, verified: usize) -> Heading {
    Heading {
        benchmark: "Panoptic-L4D".to_owned(),
        version: "1.0.0".to_owned(),
        truth_digest: "3f2a91c0".to_owned(),
        protocol: "l4d".to_owned(),
        profile: Profile::Small,
        queries,
        scenes: 21,
        verified,
        rejected: 0,
    }
}

/// A row with one number everywhere.
pub(crate) fn row(name: &str, queries: usize, value: f64) -> BoardRow {
    let all = |queries| Metrics {
        queries,
        miou: Some(value),
        macc: Some(value),
        acc25: Some(value),
        acc50: Some(value),
        tube_iou: Some(value),
        select: Some(value),
        false_positive_rate: Some(100.0 - value),
    };
    BoardRow {
        name: Name::new(name).unwrap(),
        version: "0.1".to_owned(),
        link: String::new(),
        profile: Profile::Small,
        protocol: "l4d".to_owned(),
        benchmark_version: "1.0.0".to_owned(),
        truth_digest: "3f2a91c0".to_owned(),
        track: Track::Colour,
        unranked_because: Vec::new(),
        partial: false,
        seconds: None,
        asked: queries,
        scores: Breakdown {
            headline: all(queries),
            categories: Category::ALL.map(|key| (key, all(queries / 4))).into(),
            scales: Scale::ALL.map(|key| (key, all(queries / 3))).into(),
            scenes: BTreeMap::from([(Name::new("room_living_cats").unwrap(), all(queries))]),
            averages: BTreeMap::from([(Average::Micro, all(queries))]),
        },
        miou: Some(Estimate {
            value,
            standard_error: Some(2.0),
            interval: Some([(value - 4.5).max(0.0), (value + 4.0).min(100.0)]),
            queries,
            scenes: 21,
        }),
        reported: BTreeMap::new(),
        frames: (0..=96).step_by(2).map(|frame| (frame, value)).collect(),
    }
}

/// Nothing known query by query.
pub(crate) fn details() -> Details<'static> {
    Details { asked: Asked { scenes: Vec::new() }, methods: Vec::new() }
}

/// Two methods under a protocol, two queries of two scenes.
pub(crate) fn protocol() -> ProtocolTable {
    let row = |(name, remarks): (&str, &[&'static str])| {
        let value = |mean| Some(Value { mean, frames: 3 });
        let judged = |mean| Judged::new([value(mean), None]).leaving_out("are dropped", 4);
        let rows = [("room_living_cats/001", 0.75), ("outdoor_dog_park/001", 0.25)]
            .map(|(id, mean)| Row { id: id.parse().unwrap(), judged: judged(mean) });
        let sheet = Sheet::new(Protocol::LangSplat, Name::new(name).unwrap(), rows.into(), false);
        ProtocolRow {
            name: sheet.method.clone(),
            version: "1".to_owned(),
            link: "javascript:alert(1)".to_owned(),
            remarks: remarks.to_vec(),
            numbers: numbers(&sheet),
            scenes: by_scene(&sheet),
            queries: sheet.queries(),
            left_out: sheet.left_out.clone(),
            sheet: Some(sheet),
        }
    };
    let rows = [("alpha", [].as_slice()), ("b_b", &["baseline"])].map(row);
    ProtocolTable { protocol: Protocol::LangSplat, rows: rows.into() }
}

/// The shipped queries, of these scenes or of all.
pub(crate) fn exam(scenes: &[&str]) -> Exam {
    let bench = Benchmark::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark")).unwrap();
    let wanted: Vec<String> = scenes.iter().map(|&scene| scene.to_owned()).collect();
    Exam::open(bench, Profile::Tiny, QuerySet::Queries, &wanted, &mut Report::default()).unwrap()
}

/// Made-up answers of every method of a board to the queries of an exam: each takes another thing of the scene now and
/// then, marks nothing, or overlaps a share of what is meant.
pub(crate) fn details_on<'a>(exam: &'a Exam, board: &Board) -> Details<'a> {
    let options = Options::default();
    let asked = Asked::of(exam, &options);
    let mut methods = Vec::new();
    for (place, (_, row)) in board.rows().enumerate() {
        let mut counts = Vec::new();
        for scene in &asked.scenes {
            for (index, query) in scene.queries.iter().enumerate() {
                let turn = index * 7 + place * 3;
                let taken = match turn % 5 {
                    0 => Some(scene.things[turn % scene.things.len()].name.clone()),
                    1 => None,
                    _ => Some(query.referents[0].clone()),
                };
                let is_meant = taken.as_ref() == query.referents.first();
                for &frame in &exam.clip {
                    let is_there = query.frames.iter().any(|interval| interval.contains(frame));
                    let (truth, predicted) =
                        (if is_there { 100 } else { 0 }, if taken.is_some() { 100 } else { 0 });
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
        }
        methods.push(detail::derive(&row.name, options, counts, &asked));
    }
    Details { asked, methods }
}

/// Two tied methods, a third, an oracle, a partial one, and one of another profile; four queries.
pub(crate) fn hand_made() -> Board {
    let mut alpha = row("alpha", 4, 62.5);
    alpha.link = "https://example.org/alpha".to_owned();
    alpha.link.clear();
    alpha.seconds = Some(12.34);
    let mut beta = row("beta", 4, 62.5);
    beta.scores.headline.macc = Some(75.0);
    let mut gamma = row("gamma", 4, 50.0);
    gamma.scores.headline.select = None;
    gamma.scores.categories.remove(&Category::Spatial);
    let mut oracle = row("oracle", 4, 100.0);
    oracle.unranked_because = vec!["baseline", "used ground truth"];
    let partial = row("half", 2, 80.0);
    let mut foreign = row("elsewhere", 4, 99.0);
    foreign.profile = Profile::Tiny;
    Board::new(heading(4, 1), vec![gamma, foreign, beta, partial, oracle, alpha]).unwrap()
}

/// Two methods of either track, those that learned from depth ahead in every number, and an oracle.
pub(crate) fn tracks() -> Board {
    let mut rows = Vec::new();
    for (name, value, track) in [
        ("dim", 30.0, Track::Colour),
        ("deep", 90.0, Track::ColourDepth),
        ("bright", 40.0, Track::Colour),
        ("deeper", 95.0, Track::ColourDepth),
    ] {
        let seconds = Some(100.0 + value);
        rows.push(BoardRow { track, seconds, ..row(name, 4, value) });
    }
    rows.push(BoardRow { unranked_because: vec!["baseline"], ..row("oracle", 4, 100.0) });
    Board::new(heading(4, 0), rows).unwrap()
}

/// The baselines as they come out in truth, and `methods` made-up methods.
pub(crate) fn board(methods: usize) -> Board {
    let mut rows = Vec::new();
    let names = [
        "panopticquery",
        "panopticquery-fast",
        "4dlangsplat",
        "langsplat-per-frame",
        "feature4x",
        "sam2-track",
    ];
    for index in 0..methods.saturating_sub(6).max(methods.min(1)) {
        let value = 71.3 * 0.9_f64.powi(index as i32);
        let name = names.get(index).map_or_else(|| format!("method-{index}"), |&name| name.to_owned());
        let mut row = varied(&name, value, index as f64);
        row.scores.headline.tube_iou = Some((value - 6.0 - 2.0 * index as f64).max(0.0));
        row.scores.headline.select = Some((value + 8.0 - 3.0 * index as f64).max(0.0));
        row.seconds = Some(120.0 * (index + 1) as f64);
        rows.push(row);
    }
    let baselines = [
        ("oracle", 100.0, 100.0, 100.0),
        ("time-agnostic", 100.0, 58.4, 100.0),
        ("look-alike-union", 47.9, 31.0, 2.0),
        ("random-look-alike", 33.1, 24.2, 34.6),
        ("all", 2.4, 2.1, 0.0),
        ("none", 0.0, 0.0, 0.0),
    ];
    for (name, miou, tube, select) in baselines.into_iter().take(methods.saturating_sub(1)) {
        let mut row = varied(name, miou, 0.0);
        row.unranked_because = vec!["baseline", "used ground truth"];
        row.scores.headline.tube_iou = Some(tube);
        row.scores.headline.select = Some(select);
        rows.push(row);
    }
    Board::new(heading(289, 0), rows).unwrap()
}

/// Names as long as names can be, missing values, an empty category.
pub(crate) fn long_names() -> Board {
    let mut rows = Vec::new();
    for index in 0..12 {
        let name =
            format!("panopticquery-robust-farthest-point-sampling-without-consensus-seed{index:02}-v1.2.3");
        let mut row = varied(&name[..80.min(name.len())], 45.0 + 0.6 * f64::from(index), f64::from(index));
        row.scores.categories.insert(Category::Spatial, Metrics::default());
        rows.push(row);
    }
    rows.push(row(&"x".repeat(80), 289, 100.0));
    rows.push(row("none", 289, 0.0));
    Board::new(heading(289, 289), rows).unwrap()
}

/// What could be said of a board whose standard errors are all 2, by 21 scenes.
pub(crate) fn statistics(board: &Board) -> Statistics {
    let estimate = |value: f64, queries| Estimate {
        value,
        standard_error: Some(2.0),
        interval: Some([value - 4.5, value + 4.5]),
        queries,
        scenes: 21,
    };
    let percent =
        |value: Option<f64>, queries| value.map(|value| estimate(value, queries).within(0.0, 100.0));
    let group = |kind: Kind, name: &str, found: &Metrics| Group {
        kind,
        name: name.to_owned(),
        queries: found.queries,
        scenes: 21,
        few_scenes: false,
        estimates: Estimates {
            miou: percent(found.miou, found.queries),
            macc: percent(found.macc, found.queries),
            tube_iou: percent(found.tube_iou, found.queries),
            ..Estimates::default()
        },
    };
    let groups = |row: &BoardRow| {
        let mut groups = vec![group(Kind::All, "all", &row.scores.headline)];
        for (category, found) in &row.scores.categories {
            groups.push(group(Kind::Category, category.as_str(), found));
        }
        for (scale, found) in &row.scores.scales {
            groups.push(group(Kind::Scale, scale.as_str(), found));
            for category in row.scores.categories.keys() {
                let name = format!("{} {}", scale.as_str(), category.as_str());
                groups.push(group(Kind::ScaleCategory, &name, found));
            }
        }
        for name in ["whole", "while"] {
            groups.push(group(Kind::Temporal, name, &row.scores.headline));
        }
        groups
    };
    let rows: Vec<&BoardRow> = board.rows().map(|(_, row)| row).collect();
    let complete = |index: &usize| rows[*index].is_complete(&board.heading);
    let value = |index: usize| rows[index].scores.headline.miou.unwrap_or_default();
    let is_alike = |first: usize, second: usize| rows[first].track == rows[second].track;
    let compare = |first: usize, second: usize| {
        let difference = estimate(value(first) - value(second), 4).within(-100.0, 100.0);
        let p = if difference.value.abs() < 4.5 { 1.0 } else { 0.000_5 };
        let comparison = Comparison { difference, p, least_p: 1e-6, detectable: Some(6.2) };
        Pair { first, second, comparison, holm_p: p }
    };
    let pairs = (0..rows.len()).filter(complete).flat_map(|first| {
        let others = (first + 1..rows.len()).filter(complete).filter(|&second| is_alike(first, second));
        others.map(|second| compare(first, second)).collect::<Vec<_>>()
    });
    Statistics {
        methods: rows
            .iter()
            .map(|row| MethodGroups { name: row.name.clone(), groups: groups(row) })
            .collect(),
        comparisons: vec![Comparisons { metric: Metric::Miou, pairs: pairs.collect() }],
        left_out: 0,
    }
}

fn varied(name: &str, value: f64, phase: f64) -> BoardRow {
    let mut row = row(name, 289, value);
    let spread = if value == 0.0 || value == 100.0 { 0.0 } else { 9.0 };
    let wobble = |at: f64| (value + spread * (at * 1.7 + phase).sin()).clamp(0.0, 100.0);
    let queries = [
        (Category::Attribute, 100),
        (Category::Action, 61),
        (Category::Spatial, 72),
        (Category::Interaction, 56),
    ];
    for (index, (category, count)) in queries.into_iter().enumerate() {
        let metrics = row.scores.categories.get_mut(&category).unwrap();
        metrics.queries = count;
        metrics.miou = Some(wobble(index as f64));
    }
    for (index, (scale, count)) in
        [(Scale::Outdoor, 110), (Scale::Room, 83), (Scale::Tabletop, 96)].into_iter().enumerate()
    {
        let metrics = row.scores.scales.get_mut(&scale).unwrap();
        metrics.queries = count;
        metrics.miou = Some(wobble(index as f64 + 4.0));
    }
    for (&frame, value) in &mut row.frames {
        *value = wobble(f64::from(frame) / 9.0);
    }
    row
}
