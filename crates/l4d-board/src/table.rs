//! Tidy CSV tables. The only module that knows polars.
//!
//! One row per method, or per method and group; percentages with four decimals, an empty field where there is no
//! value. Each row repeats what the board is of, so that a row cut out of its file still says what it means.

use l4d_data::results::Track;
use l4d_data::{Name, Query};
use l4d_score::{Average, Estimate, Group, Metrics};
use polars::prelude::{Column, CsvWriter, DataFrame, SerWriter as _};

use crate::detail::Details;
use crate::error::BoardError;
use crate::layout::{self, Layout, Line};
use crate::protocols::{ProtocolRow, ProtocolTable};
use crate::rank::Board;
use crate::reported;
use crate::row::{BoardRow, Metric};
use crate::statistics::{Statistics, p_text};
use crate::taken::choices;

const DECIMALS: usize = 4;

/// Other averages of mIoU beside the headline, which weighs every query the same.
const AVERAGES: [(&str, Average); 3] = [
    ("miou_micro", Average::Micro),
    ("miou_macro_scene", Average::MacroScene),
    ("miou_macro_category", Average::MacroCategory),
];

/// `leaderboard.csv`: one row a method.
pub(crate) fn leaderboard(board: &Board) -> Result<Vec<u8>, BoardError> {
    let entries: Vec<Entry> = board
        .rows()
        .map(|(rank, row)| Entry { rank, row, group: "", metrics: row.scores.headline })
        .collect();
    let reasons: Vec<String> = board
        .ranked
        .iter()
        .map(|_| String::new())
        .chain(board.unranked.iter().map(|entry| entry.reason()))
        .collect();
    let mut columns = identity(&entries);
    columns.insert(3, text("version", entries.iter().map(|entry| entry.row.version.clone())));
    columns.push(text("unranked_because", reasons));
    columns.extend(metrics(&entries));
    let end = |end: usize| move |entry: &Entry| Some(entry.row.miou?.interval?[end]);
    columns.push(numbers("miou_low", entries.iter().map(end(0))));
    columns.push(numbers("miou_high", entries.iter().map(end(1))));
    for (name, average) in AVERAGES {
        let miou = |entry: &Entry| entry.row.scores.averages.get(&average).and_then(|metrics| metrics.miou);
        columns.push(numbers(name, entries.iter().map(miou)));
    }
    columns.push(numbers("seconds", entries.iter().map(|entry| entry.row.seconds)));
    columns.push(text("link", entries.iter().map(|entry| entry.row.link.clone())));
    columns.extend(context(board, entries.len()));
    csv("leaderboard.csv", entries.len(), columns)
}

/// `per_category.csv`: one row a method and category.
pub(crate) fn per_category(board: &Board) -> Result<Vec<u8>, BoardError> {
    grouped("per_category.csv", "category", board, |row| {
        row.scores.categories.iter().map(|(key, metrics)| (key.as_str(), *metrics)).collect()
    })
}

/// `per_scale.csv`: one row a method and spatial scale.
pub(crate) fn per_scale(board: &Board) -> Result<Vec<u8>, BoardError> {
    grouped("per_scale.csv", "scale", board, |row| {
        row.scores.scales.iter().map(|(key, metrics)| (key.as_str(), *metrics)).collect()
    })
}

/// `per_scene.csv`: one row a method and scene.
pub(crate) fn per_scene(board: &Board) -> Result<Vec<u8>, BoardError> {
    grouped("per_scene.csv", "scene", board, |row| {
        row.scores.scenes.iter().map(|(key, metrics)| (key.as_str(), *metrics)).collect()
    })
}

/// `taken.csv`: one row a method and query, with the instance that its prediction overlaps most.
pub(crate) fn taken(board: &Board, details: &Details) -> Result<Vec<u8>, BoardError> {
    let choices = choices(board, details);
    let rows: Vec<_> =
        choices.iter().flat_map(|one| one.taken.iter().map(move |taken| (one.method, taken))).collect();
    let meant = |query: &Query| {
        let names: Vec<&str> = query.referents.iter().map(|name| name.as_str()).collect();
        names.join("+")
    };
    let mut columns = vec![
        text("method", rows.iter().map(|(method, _)| method.to_string())),
        text("scene", rows.iter().map(|(_, taken)| taken.query.id.scene.to_string())),
        text("query", rows.iter().map(|(_, taken)| taken.query.id.number.to_string())),
        text("meant", rows.iter().map(|(_, taken)| meant(taken.query))),
        text("taken", rows.iter().map(|(_, taken)| taken.instance.map(Name::to_string).unwrap_or_default())),
        text("which_is", rows.iter().map(|(_, taken)| taken.choice.key().to_owned())),
    ];
    columns.extend(context(board, rows.len()));
    csv("taken.csv", rows.len(), columns)
}

