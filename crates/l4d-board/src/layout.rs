//! Tables in the layout of the paper: mAcc and mIoU of each kind of queries, with intervals. What the paper reports of its
//! own data is below ours, apart: it is of other scenes and takes part in no comparison. So are the tracks apart.

use std::collections::BTreeSet;

use l4d_data::results::Track;
use l4d_data::{Category, Scale};
use l4d_score::{Estimate, Group, GroupKind, Metric};

use crate::board::{Board, Method, PublishedTable};
use crate::markdown::{self, escape, number, or_dash};
use crate::ranking::{BestTwo, Emphasis};

/// Numbers of a cell, in the order of the paper.
pub(crate) const METRICS: [Metric; 2] = [Metric::Macc, Metric::Miou];
/// Above the rows of the paper.
pub(crate) const PUBLISHED_TITLE: &str = "As reported in the paper, on its own data";
/// The last column.
const ALL: &str = "all";

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// File stem: that of `benchmark/published`.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// Kinds of queries.
    pub(crate) columns: Vec<String>,
    /// Ours, in the order of the board.
    pub(crate) rows: Vec<Line>,
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
pub(crate) fn all(board: &Board) -> Vec<Layout> {
    let composites = columns_of(board, GroupKind::Composite);
    let categories = || Category::ALL.map(|category| category.as_str().to_owned()).to_vec();
    if !composites.is_empty() {
        let rows = |method: &Method, columns: &[String]| {
            vec![line(method, "", columns, (GroupKind::All, GroupKind::Composite))]
        };
        return vec![layout(board, ("composites", "Methods by composite"), composites, rows)];
    }
    let by_category = |method: &Method, columns: &[String]| {
        vec![line(method, "", columns, (GroupKind::All, GroupKind::Category))]
    };
    let by_scale = |method: &Method, columns: &[String]| {
        let of_scale = |scale: Scale| {
            line(method, scale.as_str(), columns, (GroupKind::Scale, GroupKind::ScaleCategory))
        };
        Scale::ALL.map(of_scale).to_vec()
    };
    vec![
        layout(board, ("panoptic_l4d", "Methods by category"), categories(), by_category),
        layout(board, ("scales", "Scales by category"), categories(), by_scale),
    ]
}

/// The names of the groups of a kind, in the order in which they first occur.
pub(crate) fn columns_of(board: &Board, kind: GroupKind) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for group in board.compared().iter().flat_map(|method| &method.groups).filter(|group| group.kind == kind)
    {
        if !names.contains(&group.name) {
            names.push(group.name.clone());
        }
    }
    names
}

fn layout(
    board: &Board,
    (name, title): (&'static str, &'static str),
    mut columns: Vec<String>,
    rows: impl Fn(&Method, &[String]) -> Vec<Line>,
) -> Layout {
    columns.push(ALL.to_owned());
    let published = board.published.iter().find(|table| table.name == name);
    Layout {
        name,
        title,
        rows: board.compared().iter().flat_map(|method| rows(method, &columns)).collect(),
        published: published.map(|table| reported(table, &columns)).unwrap_or_default(),
        columns,
    }
}

/// A row of a method, or of a method and a scale. `kinds` are those of the groups in the last column and in the others.
fn line(
    method: &Method,
    scale: &str,
    columns: &[String],
    (of_all, of_column): (GroupKind, GroupKind),
) -> Line {
    let group = |column: &str| -> Option<&Group> {
        match (column == ALL, scale) {
            (true, "") => method.group(of_all, ALL),
            (true, scale) => method.group(of_all, scale),
            (false, "") => method.group(of_column, column),
            (false, scale) => method.group(of_column, &format!("{scale} {column}")),
        }
    };
    let cell = |column: &String| {
        let estimates = group(column).map(|group| group.estimates).unwrap_or_default();
        METRICS.map(|metric| estimates.get(metric).map(Cell::from))
    };
    let name = &method.name;
    Line {
        label: if scale.is_empty() { name.to_string() } else { format!("{name}, {scale}") },
        rank: method.rank,
        track: Some(method.track),
        unranked_because: method.why_unranked(),
        cells: columns.iter().map(cell).collect(),
    }
}

/// The paper's rows.
fn reported(table: &PublishedTable, columns: &[String]) -> Vec<Line> {
    let places: Vec<Option<usize>> = columns
        .iter()
        .map(|column| table.columns.iter().position(|other| same_column(other, column)))
        .collect();
    let cell = |value: Option<f64>| value.map(|value| Cell { value, interval: None, counts: None });
    let line = |row: &crate::board::PublishedRow| Line {
        label: row.setting.clone(),
        rank: None,
        track: None,
        unranked_because: String::new(),
        cells: places
            .iter()
            .map(|place| place.map_or([None; 2], |place| row.values[place].map(cell)))
            .collect(),
    };
    table.rows.iter().map(line).collect()
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
    fn best_two(&self, track: Option<Track>, column: usize, metric: usize) -> BestTwo {
        let is_rival = |line: &&Line| line.rank.is_some() && line.track == track && self.name != "scales";
        let cells = self.rows.iter().filter(is_rival).filter_map(|line| line.cells[column][metric]);
        let values = cells.filter(|cell| !cell.is_of_one_scene()).map(|cell| cell.value);
        BestTwo::of(values, METRICS[metric])
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
            let cell = |found: Option<(Cell, Emphasis)>| {
                or_dash(found, |(cell, emphasis)| number(cell.value, emphasis, cell.interval))
            };
            let name = format!("{}{mark}", escape(&line.label));
            table.row(std::iter::once(name).chain(self.cells(line).map(cell)).collect());
        }
        table.finish()
    }

    /// The cells of a row one after another, with what sets them off among the ranked rows of a track.
    pub(crate) fn cells<'a>(&'a self, line: &'a Line) -> impl Iterator<Item = Option<(Cell, Emphasis)>> + 'a {
        let cell = |(place, cell): (usize, &Option<Cell>)| {
            let best_two =
                line.rank.map(|_| self.best_two(line.track, place / 2, place % 2)).unwrap_or_default();
            cell.map(|cell| (cell, best_two.emphasis(cell.value)))
        };
        line.cells.as_flattened().iter().enumerate().map(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn tables_are_the_hand_made_ones() {
        let mut composites = sample::hand_made();
        for method in &mut composites.methods {
            let mut group = method.groups[0].clone();
            (group.kind, group.name) = (GroupKind::Composite, "action+spatial".to_owned());
            method.groups.push(group);
        }
        let mut one_scene = sample::tracks();
        one_scene.heading.scenes = 1;
        for estimates in one_scene
            .methods
            .iter_mut()
            .flat_map(|method| &mut method.groups)
            .map(|group| &mut group.estimates)
        {
            for estimate in [&mut estimates.miou, &mut estimates.macc] {
                *estimate = estimate.map(|found| Estimate { scenes: 1, interval: None, ..found });
            }
        }
        for (name, board) in [
            ("hand_made", sample::hand_made()),
            ("composites", composites),
            ("tracks", sample::tracks()),
            ("one_scene", one_scene),
            ("one_method", sample::board(1)),
        ] {
            let pages: Vec<String> = all(&board).iter().map(|table| table.markdown(&board)).collect();
            insta::assert_snapshot!(name, pages.join("\n"));
        }
    }
}
