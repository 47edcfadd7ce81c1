//! Tables in the layout of the paper: mAcc and mIoU of each kind of queries, with intervals. What the paper reports of its
//! own data stands below ours, apart: it is of other scenes and takes part in no comparison. So are the tracks apart.

use std::collections::BTreeSet;

use l4d_data::layout::BenchDir;
use l4d_data::published::{self, Published};
use l4d_data::results::Track;
use l4d_data::{Category, DataError, Name, Scale};
use l4d_score::groups::Kind;
use l4d_score::{Estimate, Group};

use crate::markdown::{self, escape};
use crate::rank::{Board, Podium};
use crate::row::Metric;
use crate::statistics::Statistics;

/// Numbers of a cell, in the order of the paper.
pub(crate) const METRICS: [Metric; 2] = [Metric::Macc, Metric::Miou];
/// Above the rows of the paper.
pub(crate) const PUBLISHED_TITLE: &str = "As reported in the paper, on its own data";
/// The last column.
const ALL: &str = "all";

/// One table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// File stem: that of `benchmark/published`.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// Kinds of queries.
    pub(crate) columns: Vec<String>,
    /// Ours, in the order of the board.
    pub(crate) rows: Vec<Line>,
    /// The paper's.
    pub(crate) published: Vec<Line>,
}

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Line {
    /// Method, or method and scale; a setting of the paper.
    pub(crate) label: String,
    pub(crate) rank: Option<usize>,
    /// None for what is reported.
    pub(crate) track: Option<Track>,
    pub(crate) unranked_because: String,
    /// One entry a column, of [`METRICS`].
    pub(crate) cells: Vec<[Option<Cell>; 2]>,
}

/// One number, percent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub(crate) value: f64,
    pub(crate) interval: Option<[f64; 2]>,
    /// Queries and scenes; none for what is reported.
    pub(crate) counts: Option<[usize; 2]>,
}

impl From<Estimate> for Cell {
    fn from(found: Estimate) -> Self {
        Self { value: found.value, interval: found.interval, counts: Some([found.queries, found.scenes]) }
    }
}

/// The tables that the groups of a board fill.
pub(crate) fn all(
    board: &Board,
    statistics: &Statistics,
    bench: &BenchDir,
) -> Result<Vec<Layout>, DataError> {
    let has_composites = statistics
        .methods
        .iter()
        .any(|method| method.groups.iter().any(|group| group.kind == Kind::Composite));
    let tables = match has_composites {
        true => vec![composites(board, statistics)],
        false => vec![categories(board, statistics), scales(board, statistics)],
    };
    let filled = tables.into_iter().map(|table| Ok(Layout { published: reported(&table, bench)?, ..table }));
    filled.collect()
}

fn categories(board: &Board, statistics: &Statistics) -> Layout {
    let columns: Vec<String> = Category::ALL.iter().map(|category| category.as_str().to_owned()).collect();
    let lines = per_method(board, statistics, |name, column| {
        statistics.group(name, if column == ALL { Kind::All } else { Kind::Category }, column)
    });
    layout("panoptic_l4d", "Methods by category", columns, lines)
}

fn composites(board: &Board, statistics: &Statistics) -> Layout {
    let mut columns: Vec<String> = Vec::new();
    for group in statistics.methods.iter().flat_map(|method| &method.groups) {
        if group.kind == Kind::Composite && !columns.contains(&group.name) {
            columns.push(group.name.clone());
        }
    }
    let lines = per_method(board, statistics, |name, column| {
        statistics.group(name, if column == ALL { Kind::All } else { Kind::Composite }, column)
    });
    layout("composites", "Methods by composite", columns, lines)
}

fn scales(board: &Board, statistics: &Statistics) -> Layout {
    let columns: Vec<String> = Category::ALL.iter().map(|category| category.as_str().to_owned()).collect();
    let lines = move |columns: &[String]| {
        let of_scale = |scale: Scale| {
            per_method(board, statistics, move |name, column| match column {
                ALL => statistics.group(name, Kind::Scale, scale.as_str()),
                _ => statistics.group(name, Kind::ScaleCategory, &format!("{} {column}", scale.as_str())),
            })(columns)
        };
        let scales = Scale::ALL.map(|scale| (scale, of_scale(scale)));
        let labelled = |index: usize| {
            scales.iter().map(move |(scale, lines): &(Scale, Vec<Line>)| {
                let line = lines[index].clone();
                Line { label: format!("{}, {}", line.label, scale.as_str()), ..line }
            })
        };
        (0..statistics.methods.len()).flat_map(labelled).collect()
    };
    layout("scales", "Scales by category", columns, lines)
}

fn layout(
    name: &'static str,
    title: &'static str,
    mut columns: Vec<String>,
    lines: impl FnOnce(&[String]) -> Vec<Line>,
) -> Layout {
    columns.push(ALL.to_owned());
    Layout { name, title, rows: lines(&columns), columns, published: Vec::new() }
}