/// `groups.csv`: one row a method and group, with standard errors and 95 % intervals.
pub(crate) fn groups(board: &Board, statistics: &Statistics) -> Result<Vec<u8>, BoardError> {
    let of_methods = statistics.methods.iter().zip(board.rows());
    let entries: Vec<(Option<usize>, &BoardRow, &Group)> = of_methods
        .flat_map(|(found, (rank, row))| found.groups.iter().map(move |group| (rank, row, group)))
        .collect();
    let rows = |text_of: &dyn Fn(&BoardRow, &Group) -> String| -> Vec<String> {
        entries.iter().map(|(_, row, group)| text_of(row, group)).collect()
    };
    let counts = |name: &str, count_of: &dyn Fn(&Group) -> usize| {
        let counts: Vec<u64> = entries.iter().map(|(.., group)| count_of(group) as u64).collect();
        Column::new(name.into(), counts)
    };
    let mut columns = vec![
        ranks("rank", entries.iter().map(|(rank, ..)| *rank)),
        text("track", rows(&|row, _| row.track.as_str().to_owned())),
        text("method", rows(&|row, _| row.name.to_string())),
        text("unranked_because", rows(&|row, _| board.why_unranked(row))),
        text("kind", rows(&|_, group| group.kind.as_str().to_owned())),
        text("group", rows(&|_, group| group.name.clone())),
        counts("queries", &|group| group.queries),
        counts("scenes", &|group| group.scenes),
        flags("few_scenes", entries.iter().map(|(.., group)| group.few_scenes)),
    ];
    for metric in Metric::ALL {
        let found: Vec<Option<Estimate>> =
            entries.iter().map(|(.., group)| metric.of_estimates(&group.estimates)).collect();
        columns.extend(estimates(metric.key(), &found));
    }
    columns.extend(context(board, entries.len()));
    csv("groups.csv", entries.len(), columns)
}

/// `comparisons.csv`: one row a metric and pair of methods.
pub(crate) fn comparisons(board: &Board, statistics: &Statistics) -> Result<Vec<u8>, BoardError> {
    let ranked: Vec<Option<usize>> = board.rows().map(|(rank, _)| rank).collect();
    let tracks: Vec<Track> = board.rows().map(|(_, row)| row.track).collect();
    let pairs: Vec<_> = statistics
        .comparisons
        .iter()
        .flat_map(|found| found.pairs.iter().map(move |pair| (found.metric, pair)))
        .collect();
    let name = |index: usize| statistics.methods[index].name.to_string();
    let found: Vec<Option<Estimate>> =
        pairs.iter().map(|(_, pair)| Some(pair.comparison.difference)).collect();
    let counts = |name: &str, count_of: fn(&Estimate) -> usize| {
        let counts: Vec<u64> = found.iter().flatten().map(|found| count_of(found) as u64).collect();
        Column::new(name.into(), counts)
    };
    let mut columns = vec![
        text("metric", pairs.iter().map(|(metric, _)| metric.key().to_owned())),
        text("track", pairs.iter().map(|(_, pair)| tracks[pair.first].as_str().to_owned())),
        ranks("first_rank", pairs.iter().map(|(_, pair)| ranked[pair.first])),
        text("first", pairs.iter().map(|(_, pair)| name(pair.first))),
        ranks("second_rank", pairs.iter().map(|(_, pair)| ranked[pair.second])),
        text("second", pairs.iter().map(|(_, pair)| name(pair.second))),
        counts("queries", |found| found.queries),
        counts("scenes", |found| found.scenes),
        flags("few_scenes", found.iter().flatten().map(Estimate::is_of_few_scenes)),
    ];
    columns.extend(estimates("difference", &found));
    columns.push(text("p", pairs.iter().map(|(_, pair)| p_text(pair.comparison.p))));
    columns.push(text("holm_p", pairs.iter().map(|(_, pair)| p_text(pair.holm_p))));
    columns.push(flags("different", pairs.iter().map(|(_, pair)| pair.is_different())));
    columns.push(numbers("detectable", pairs.iter().map(|(_, pair)| pair.comparison.detectable)));
    columns.push(text("least_p", pairs.iter().map(|(_, pair)| p_text(pair.comparison.least_p))));
    columns.extend(context(board, pairs.len()));
    csv("comparisons.csv", pairs.len(), columns)
}

