//! `leaderboard.md`: the page that a repository shows.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Category, Scale};
use l4d_score::cluster::FEW_SCENES;
use l4d_score::groups::Kind;
use l4d_score::{Estimate, Pair};

use crate::rank::{Board, Podium, Ranked};
use crate::reported;
use crate::row::{BoardRow, Metric};
use crate::statistics::{Statistics, p_text};
use crate::terminal::{ONE_SCENE, seconds_text};

/// Pairs of methods that the page shows; of more methods each stands beside the next one only.
const MOST_PAIRS: usize = 28;

/// The page; `protocols` are (path, name) of tables that stand apart, `figures` (path, what it shows), in order.
pub(crate) fn page(
    board: &Board,
    statistics: &Statistics,
    protocols: &[(String, &str)],
    figures: &[(String, &str)],
) -> String {
    let mut page = format!("# Leaderboard\n\n{}.\n\n", escape(&board.heading.line()));
    page.push_str(
        "Percentages; macro means over queries. Ranked by mIoU; equal printed values share a rank.",
    );
    page.push_str(&reading_note(board));
    page.push_str("\n\n");
    if board
        .rows()
        .any(|(_, row)| row.miou.is_some_and(|found| found.interval.is_some() && found.is_of_few_scenes()))
    {
        page.push_str(&format!("Of fewer than {FEW_SCENES} scenes: intervals may be too narrow.\n\n"));
    }
    page.push_str(&ranked_tables(board));
    page.push_str(&unranked_table(board));
    let categories: Vec<_> = Category::ALL.iter().map(|key| (key.as_str(), key)).collect();
    page.push_str(&group_table("mIoU per category", board, &categories, |row, key| {
        row.scores.categories.get(key)?.miou
    }));
    let scales: Vec<_> = Scale::ALL.iter().map(|key| (key.as_str(), key)).collect();
    page.push_str(&group_table("mIoU per scale", board, &scales, |row, key| {
        row.scores.scales.get(key)?.miou
    }));
    page.push_str(&comparisons(board, statistics));
    for (title, kind) in [
        ("mIoU by time", Kind::Temporal),
        ("mIoU by size of the target", Kind::Size),
        ("mIoU by occlusion of the target", Kind::Occlusion),
    ] {
        page.push_str(&group_intervals(title, kind, board, statistics));
    }
    page.push_str(&reported_table(board));
    page.push_str(&other_tables(board));
    if !protocols.is_empty() {
        let links: Vec<String> = protocols.iter().map(|(path, name)| format!("[{name}]({path})")).collect();
        page.push_str(&format!(
            "## Under the rules of others\n\nApart, and never ranked: {}.\n\n",
            links.join(", ")
        ));
    }
    page.push_str("## Figures\n\n");
    for (path, caption) in figures {
        page.push_str(&format!("![{caption}]({path})\n\n"));
    }
    page.push_str(
        "Every number stands in `leaderboard.csv`, `per_category.csv`, `per_scale.csv` and `per_scene.csv`; intervals of \
         every group in `groups.csv`, all pairs of methods in `comparisons.csv`, what methods report of themselves in \
         `reported.csv`; the paper's layout, for papers too, in `tables/`.\n",
    );
    page
}

/// What bold letters and brackets mean, where there are any.
pub(crate) fn reading_note(board: &Board) -> String {
    if board.is_of_one_scene() {
        return format!(" {ONE_SCENE}");
    }
    let best = " **Best** and *second best* among the ranked methods of a track.";
    let best = if board.has_rivals() { best } else { "" };
    format!("{best} In brackets 95 % intervals clustered by scene.")
}

fn ranked_tables(board: &Board) -> String {
    if board.ranked.is_empty() {
        return "No method is ranked.\n\n".to_owned();
    }
    board.tracks().map(|(track, group)| ranked_table(board, track, group)).collect()
}

fn ranked_table(board: &Board, track: Track, group: &[Ranked]) -> String {
    let mut table = Table::new(&["#", "method", "version"]);
    table.numbers(Metric::ALL.map(metric_title));
    table.numbers(["seconds"]);
    let podiums = Metric::ALL
        .map(|metric| (metric, board.podium(track, metric, |row| metric.of(&row.scores.headline))));
    for entry in group {
        let mut cells = vec![entry.rank.to_string(), method(&entry.row), escape(&entry.row.version)];
        cells.extend(podiums.map(|(metric, podium)| {
            let value = honoured(metric.of(&entry.row.scores.headline), podium);
            format!("{value}{}", headline_interval(&entry.row, metric))
        }));
        cells.push(seconds(&entry.row));
        table.row(cells);
    }
    format!("{}{}", track_heading(track), table.finish())
}