/// A row a method; `group` finds what stands in a column.
fn per_method<'a>(
    board: &'a Board,
    statistics: &'a Statistics,
    group: impl Fn(&Name, &str) -> Option<&'a Group>,
) -> impl FnOnce(&[String]) -> Vec<Line> {
    move |columns| {
        let cells = |name: &Name| {
            let cell = |column: &String| {
                let estimates = group(name, column).map(|group| group.estimates).unwrap_or_default();
                METRICS.map(|metric| metric.of_estimates(&estimates).map(Cell::from))
            };
            columns.iter().map(cell).collect()
        };
        let line = |((rank, row), method): ((Option<usize>, &crate::BoardRow), &crate::MethodGroups)| Line {
            label: row.name.to_string(),
            rank,
            track: Some(row.track),
            unranked_because: board.why_unranked(row),
            cells: cells(&method.name),
        };
        board.rows().zip(&statistics.methods).map(line).collect()
    }
}

/// The paper's rows, where the benchmark has its table.
fn reported(table: &Layout, bench: &BenchDir) -> Result<Vec<Line>, DataError> {
    let path = bench.published(table.name);
    if !path.exists() {
        return Ok(Vec::new());
    }
    let found = Published::read(&path)?;
    let value = |setting: &str, column: &String, metric| {
        let column = found.columns().into_iter().find(|other| same_column(other, column))?;
        let value = found.value(setting, column, metric)?;
        Some(Cell { value, interval: None, counts: None })
    };
    let line = |setting: &str| Line {
        label: setting.to_owned(),
        rank: None,
        track: None,
        unranked_because: String::new(),
        cells: table
            .columns
            .iter()
            .map(|column| {
                [published::Metric::Macc, published::Metric::Miou]
                    .map(|metric| value(setting, column, metric))
            })
            .collect(),
    };
    Ok(found.settings().into_iter().map(line).collect())
}

/// Whether two names of columns are of the same categories, in whatever order.
fn same_column(one: &str, other: &str) -> bool {
    let parts = |name: &'_ str| name.split('+').map(str::to_owned).collect::<BTreeSet<String>>();
    parts(one) == parts(other)
}

impl Line {
    /// With whom it is ranked; none for what has no rank.
    fn group(&self) -> Option<Track> {
        self.rank.and(self.track)
    }
}

impl Cell {
    /// A value of one scene says nothing of others.
    fn is_of_one_scene(&self) -> bool {
        self.counts.is_some_and(|[_, scenes]| scenes < 2)
    }
}

impl Layout {
    /// Our rows in groups: those of each track that are ranked with each other, then those that have no rank.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (Option<Track>, &[Line])> {
        let alike = |a: &Line, b: &Line| a.group() == b.group();
        self.rows.chunk_by(alike).map(|lines| (lines[0].group(), lines))
    }

    /// Best and second-best printed value of each number among the ranked rows of a track. Rows of several scales are no
    /// rivals.
    pub(crate) fn podium(&self, track: Option<Track>, column: usize, metric: usize) -> Podium {
        let is_rival = |line: &&Line| line.rank.is_some() && line.track == track && self.name != "scales";
        let cells = self.rows.iter().filter(is_rival).filter_map(|line| line.cells[column][metric]);
        let values = cells.filter(|cell| !cell.is_of_one_scene()).map(|cell| cell.value);
        Podium::of(values, METRICS[metric])
    }

    /// The table as a page.
    pub(crate) fn markdown(&self, board: &Board) -> String {
        let mut text = format!(
            "# {}\n\n{}.\n\nPercent, macro means over queries.{} † not ranked.\n\n",
            self.title,
            escape(&board.heading.line()),
            markdown::reading_note(board)
        );
        for (track, lines) in self.groups() {
            text.push_str(&track.map_or_else(|| "## Not ranked\n\n".to_owned(), markdown::track_heading));
            text.push_str(&self.markdown_table(lines));
        }
        if !self.published.is_empty() {
            text.push_str(&format!(
                "## {PUBLISHED_TITLE}\n\nNumbers of arXiv 2604.05638. Scenes, prompts and masks are the authors' own: no \
                 difference to the rows above says who is better.\n\n"
            ));
            text.push_str(&self.markdown_table(&self.published));
        }
        text
    }

    fn markdown_table(&self, lines: &[Line]) -> String {
        let mut table = markdown::Table::new(&["method"]);
        for column in &self.columns {
            table.numbers(METRICS.map(|metric| format!("{column} {} ↑", metric.title())));
        }
        for line in lines {
            let mark = if line.unranked_because.is_empty() { "" } else { " †" };
            let mut cells = vec![format!("{}{mark}", escape(&line.label))];
            for (column, pair) in line.cells.iter().enumerate() {
                for (metric, cell) in pair.iter().enumerate() {
                    let podium = line.rank.map(|_| self.podium(line.track, column, metric));
                    cells.push(cell.map_or_else(|| "–".to_owned(), |cell| markdown_cell(cell, podium)));
                }
            }
            table.row(cells);
        }
        table.finish()
    }
}