/// `reported.csv`: one row a method and number that it reports of itself, with the same of our counts where it is one of
/// ours.
pub(crate) fn reported(board: &Board) -> Result<Vec<u8>, BoardError> {
    let rows = reported::rows(board);
    let columns = vec![
        text("method", rows.iter().map(|row| row.method.to_string())),
        text("number", rows.iter().map(|row| row.number.to_owned())),
        numbers("reported", rows.iter().map(|row| Some(row.reported))),
        numbers("recomputed", rows.iter().map(|row| row.recomputed)),
        numbers("difference", rows.iter().map(|row| Some(row.reported - row.recomputed?))),
    ];
    let columns = [columns, context(board, rows.len())].concat();
    csv("reported.csv", rows.len(), columns)
}

/// `tables/<name>.csv`: one row a number of a table in the paper's layout.
pub(crate) fn layout(board: &Board, layout: &Layout) -> Result<Vec<u8>, BoardError> {
    let of_line = |source: &'static str, line: &'_ Line| {
        let columns = layout.columns.iter().zip(&line.cells);
        let cells = columns.flat_map(|(column, pair)| {
            layout::METRICS
                .into_iter()
                .zip(pair)
                .filter_map(move |(metric, cell)| Some((column, metric, (*cell)?)))
        });
        cells.map(|(column, metric, cell)| (source, line.clone(), column, metric, cell)).collect::<Vec<_>>()
    };
    let measured = layout.rows.iter().flat_map(|line| of_line("measured", line));
    let published = layout.published.iter().flat_map(|line| of_line("published", line));
    let cells: Vec<_> = measured.chain(published).collect();
    let counts = |name: &str, which: usize| {
        let counts = cells.iter().map(|(.., cell)| cell.counts.map(|counts| counts[which] as u64));
        Column::new(name.into(), counts.collect::<Vec<_>>())
    };
    let mut columns = vec![
        text("source", cells.iter().map(|(source, ..)| (*source).to_owned())),
        ranks("rank", cells.iter().map(|(_, line, ..)| line.rank)),
        text(
            "track",
            cells.iter().map(|(_, line, ..)| line.track.map(Track::as_str).unwrap_or_default().to_owned()),
        ),
        text("setting", cells.iter().map(|(_, line, ..)| line.label.clone())),
        text("unranked_because", cells.iter().map(|(_, line, ..)| line.unranked_because.clone())),
        text("column", cells.iter().map(|(_, _, column, ..)| (*column).clone())),
        text("metric", cells.iter().map(|(.., metric, _)| metric.key().to_owned())),
        numbers("value", cells.iter().map(|(.., cell)| Some(cell.value))),
        numbers("low", cells.iter().map(|(.., cell)| Some(cell.interval?[0]))),
        numbers("high", cells.iter().map(|(.., cell)| Some(cell.interval?[1]))),
        counts("queries", 0),
        counts("scenes", 1),
    ];
    columns.extend(context(board, cells.len()));
    csv("tables", cells.len(), columns)
}

/// `protocols/<protocol>.csv`: one row a method, and one a method and scene. Columns of numbers bear the name of the
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
        text("method", rows.iter().map(|(row, ..)| row.name.to_string())),
        text("version", rows.iter().map(|(row, ..)| row.version.clone())),
        text("remarks", rows.iter().map(|(row, ..)| row.remarks.join(", "))),
        text("scene", rows.iter().map(|(_, scene, _)| (*scene).to_owned())),
    ];
    for (index, measure) in table.protocol.measures().iter().enumerate() {
        let name = format!("{} {}", table.protocol, measure.key);
        columns.push(numbers(&name, rows.iter().map(|(.., found)| found[index])));
    }
    columns.extend(context_of(board, table.protocol.as_str(), rows.len()));
    csv("protocols", rows.len(), columns)
}