/// Above the methods that are ranked with each other.
pub(crate) fn track_heading(track: Track) -> String {
    format!("## Track: {}\n\n", track.title())
}

/// Rank and track of a row, as cells.
fn place(rank: Option<usize>, row: &BoardRow) -> [String; 2] {
    [rank.map_or_else(|| "–".to_owned(), |rank| rank.to_string()), row.track.title().to_owned()]
}

fn unranked_table(board: &Board) -> String {
    if board.unranked.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["method", "why not ranked"]);
    table.numbers(Metric::ALL.map(metric_title));
    table.numbers(["seconds"]);
    for entry in &board.unranked {
        let mut cells = vec![method(&entry.row), entry.reason()];
        cells.extend(Metric::ALL.map(|metric| {
            let value = plain(metric.of(&entry.row.scores.headline));
            format!("{value}{}", headline_interval(&entry.row, metric))
        }));
        cells.push(seconds(&entry.row));
        table.row(cells);
    }
    format!("## Not ranked, shown for scale\n\n{}", table.finish())
}

/// Of the headline alone: the others have theirs in `groups.csv`.
fn headline_interval(row: &BoardRow, metric: Metric) -> String {
    let found = row.miou.filter(|_| metric == Metric::ALL[0]);
    found.map(|found| interval(&found)).unwrap_or_default()
}

/// ` (40.1 to 50.3)`; nothing where there is none.
fn interval(found: &Estimate) -> String {
    found.interval.map(|[low, high]| format!(" ({low:.1} to {high:.1})")).unwrap_or_default()
}

fn comparisons(board: &Board, statistics: &Statistics) -> String {
    let all = statistics.headline();
    let shown: Vec<&Pair> = match all.len() <= MOST_PAIRS {
        true => all.iter().collect(),
        // Partial methods are in no pair, so that the next one may be further down.
        false => statistics.neighbours(board),
    };
    if shown.is_empty() {
        return String::new();
    }
    let tracks: Vec<Track> = board.rows().map(|(_, row)| row.track).collect();
    let mut table = Table::new(&["track", "first", "second", "told apart"]);
    table.numbers(["difference", "p", "p, corrected", "detectable", "queries", "scenes"]);
    let mut is_rough = false;
    for pair in &shown {
        let found = &pair.comparison;
        is_rough |= found.difference.is_of_few_scenes();
        let name = |index: usize| escape(&statistics.methods[index].name);
        let verdict = match pair.is_different() {
            true if found.difference.value > 0.0 => "the first is better",
            true => "the second is better",
            false => "no",
        };
        let mark = if found.difference.is_of_few_scenes() { "!" } else { "" };
        table.row(vec![
            tracks[pair.first].title().to_owned(),
            name(pair.first),
            name(pair.second),
            verdict.to_owned(),
            format!("{:+.2}{}", found.difference.value, interval(&found.difference)),
            p_text(found.p),
            p_text(pair.holm_p),
            found.detectable.map_or_else(|| "–".to_owned(), |points| format!("{points:.2}")),
            found.difference.queries.to_string(),
            format!("{}{mark}", found.difference.scenes),
        ]);
    }
    let mut text = String::from(
        "## What can be told apart\n\nDifferences in mIoU, the first less the second, query by query, percentage points. p by \
         flipping the signs of scenes, corrected for all pairs of the track (Holm); methods of two tracks are not compared. A \
         true difference of the size called detectable would be found four times in five, before correction.\n\n",
    );
    text.push_str(&table.finish());
    if shown.len() < all.len() {
        text.push_str(&format!(
            "Each method beside the next one; all {} pairs stand in `comparisons.csv`.\n\n",
            all.len()
        ));
    }
    if statistics.left_out > 0 {
        text.push_str(&format!(
            "Of the first {} methods; {} more are not compared.\n\n",
            statistics.methods.len(),
            statistics.left_out
        ));
    }
    if is_rough {
        text.push_str(&format!("! fewer than {FEW_SCENES} scenes: intervals may be too narrow.\n\n"));
    }
    text
}

