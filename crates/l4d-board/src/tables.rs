//! Tidy CSV tables, written by polars.
//!
//! One row per method, or per method and group; percentages with four decimals, an empty field where there is no value.
//! Each row repeats what the board is of, so that a row cut out of its file still says what it means.

use l4d_data::Name;
use l4d_data::results::Track;
use l4d_score::cluster::FEW_SCENES;
use l4d_score::{Average, Breakdown, Estimate, Estimates, Group, GroupKind, Metric, Metrics};
use polars::prelude::{Column, CsvWriter, DataFrame, SerWriter as _};

use crate::board::{Answer, Board, BoardQuery, Method};
use crate::error::BoardError;
use crate::layout::{self, Layout, Line};
use crate::protocols::{ProtocolRow, ProtocolTable};

const DECIMALS: usize = 4;

/// Other averages of mIoU beside the headline, which weighs every query the same.
const AVERAGES: [(&str, Average); 3] = [
    ("miou_micro", Average::Micro),
    ("miou_macro_scene", Average::MacroScene),
    ("miou_macro_category", Average::MacroCategory),
];

/// `leaderboard.csv`: one row per method.
pub(crate) fn leaderboard(board: &Board) -> Result<Vec<u8>, BoardError> {
    let methods = &board.methods;
    let mut columns = identity(methods);
    columns.insert(3, text("version", methods, |method| method.version.clone()));
    columns.push(text("unranked_because", methods, Method::why_unranked));
    columns.extend(metrics(methods, |method| &method.scores.headline));
    let end = |end: usize| move |method: &Method| Some(method.miou?.interval?[end]);
    columns.push(numbers("miou_low", methods, end(0)));
    columns.push(numbers("miou_high", methods, end(1)));
    for (name, average) in AVERAGES {
        let miou = |method: &Method| method.scores.averages.get(&average)?.get(Metric::Miou);
        columns.push(numbers(name, methods, miou));
    }
    columns.push(numbers("seconds", methods, |method| method.seconds));
    columns.push(text("link", methods, |method| method.link.clone()));
    csv("leaderboard.csv", board, methods.len(), columns)
}

/// `per_<group>.csv`: one row per method and category, scale or scene.
pub(crate) fn per_group(board: &Board, group: &str) -> Result<Vec<u8>, BoardError> {
    let mut rows: Vec<(&Method, &str, &Metrics)> = Vec::new();
    for method in &board.methods {
        let Breakdown { categories, scales, scenes, .. } = &method.scores;
        match group {
            "category" => rows.extend(categories.iter().map(|(key, found)| (method, key.as_str(), found))),
            "scale" => rows.extend(scales.iter().map(|(key, found)| (method, key.as_str(), found))),
            _ => rows.extend(scenes.iter().map(|(key, found)| (method, key.as_str(), found))),
        }
    }
    let mut columns = identity(rows.iter().map(|(method, ..)| *method));
    columns.push(text(group, &rows, |(_, group, _)| (*group).to_owned()));
    columns.extend(metrics(&rows, |(.., metrics)| metrics));
    csv(&format!("per_{group}.csv"), board, rows.len(), columns)
}

/// `taken.csv`: one row per method and query, with the instance that its prediction overlaps most.
pub(crate) fn taken(board: &Board) -> Result<Vec<u8>, BoardError> {
    let mut rows: Vec<(&Name, &BoardQuery, &Answer, &str)> = Vec::new();
    for method in &board.methods {
        let answers = board.queries().zip(&method.answers);
        rows.extend(
            answers
                .filter_map(|((_, query), answer)| Some((&method.name, query, answer, answer.choice?.key()))),
        );
    }
    let meant =
        |query: &BoardQuery| query.referents.iter().map(|name| name.as_str()).collect::<Vec<_>>().join("+");
    let columns = vec![
        text("method", &rows, |(method, ..)| method.to_string()),
        text("scene", &rows, |(_, query, ..)| query.id.scene.to_string()),
        text("query", &rows, |(_, query, ..)| query.id.number.to_string()),
        text("meant", &rows, |(_, query, ..)| meant(query)),
        text("taken", &rows, |(_, _, answer, _)| {
            answer.taken.as_ref().map(Name::to_string).unwrap_or_default()
        }),
        text("which_is", &rows, |(.., choice)| (*choice).to_owned()),
    ];
    csv("taken.csv", board, rows.len(), columns)
}