struct Entry<'a> {
    rank: Option<usize>,
    row: &'a BoardRow,
    group: &'a str,
    metrics: Metrics,
}

fn grouped<'a>(
    file: &'static str,
    group_column: &str,
    board: &'a Board,
    groups_of: impl Fn(&'a BoardRow) -> Vec<(&'a str, Metrics)>,
) -> Result<Vec<u8>, BoardError> {
    let entries: Vec<Entry> = board
        .rows()
        .flat_map(|(rank, row)| {
            groups_of(row).into_iter().map(move |(group, metrics)| Entry { rank, row, group, metrics })
        })
        .collect();
    let mut columns = identity(&entries);
    columns.push(text(group_column, entries.iter().map(|entry| entry.group.to_owned())));
    columns.extend(metrics(&entries));
    columns.extend(context(board, entries.len()));
    csv(file, entries.len(), columns)
}

fn identity(entries: &[Entry]) -> Vec<Column> {
    vec![
        ranks("rank", entries.iter().map(|entry| entry.rank)),
        text("track", entries.iter().map(|entry| entry.row.track.as_str().to_owned())),
        text("method", entries.iter().map(|entry| entry.row.name.to_string())),
    ]
}

fn metrics(entries: &[Entry]) -> Vec<Column> {
    let queries: Vec<u64> = entries.iter().map(|entry| entry.metrics.queries as u64).collect();
    let mut columns = vec![Column::new("queries".into(), queries)];
    columns.extend(
        Metric::ALL
            .map(|metric| numbers(metric.key(), entries.iter().map(|entry| metric.of(&entry.metrics)))),
    );
    columns
}

fn context(board: &Board, height: usize) -> Vec<Column> {
    context_of(board, &board.heading.protocol, height)
}

fn context_of(board: &Board, protocol: &str, height: usize) -> Vec<Column> {
    let heading = &board.heading;
    let repeat = |name: &str, value: &str| text(name, std::iter::repeat_n(value.to_owned(), height));
    let count = |name: &str, value: usize| Column::new(name.into(), vec![value as u64; height]);
    vec![
        repeat("benchmark", &heading.benchmark),
        repeat("benchmark_version", &heading.version),
        repeat("protocol", protocol),
        repeat("profile", heading.profile.as_str()),
        count("board_queries", heading.queries),
        count("verified_queries", heading.verified),
        count("rejected_queries", heading.rejected),
    ]
}

fn ranks(name: &str, ranks: impl Iterator<Item = Option<usize>>) -> Column {
    Column::new(name.into(), ranks.map(|rank| rank.map(|rank| rank as u64)).collect::<Vec<_>>())
}

fn flags(name: &str, flags: impl Iterator<Item = bool>) -> Column {
    Column::new(name.into(), flags.collect::<Vec<bool>>())
}

/// Value, standard error and interval.
fn estimates(name: &str, found: &[Option<Estimate>]) -> Vec<Column> {
    let column = |suffix: &str, value: &dyn Fn(Estimate) -> Option<f64>| {
        numbers(&format!("{name}{suffix}"), found.iter().map(|found| value((*found)?)))
    };
    vec![
        column("", &|found| Some(found.value)),
        column("_error", &|found| found.standard_error),
        column("_low", &|found| Some(found.interval?[0])),
        column("_high", &|found| Some(found.interval?[1])),
    ]
}

fn text(name: &str, values: impl IntoIterator<Item = String>) -> Column {
    Column::new(name.into(), values.into_iter().map(inert).collect::<Vec<String>>())
}

/// What strangers wrote, so that no spreadsheet takes it for a formula and runs it.
fn inert(text: String) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text }
}

fn numbers(name: &str, values: impl Iterator<Item = Option<f64>>) -> Column {
    Column::new(name.into(), values.collect::<Vec<Option<f64>>>())
}