fn markdown_cell(cell: Cell, podium: Option<Podium>) -> String {
    let value = match podium {
        Some(podium) if podium.is_best(cell.value) => format!("**{:.2}**", cell.value),
        Some(podium) if podium.is_second(cell.value) => format!("*{:.2}*", cell.value),
        _ => format!("{:.2}", cell.value),
    };
    match cell.interval {
        Some([low, high]) => format!("{value} ({low:.1} to {high:.1})"),
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    fn shipped() -> BenchDir {
        BenchDir::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../benchmark"))
    }

    #[test]
    fn rows_follow_the_board_and_scales_come_three_a_method() {
        let board = sample::hand_made();
        let tables = all(&board, &sample::statistics(&board), &shipped()).unwrap();
        let labels = |table: &Layout| table.rows.iter().map(|line| line.label.clone()).collect::<Vec<_>>();
        assert_eq!(tables.iter().map(|table| table.name).collect::<Vec<_>>(), ["panoptic_l4d", "scales"]);
        assert_eq!(labels(&tables[0]), ["alpha", "beta", "gamma", "oracle", "half"]);
        assert_eq!(
            labels(&tables[1])[..4],
            ["alpha, outdoor", "alpha, room", "alpha, tabletop", "beta, outdoor"]
        );
        assert_eq!(tables[0].columns, ["attribute", "action", "spatial", "interaction", "all"]);
        let gamma = &tables[0].rows[2];
        assert_eq!(gamma.cells[2], [None, None], "it was asked nothing spatial");
        assert_eq!(tables[0].published.len(), 3);
        assert!(
            tables[1].published.iter().all(|line| line.cells.len() == 5 && line.cells[4] == [None, None])
        );
    }

    #[test]
    fn composites_are_found_whatever_their_order() {
        let board = sample::hand_made();
        let mut statistics = sample::statistics(&board);
        for method in &mut statistics.methods {
            let mut group = method.groups[0].clone();
            (group.kind, group.name) = (Kind::Composite, "action+spatial".to_owned());
            method.groups.push(group);
        }
        let tables = all(&board, &statistics, &shipped()).unwrap();
        assert_eq!((tables.len(), tables[0].name), (1, "composites"));
        assert_eq!(tables[0].columns, ["action+spatial", "all"]);
        assert!(tables[0].published.iter().all(|line| line.cells[0].iter().all(Option::is_some)));
    }

    #[test]
    fn tracks_are_apart_in_every_table() {
        let board = sample::tracks();
        for table in all(&board, &sample::statistics(&board), &shipped()).unwrap() {
            let groups: Vec<_> = table.groups().map(|(track, _)| track).collect();
            assert_eq!(groups, [Some(Track::Colour), Some(Track::ColourDepth), None], "{}", table.name);
            let page = table.markdown(&board);
            let (colour, depth) = page.split_once("## Track: colour + depth\n").unwrap();
            let has_best = |text: &str, value: &str| text.contains(&format!("**{value}**"));
            let is_ranking = table.name != "scales";
            assert_eq!((has_best(colour, "40.00"), has_best(depth, "95.00")), (is_ranking, is_ranking));
        }
    }

    #[test]
    fn one_method_or_one_scene_has_no_best() {
        let board = sample::board(1);
        let table = &all(&board, &sample::statistics(&board), &shipped()).unwrap()[0];
        assert!(!table.markdown(&board).contains("**"));
        let mut board = sample::tracks();
        board.heading.scenes = 1;
        let mut statistics = sample::statistics(&board);
        let groups = statistics.methods.iter_mut().flat_map(|method| &mut method.groups);
        for estimate in groups.flat_map(|group| [&mut group.estimates.miou, &mut group.estimates.macc]) {
            let estimate = estimate.as_mut().unwrap();
            (estimate.scenes, estimate.interval) = (1, None);
        }
        let page = all(&board, &statistics, &shipped()).unwrap()[0].markdown(&board);
        assert!(!page.contains("**") && !page.contains("In brackets"), "{page}");
    }

    #[test]
    fn pages_mark_the_unranked_and_keep_the_paper_apart() {
        let board = sample::hand_made();
        let tables = all(&board, &sample::statistics(&board), &shipped()).unwrap();
        let page = tables[0].markdown(&board);
        let (ours, paper) = page.split_once(PUBLISHED_TITLE).unwrap();
        assert!(ours.contains("| oracle † | 100.00 (95.5 to 100.0) |"), "{page}");
        assert!(
            ours.contains("| alpha | **62.50** (58.0 to 67.0) |") && !ours.contains("LangSplat"),
            "{page}"
        );
        assert!(paper.contains("| PanopticQuery |") && !paper.contains("**"), "{page}");
    }
}