/// `groups.csv`: one row per method and group, with standard errors and 95 % intervals.
pub(crate) fn groups(board: &Board) -> Result<Vec<u8>, BoardError> {
    let mut rows: Vec<(&Method, Group)> = Vec::new();
    for method in board.compared() {
        let groups = method.groups.iter().cloned().chain(single_queries(board, method));
        rows.extend(groups.map(|group| (method, group)));
    }
    let mut columns = vec![
        ranks("rank", &rows, |(method, _)| method.rank),
        text("track", &rows, |(method, _)| method.track.as_str().to_owned()),
        text("method", &rows, |(method, _)| method.name.to_string()),
        text("unranked_because", &rows, |(method, _)| method.why_unranked()),
        text("kind", &rows, |(_, group)| group.kind.as_str().to_owned()),
        text("group", &rows, |(_, group)| group.name.clone()),
        counts("queries", &rows, |(_, group)| group.queries),
        counts("scenes", &rows, |(_, group)| group.scenes),
        flags("few_scenes", &rows, |(_, group)| group.few_scenes),
    ];
    for metric in Metric::ALL {
        columns.extend(estimates(metric.key(), &rows, |(_, group)| group.estimates.get(metric)));
    }
    csv("groups.csv", board, rows.len(), columns)
}

/// Each query as a group of its own, by scene, then id.
fn single_queries(board: &Board, method: &Method) -> Vec<Group> {
    let estimate = |ratio: f64| Estimate {
        value: 100.0 * ratio,
        standard_error: None,
        interval: None,
        queries: 1,
        scenes: 1,
    };
    let group = |((_, query), answer): ((_, &BoardQuery), &Answer)| {
        let counted = usize::from(answer.choice.is_some());
        Group {
            kind: GroupKind::Query,
            name: query.id.to_string(),
            queries: counted,
            scenes: counted,
            few_scenes: counted < FEW_SCENES,
            estimates: Estimates::of(|metric| answer.ratios.get(metric).map(estimate)),
        }
    };
    let mut groups: Vec<Group> = board.queries().zip(&method.answers).map(group).collect();
    let scene = |name: &str| {
        let scene = name.split('/').next().unwrap_or_default();
        board.scenes.iter().position(|other| other.name.as_str() == scene)
    };
    groups.sort_by(|a, b| (scene(&a.name), &a.name).cmp(&(scene(&b.name), &b.name)));
    groups
}

/// `comparisons.csv`: one row per metric and pair of methods.
pub(crate) fn comparisons(board: &Board) -> Result<Vec<u8>, BoardError> {
    let pairs: Vec<_> = board
        .comparisons
        .iter()
        .flat_map(|found| found.pairs.iter().map(move |pair| (found.metric, pair)))
        .collect();
    let method = |index: usize| &board.methods[index];
    let mut columns = vec![
        text("metric", &pairs, |(metric, _)| metric.key().to_owned()),
        text("track", &pairs, |(_, pair)| method(pair.first).track.as_str().to_owned()),
        ranks("first_rank", &pairs, |(_, pair)| method(pair.first).rank),
        text("first", &pairs, |(_, pair)| method(pair.first).name.to_string()),
        ranks("second_rank", &pairs, |(_, pair)| method(pair.second).rank),
        text("second", &pairs, |(_, pair)| method(pair.second).name.to_string()),
        counts("queries", &pairs, |(_, pair)| pair.comparison.difference.queries),
        counts("scenes", &pairs, |(_, pair)| pair.comparison.difference.scenes),
        flags("few_scenes", &pairs, |(_, pair)| pair.comparison.difference.is_of_few_scenes()),
    ];
    columns.extend(estimates("difference", &pairs, |(_, pair)| Some(pair.comparison.difference)));
    columns.push(text("p", &pairs, |(_, pair)| p_text(pair.comparison.p)));
    columns.push(text("holm_p", &pairs, |(_, pair)| p_text(pair.holm_p)));
    columns.push(flags("different", &pairs, |(_, pair)| pair.is_different()));
    columns.push(numbers("detectable", &pairs, |(_, pair)| pair.comparison.detectable));
    columns.push(text("least_p", &pairs, |(_, pair)| p_text(pair.comparison.least_p)));
    csv("comparisons.csv", board, pairs.len(), columns)
}