fn csv(file: &'static str, height: usize, columns: Vec<Column>) -> Result<Vec<u8>, BoardError> {
    let mut bytes = Vec::new();
    let written = DataFrame::new(height, columns).and_then(|mut frame| {
        CsvWriter::new(&mut bytes)
            .include_header(true)
            .with_float_precision(Some(DECIMALS))
            .finish(&mut frame)
    });
    written.map_err(|error| BoardError::Table { file, message: error.to_string() })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn lines(bytes: Vec<u8>) -> Vec<String> {
        String::from_utf8(bytes).unwrap().lines().map(str::to_owned).collect()
    }

    #[test]
    fn the_leaderboard_is_the_hand_made_one() {
        let expected = "\
rank,track,method,version,unranked_because,queries,miou,macc,acc25,acc50,tube_iou,select,false_positive_rate,miou_low,miou_high,miou_micro,miou_macro_scene,miou_macro_category,seconds,link,benchmark,benchmark_version,protocol,profile,board_queries,verified_queries,rejected_queries
1,colour,alpha,0.1,\"\",4,62.5000,62.5000,62.5000,62.5000,62.5000,62.5000,37.5000,58.0000,66.5000,62.5000,,,12.3400,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
1,colour,beta,0.1,\"\",4,62.5000,75.0000,62.5000,62.5000,62.5000,62.5000,37.5000,58.0000,66.5000,62.5000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
3,colour,gamma,0.1,\"\",4,50.0000,50.0000,50.0000,50.0000,50.0000,,50.0000,45.5000,54.0000,50.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
,colour,oracle,0.1,\"baseline, used ground truth\",4,100.0000,100.0000,100.0000,100.0000,100.0000,100.0000,0.0000,95.5000,100.0000,100.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
,colour,half,0.1,partial,2,80.0000,80.0000,80.0000,80.0000,80.0000,80.0000,20.0000,75.5000,84.0000,80.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0";
        let found = lines(leaderboard(&sample::hand_made()).unwrap());
        assert_eq!(found, expected.lines().collect::<Vec<_>>());
    }

    #[test]
    fn groups_are_tidy_and_leave_out_what_was_not_asked() {
        let found = lines(per_category(&sample::hand_made()).unwrap());
        assert_eq!(
            found[..2],
            [
                "rank,track,method,category,queries,miou,macc,acc25,acc50,tube_iou,select,false_positive_rate,benchmark,benchmark_version,protocol,profile,board_queries,verified_queries,rejected_queries",
                "1,colour,alpha,attribute,1,62.5000,62.5000,62.5000,62.5000,62.5000,62.5000,37.5000,Panoptic-L4D,1.0.0,l4d,small,4,1,0",
            ]
        );
        // Five methods, four categories, one missing.
        assert_eq!(found.len(), 1 + 5 * 4 - 1);
        assert!(!found.iter().any(|line| line.starts_with("3,colour,gamma,spatial")));
        assert_eq!(lines(per_scale(&sample::hand_made()).unwrap()).len(), 1 + 5 * 3);
        assert!(
            lines(per_scene(&sample::hand_made()).unwrap())[1]
                .starts_with("1,colour,alpha,room_living_cats,4,")
        );
    }

    #[test]
    fn every_row_says_its_track_and_ranks_begin_anew_in_each() {
        let found = lines(leaderboard(&sample::tracks()).unwrap());
        let starts: Vec<String> =
            found[1..].iter().map(|line| line.splitn(4, ',').take(3).collect::<Vec<_>>().join(",")).collect();
        let expected = [
            "1,colour,bright",
            "2,colour,dim",
            "1,colour+depth,deeper",
            "2,colour+depth,deep",
            ",colour,oracle",
        ];
        assert_eq!(starts, expected);
    }

    #[test]
    fn text_that_would_break_a_line_is_quoted() {
        let mut row = sample::row("a", 4, 1.0);
        row.version = "1,\"x\"\ny".to_owned();
        let board = Board::new(sample::heading(4, 0), vec![row]).unwrap();
        let text = String::from_utf8(leaderboard(&board).unwrap()).unwrap();
        assert!(text.contains("1,colour,a,\"1,\"\"x\"\"\ny\",\"\","), "{text}");
    }

    #[test]
    fn no_spreadsheet_runs_what_strangers_wrote() {
        let mut row = sample::row("a", 4, 1.0);
        (row.version, row.link) = ("=1+1".to_owned(), "@SUM(A1)".to_owned());
        let board = Board::new(sample::heading(4, 0), vec![row]).unwrap();
        let text = String::from_utf8(leaderboard(&board).unwrap()).unwrap();
        assert!(text.contains("1,colour,a,'=1+1,") && text.contains(",'@SUM(A1),"), "{text}");
    }
}