fn group_intervals(title: &str, kind: Kind, board: &Board, statistics: &Statistics) -> String {
    let mut names: Vec<&str> = Vec::new();
    for group in
        statistics.methods.iter().flat_map(|method| &method.groups).filter(|group| group.kind == kind)
    {
        if !names.contains(&group.name.as_str()) {
            names.push(&group.name);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["#", "track", "method"]);
    table.numbers(names.iter().map(|name| (*name).to_owned()));
    for ((rank, row), method) in board.rows().zip(&statistics.methods) {
        let mut cells = [&place(rank, row)[..], &[escape(&method.name)]].concat();
        for name in &names {
            let found = statistics.group(&row.name, kind, name).and_then(|group| group.estimates.miou);
            let cell = found.map(|found| format!("{:.2}{}", found.value, interval(&found)));
            cells.push(cell.unwrap_or_else(|| "–".to_owned()));
        }
        table.row(cells);
    }
    format!("## {title}\n\n{}.\n\n{}", escape(&board.heading.line()), table.finish())
}

fn reported_table(board: &Board) -> String {
    let known: Vec<_> = reported::rows(board).into_iter().filter(|row| row.recomputed.is_some()).collect();
    if known.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["method", "number"]);
    table.numbers(["as the method reports", "as counted here"]);
    for row in known {
        table.row(vec![
            escape(row.method),
            escape(row.number),
            plain(Some(row.reported)),
            plain(row.recomputed),
        ]);
    }
    format!("## Reported by the methods themselves\n\nNever ranked.\n\n{}", table.finish())
}

fn group_table<K>(
    title: &str,
    board: &Board,
    groups: &[(&str, &K)],
    miou: impl Fn(&BoardRow, &K) -> Option<f64>,
) -> String {
    let mut table = Table::new(&["#", "track", "method"]);
    table.numbers(groups.iter().map(|(name, _)| (*name).to_owned()));
    let podiums_of = |track| -> Vec<Podium> {
        let podium = |(_, key): &(&str, &K)| board.podium(track, Metric::Miou, |row| miou(row, key));
        groups.iter().map(podium).collect()
    };
    let podiums: BTreeMap<Track, Vec<Podium>> =
        board.tracks().map(|(track, _)| (track, podiums_of(track))).collect();
    for (rank, row) in board.rows() {
        let mut cells = [&place(rank, row)[..], &[method(row)]].concat();
        let podiums = rank.and_then(|_| podiums.get(&row.track));
        for (index, (_, key)) in groups.iter().enumerate() {
            let podium = podiums.map(|podiums| podiums[index]).unwrap_or_default();
            cells.push(honoured(miou(row, key), podium));
        }
        table.row(cells);
    }
    format!("## {title}\n\n{}.\n\n{}", escape(&board.heading.line()), table.finish())
}

fn other_tables(board: &Board) -> String {
    let mut text = String::new();
    for other in &board.others {
        text.push_str(&format!("## Not of this board: {}\n\n", escape(&other.line())));
        let mut table = Table::new(&["method", "version", "queries"]);
        table.numbers(Metric::ALL.map(metric_title));
        for row in &other.rows {
            let mut cells = vec![method(row), escape(&row.version), row.scores.headline.queries.to_string()];
            cells.extend(Metric::ALL.map(|metric| plain(metric.of(&row.scores.headline))));
            table.row(cells);
        }
        text.push_str(&table.finish());
    }
    text
}

pub(crate) struct Table {
    titles: Vec<String>,
    text_columns: usize,
    rows: String,
}

impl Table {
    pub(crate) fn new(text_titles: &[&str]) -> Self {
        let titles: Vec<String> = text_titles.iter().map(|&title| title.to_owned()).collect();
        Self { text_columns: titles.len(), titles, rows: String::new() }
    }

    pub(crate) fn numbers<S: Into<String>>(&mut self, titles: impl IntoIterator<Item = S>) {
        self.titles.extend(titles.into_iter().map(Into::into));
    }

    pub(crate) fn row(&mut self, cells: Vec<String>) {
        self.rows.push_str(&format!("| {} |\n", cells.join(" | ")));
    }

    pub(crate) fn finish(self) -> String {
        let rule = |index| if index < self.text_columns { "---" } else { "---:" };
        let rules: Vec<&str> = (0..self.titles.len()).map(rule).collect();
        format!("| {} |\n| {} |\n{}\n", self.titles.join(" | "), rules.join(" | "), self.rows)
    }
}