/// A p value with as many digits as say something.
pub(crate) fn p_text(p: f64) -> String {
    if p < 0.001 { format!("{p:.1e}") } else { format!("{p:.4}") }
}

/// `reported.csv`: one row per method and number that it reports of itself, with the same of our counts where it is one
/// of ours.
pub(crate) fn reported(board: &Board) -> Result<Vec<u8>, BoardError> {
    let rows = reported_numbers(board);
    let columns = vec![
        text("method", &rows, |row| row.method.to_string()),
        text("number", &rows, |row| row.number.to_owned()),
        numbers("reported", &rows, |row| Some(row.reported)),
        numbers("recomputed", &rows, |row| row.recomputed),
        numbers("difference", &rows, |row| Some(row.reported - row.recomputed?)),
    ];
    csv("reported.csv", board, rows.len(), columns)
}

/// A number that a method reports of itself.
pub(crate) struct Reported<'a> {
    pub(crate) method: &'a Name,
    /// As the method calls it.
    pub(crate) number: &'a str,
    pub(crate) reported: f64,
    /// The same from `counts.csv`, percent; none for numbers that l4d does not know.
    pub(crate) recomputed: Option<f64>,
}

/// All of them, in the order of the board, then by name.
pub(crate) fn reported_numbers(board: &Board) -> Vec<Reported<'_>> {
    let mut rows = Vec::new();
    for method in &board.methods {
        rows.extend(method.reported.iter().map(|(number, &reported)| Reported {
            method: &method.name,
            number,
            reported,
            recomputed: recomputed(method, number),
        }));
    }
    rows
}

/// `miou`, or a group and a metric: `action miou`, `room macc`, `room_gym tube_iou`.
fn recomputed(method: &Method, number: &str) -> Option<f64> {
    let (group, metric) = number.split_once(' ').unwrap_or(("", number));
    let metric = Metric::ALL.into_iter().find(|known| known.key() == metric)?;
    let scores = &method.scores;
    let category = || scores.categories.iter().find(|(key, _)| key.as_str() == group).map(|(_, found)| found);
    let scale = || scores.scales.iter().find(|(key, _)| key.as_str() == group).map(|(_, found)| found);
    match group {
        "" => scores.headline.get(metric),
        _ => category().or_else(scale).or_else(|| scores.scenes.get(group))?.get(metric),
    }
}

/// `tables/<name>.csv`: one row per number of a table in the paper's layout.
pub(crate) fn layout(board: &Board, layout: &Layout) -> Result<Vec<u8>, BoardError> {
    let sources = [("measured", &layout.rows), ("published", &layout.published)];
    let lines = sources.into_iter().flat_map(|(source, lines)| lines.iter().map(move |line| (source, line)));
    let cells: Vec<(&str, &Line, &String, Metric, layout::Cell)> = lines
        .flat_map(|(source, line)| {
            let columns = layout.columns.iter().zip(&line.cells);
            columns.flat_map(move |(column, pair)| {
                let of_metric = layout::METRICS.into_iter().zip(pair);
                of_metric.filter_map(move |(metric, cell)| Some((source, line, column, metric, (*cell)?)))
            })
        })
        .collect();
    let count =
        |which: usize| move |(.., cell): &(_, _, _, _, layout::Cell)| cell.counts.map(|counts| counts[which]);
    let columns = vec![
        text("source", &cells, |(source, ..)| (*source).to_owned()),
        ranks("rank", &cells, |(_, line, ..)| line.rank),
        text("track", &cells, |(_, line, ..)| line.track.map(Track::as_str).unwrap_or_default().to_owned()),
        text("setting", &cells, |(_, line, ..)| line.label.clone()),
        text("unranked_because", &cells, |(_, line, ..)| line.unranked_because.clone()),
        text("column", &cells, |(_, _, column, ..)| (*column).clone()),
        text("metric", &cells, |(.., metric, _)| metric.key().to_owned()),
        numbers("value", &cells, |(.., cell)| Some(cell.value)),
        numbers("low", &cells, |(.., cell)| Some(cell.interval?[0])),
        numbers("high", &cells, |(.., cell)| Some(cell.interval?[1])),
        ranks("queries", &cells, count(0)),
        ranks("scenes", &cells, count(1)),
    ];
    csv("tables", board, cells.len(), columns)
}

