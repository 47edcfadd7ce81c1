//! Tidy CSV tables. The only module that knows polars.
//!
//! One row per method, or per method and group; percentages with four decimals, an empty field where there is no
//! value. Each row repeats what the board is of, so that a row cut out of its file still says what it means.

use l4d_score::{Average, Metrics};
use polars::prelude::{Column, CsvWriter, DataFrame, SerWriter as _};

use crate::error::BoardError;
use crate::rank::Board;
use crate::row::{BoardRow, Metric};

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
    columns.insert(2, text("version", entries.iter().map(|entry| entry.row.version.clone())));
    columns.push(text("unranked_because", reasons));
    columns.extend(metrics(&entries));
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
    let ranks: Vec<Option<u64>> = entries.iter().map(|entry| entry.rank.map(|rank| rank as u64)).collect();
    vec![
        Column::new("rank".into(), ranks),
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
    let heading = &board.heading;
    let repeat = |name: &str, value: &str| text(name, std::iter::repeat_n(value.to_owned(), height));
    let count = |name: &str, value: usize| Column::new(name.into(), vec![value as u64; height]);
    vec![
        repeat("benchmark", &heading.benchmark),
        repeat("benchmark_version", &heading.version),
        repeat("protocol", &heading.protocol),
        repeat("profile", heading.profile.as_str()),
        count("board_queries", heading.queries),
        count("verified_queries", heading.verified),
        count("rejected_queries", heading.rejected),
    ]
}

fn text(name: &str, values: impl IntoIterator<Item = String>) -> Column {
    Column::new(name.into(), values.into_iter().collect::<Vec<String>>())
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
rank,method,version,unranked_because,queries,miou,macc,acc25,acc50,tube_iou,select,false_positive_rate,miou_micro,miou_macro_scene,miou_macro_category,seconds,link,benchmark,benchmark_version,protocol,profile,board_queries,verified_queries,rejected_queries
1,alpha,0.1,\"\",4,62.5000,62.5000,62.5000,62.5000,62.5000,62.5000,37.5000,62.5000,,,12.3400,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
1,beta,0.1,\"\",4,62.5000,75.0000,62.5000,62.5000,62.5000,62.5000,37.5000,62.5000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
3,gamma,0.1,\"\",4,50.0000,50.0000,50.0000,50.0000,50.0000,,50.0000,50.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
,oracle,0.1,used ground truth,4,100.0000,100.0000,100.0000,100.0000,100.0000,100.0000,0.0000,100.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0
,half,0.1,partial,2,80.0000,80.0000,80.0000,80.0000,80.0000,80.0000,20.0000,80.0000,,,,\"\",Panoptic-L4D,1.0.0,l4d,small,4,1,0";
        let found = lines(leaderboard(&sample::hand_made()).unwrap());
        assert_eq!(found, expected.lines().collect::<Vec<_>>());
    }

    #[test]
    fn groups_are_tidy_and_leave_out_what_was_not_asked() {
        let found = lines(per_category(&sample::hand_made()).unwrap());
        assert_eq!(
            found[..2],
            [
                "rank,method,category,queries,miou,macc,acc25,acc50,tube_iou,select,false_positive_rate,benchmark,benchmark_version,protocol,profile,board_queries,verified_queries,rejected_queries",
                "1,alpha,attribute,1,62.5000,62.5000,62.5000,62.5000,62.5000,62.5000,37.5000,Panoptic-L4D,1.0.0,l4d,small,4,1,0",
            ]
        );
        // Five methods, four categories, one missing.
        assert_eq!(found.len(), 1 + 5 * 4 - 1);
        assert!(!found.iter().any(|line| line.starts_with("3,gamma,spatial")));
        assert_eq!(lines(per_scale(&sample::hand_made()).unwrap()).len(), 1 + 5 * 3);
        assert!(
            lines(per_scene(&sample::hand_made()).unwrap())[1].starts_with("1,alpha,room_living_cats,4,")
        );
    }

    #[test]
    fn text_that_would_break_a_line_is_quoted() {
        let mut row = sample::row("a", 4, 1.0);
        row.version = "1,\"x\"\ny".to_owned();
        let board = Board::new(sample::heading(4, 0), vec![row]).unwrap();
        let text = String::from_utf8(leaderboard(&board).unwrap()).unwrap();
        assert!(text.contains("1,a,\"1,\"\"x\"\"\ny\",\"\","), "{text}");
    }
}