fn metric_title(metric: Metric) -> String {
    format!("{} {}", metric.title(), if metric.higher_is_better() { "↑" } else { "↓" })
}

fn method(row: &BoardRow) -> String {
    linked(&row.name, &row.link)
}

/// A name that leads to paper or code, where they have an address.
pub(crate) fn linked(name: &str, link: &str) -> String {
    let name = escape(name);
    if is_plain_url(link) { format!("[{name}]({link})") } else { name }
}

fn plain(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

fn honoured(value: Option<f64>, podium: Podium) -> String {
    match value {
        Some(value) if podium.is_best(value) => format!("**{value:.2}**"),
        Some(value) if podium.is_second(value) => format!("*{value:.2}*"),
        value => plain(value),
    }
}

fn seconds(row: &BoardRow) -> String {
    row.seconds.map_or_else(|| "–".to_owned(), seconds_text)
}

/// A link is only made of what cannot end the link or begin markup.
fn is_plain_url(link: &str) -> bool {
    let harmless = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~:/?#@!$&'*+,;=%".contains(&byte);
    (link.starts_with("https://") || link.starts_with("http://")) && link.bytes().all(harmless)
}

/// Text that a Markdown reader shows as it is, on one line and inside one table cell.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' | '!' | '$' => {
                escaped.extend(['\\', character]);
            }
            control if control.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn markup_in_names_and_versions_stays_text() {
        assert_eq!(escape("_a_|**b**<img>\n`c`"), "\\_a\\_\\|\\*\\*b\\*\\*&lt;img&gt; \\`c\\`");
        assert!(is_plain_url("https://example.org/a?b=c"));
        for link in ["javascript:alert(1)", "https://x.org/)![", "https://x.org/ y", "https://x.org/\"", ""] {
            assert!(!is_plain_url(link), "{link}");
        }
    }

    #[test]
    fn best_is_bold_second_is_italic_and_the_unranked_are_plain() {
        let page = page(&sample::hand_made(), &Statistics::default(), &[], &[]);
        let line = |start: &str| {
            page.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{start}\n{page}"))
        };
        assert!(line("| 1 | alpha |").contains("| **62.50** |"), "{}", line("| 1 | alpha |"));
        assert!(line("| 3 | gamma |").contains("| *50.00* |"), "{}", line("| 3 | gamma |"));
        assert!(line("| oracle |").contains("baseline, used ground truth | 100.00 (95.5 to 100.0) |"));
    }

    #[test]
    fn each_track_has_a_table_and_its_own_best() {
        let board = sample::tracks();
        let page = page(&board, &sample::statistics(&board), &[], &[]);
        let (colour, rest) = page.split_once("## Track: colour + depth\n").unwrap();
        assert!(colour.contains("## Track: colour\n") && colour.contains("| 1 | bright |"), "{page}");
        assert!(colour.contains("| **40.00**") && !colour.contains("| deep"), "{page}");
        assert!(rest.contains("| 1 | deeper |") && rest.contains("| **95.00**"), "{page}");
        let tests = page.split_once("## What can be told apart").unwrap().1;
        assert!(tests.contains("| colour | bright | dim |"), "{page}");
        assert!(tests.contains("| colour + depth | deeper | deep |"), "{page}");
        assert!(!tests.contains("| bright | deep"), "{page}");
    }

    #[test]
    fn one_scene_has_no_best_and_no_tests() {
        let mut board = sample::tracks();
        board.heading.scenes = 1;
        let one_scene = page(&board, &Statistics::default(), &[], &[]);
        assert!(one_scene.contains(ONE_SCENE) && !one_scene.contains("**"), "{one_scene}");
        assert!(!one_scene.contains("told apart") && !one_scene.contains("In brackets"), "{one_scene}");
        let alone = Board::new(sample::heading(4, 0), vec![sample::row("a", 4, 50.0)]).unwrap();
        let page = page(&alone, &sample::statistics(&alone), &[], &[]);
        assert!(!page.contains("**") && !page.contains("told apart"), "{page}");
    }

    #[test]
    fn every_row_of_a_table_has_as_many_cells_as_its_head() {
        let page = page(&sample::board(14), &sample::statistics(&sample::board(14)), &[], &[]);
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        let mut expected = None;
        for line in page.lines() {
            expected =
                if line.starts_with('|') { Some(expected.unwrap_or_else(|| cells(line))) } else { None };
            if let Some(expected) = expected {
                assert_eq!(cells(line), expected, "{line}");
            }
        }
    }
}