/// `protocols/<protocol>.csv`: one row per method, and one per method and scene. Columns of numbers bear the name of the
/// protocol, so that none can be taken for one of the board.
pub(crate) fn protocol(board: &Board, table: &ProtocolTable) -> Result<Vec<u8>, BoardError> {
    let rows: Vec<(&ProtocolRow, &str, &[Option<f64>])> = table
        .rows
        .iter()
        .flat_map(|row| {
            let scenes = row.scenes.iter().map(move |(scene, found)| (row, scene.as_str(), found.as_slice()));
            std::iter::once((row, "", row.numbers.as_slice())).chain(scenes)
        })
        .collect();
    let mut columns = vec![
        text("method", &rows, |(row, ..)| row.name.to_string()),
        text("version", &rows, |(row, ..)| row.version.clone()),
        text("remarks", &rows, |(row, ..)| row.remarks.join(", ")),
        text("scene", &rows, |(_, scene, _)| (*scene).to_owned()),
    ];
    for (index, measure) in table.protocol.rules().measures.iter().enumerate() {
        let name = format!("{} {}", table.protocol, measure.key);
        columns.push(numbers(&name, &rows, |(.., found)| found[index]));
    }
    columns.extend(context(board, table.protocol.as_str(), rows.len()));
    write("protocols", rows.len(), columns)
}

fn identity<'a>(methods: impl IntoIterator<Item = &'a Method> + Clone) -> Vec<Column> {
    vec![
        ranks("rank", methods.clone(), |method| method.rank),
        text("track", methods.clone(), |method| method.track.as_str().to_owned()),
        text("method", methods, |method| method.name.to_string()),
    ]
}

fn metrics<'a, R: 'a>(
    rows: impl IntoIterator<Item = &'a R> + Clone,
    of: impl Fn(&'a R) -> &'a Metrics,
) -> Vec<Column> {
    let queries = counts("queries", rows.clone(), |row| of(row).queries);
    let values = Metric::ALL.map(|metric| numbers(metric.key(), rows.clone(), |row| of(row).get(metric)));
    std::iter::once(queries).chain(values).collect()
}

fn context(board: &Board, protocol: &str, height: usize) -> Vec<Column> {
    let heading = &board.heading;
    let rows = vec![(); height];
    let repeat = |name: &str, value: &str| text(name, &rows, |()| value.to_owned());
    let count = |name: &str, value: usize| counts(name, &rows, |()| value);
    vec![
        repeat("benchmark", &heading.benchmark),
        repeat("benchmark_version", &heading.on.benchmark_version),
        repeat("protocol", protocol),
        repeat("profile", heading.on.profile.as_str()),
        count("board_queries", heading.queries),
        count("verified_queries", heading.verified),
        count("rejected_queries", heading.rejected),
    ]
}

fn ranks<R>(name: &str, rows: impl IntoIterator<Item = R>, rank: impl Fn(R) -> Option<usize>) -> Column {
    let ranks: Vec<Option<u64>> = rows.into_iter().map(|row| rank(row).map(|rank| rank as u64)).collect();
    Column::new(name.into(), ranks)
}

fn counts<R>(name: &str, rows: impl IntoIterator<Item = R>, count: impl Fn(R) -> usize) -> Column {
    let counts: Vec<u64> = rows.into_iter().map(|row| count(row) as u64).collect();
    Column::new(name.into(), counts)
}

fn flags<R>(name: &str, rows: impl IntoIterator<Item = R>, flag: impl Fn(R) -> bool) -> Column {
    Column::new(name.into(), rows.into_iter().map(flag).collect::<Vec<bool>>())
}

fn numbers<R>(name: &str, rows: impl IntoIterator<Item = R>, number: impl Fn(R) -> Option<f64>) -> Column {
    Column::new(name.into(), rows.into_iter().map(number).collect::<Vec<Option<f64>>>())
}

fn text<R>(name: &str, rows: impl IntoIterator<Item = R>, text: impl Fn(R) -> String) -> Column {
    Column::new(name.into(), rows.into_iter().map(|row| inert(text(row))).collect::<Vec<String>>())
}

/// Untrusted text, so that no spreadsheet takes it for a formula and runs it.
fn inert(text: String) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text }
}

/// Value, standard error and interval.
fn estimates<R>(
    name: &str,
    rows: impl IntoIterator<Item = R>,
    estimate: impl Fn(R) -> Option<Estimate>,
) -> Vec<Column> {
    let found: Vec<Option<Estimate>> = rows.into_iter().map(estimate).collect();
    let column = |suffix: &str, value: &dyn Fn(Estimate) -> Option<f64>| {
        numbers(&format!("{name}{suffix}"), &found, |found| value((*found)?))
    };
    vec![
        column("", &|found| Some(found.value)),
        column("_error", &|found| found.standard_error),
        column("_low", &|found| Some(found.interval?[0])),
        column("_high", &|found| Some(found.interval?[1])),
    ]
}

fn csv(file: &str, board: &Board, height: usize, mut columns: Vec<Column>) -> Result<Vec<u8>, BoardError> {
    columns.extend(context(board, &board.heading.on.protocol, height));
    write(file, height, columns)
}

fn write(file: &str, height: usize, columns: Vec<Column>) -> Result<Vec<u8>, BoardError> {
    let mut bytes = Vec::new();
    let written = DataFrame::new(height, columns).and_then(|mut frame| {
        CsvWriter::new(&mut bytes)
            .include_header(true)
            .with_float_precision(Some(DECIMALS))
            .finish(&mut frame)
    });
    written.map_err(|error| BoardError::render(file, error))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn text_of(bytes: Result<Vec<u8>, BoardError>) -> String {
        String::from_utf8(bytes.unwrap()).unwrap()
    }

    #[test]
    fn tables_are_the_hand_made_ones() {
        let board = sample::hand_made();
        insta::assert_snapshot!("leaderboard", text_of(leaderboard(&board)));
        insta::assert_snapshot!("leaderboard_of_tracks", text_of(leaderboard(&sample::tracks())));
        insta::assert_snapshot!("per_category", text_of(per_group(&board, "category")));
        let lines = |bytes| text_of(bytes).lines().count();
        assert_eq!(
            (lines(per_group(&board, "scale")), lines(per_group(&board, "scene"))),
            (1 + 5 * 3, 1 + 5)
        );
    }

    #[test]
    fn untrusted_text_breaks_no_line_and_runs_in_no_spreadsheet() {
        let mut method = sample::method("a", 4, 1.0);
        (method.version, method.link) = ("1,\"x\"\ny".to_owned(), "@SUM(A1)".to_owned());
        let mut formula = sample::method("b", 4, 1.0);
        formula.version = "=1+1".to_owned();
        insta::assert_snapshot!(
            "untrusted",
            text_of(leaderboard(&sample::board_of(4, vec![method, formula])))
        );
    }

    #[test]
    fn reported_numbers_stand_beside_ours() {
        let mut method = sample::method("alpha", 4, 62.5);
        for name in
            ["miou", "action macc", "room tube_iou", "room_living_cats select", "iou chosen", "moon miou"]
        {
            method.reported.insert(name.to_owned(), 70.0);
        }
        insta::assert_snapshot!("reported", text_of(reported(&sample::board_of(4, vec![method]))));
    }

    #[test]
    fn p_values_keep_their_digits() {
        assert_eq!([1.0, 0.04994, 0.001, 0.000_954].map(p_text), ["1.0000", "0.0499", "0.0010", "9.5e-4"]);
    }
}
