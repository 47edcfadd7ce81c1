//! `leaderboard.md`: the page that a repository shows.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Category, Scale};
use l4d_score::cluster::FEW_SCENES;
use l4d_score::{Estimate, GroupKind, Metric, Pair};

use crate::board::{Board, MOST_COMPARED, Method};
use crate::figures::Figure;
use crate::layout::columns_of;
use crate::ranking::{BestTwo, Emphasis};
use crate::tables::{p_text, reported_numbers};
use crate::terminal::{ONE_SCENE, seconds_text};

/// Pairs of methods that the page shows; with more of them each method is shown beside the next one only.
const MOST_PAIRS: usize = 28;

/// The page, which shows `figures` in order.
pub(crate) fn page(board: &Board, figures: &[Figure]) -> String {
    let mut page = format!("# Leaderboard\n\n{}.\n\n", escape(&board.heading.line()));
    page.push_str(
        "Percentages; macro means over queries. Ranked by mIoU; equal printed values share a rank.",
    );
    page.push_str(&reading_note(board));
    page.push_str("\n\n");
    let is_rough = |found: &Estimate| found.interval.is_some() && found.is_of_few_scenes();
    if board.methods.iter().any(|method| method.miou.as_ref().is_some_and(is_rough)) {
        page.push_str(&format!("Of fewer than {FEW_SCENES} scenes: intervals may be too narrow.\n\n"));
    }
    page.push_str(&ranked_tables(board));
    page.push_str(&unranked_table(board));
    let categories = Category::ALL.map(|key| (key.as_str(), key));
    page.push_str(&group_table("mIoU per category", board, &categories, |method, key| {
        method.scores.categories.get(key)?.get(Metric::Miou)
    }));
    let scales = Scale::ALL.map(|key| (key.as_str(), key));
    page.push_str(&group_table("mIoU per scale", board, &scales, |method, key| {
        method.scores.scales.get(key)?.get(Metric::Miou)
    }));
    page.push_str(&comparisons(board));
    for (title, kind) in [
        ("mIoU by time", GroupKind::Temporal),
        ("mIoU by size of the target", GroupKind::Size),
        ("mIoU by occlusion of the target", GroupKind::Occlusion),
    ] {
        page.push_str(&group_intervals(title, kind, board));
    }
    page.push_str(&reported_table(board));
    if !board.protocols.is_empty() {
        let link = |name: &str| format!("[{name}](protocols/{name}.md)");
        let links: Vec<String> = board.protocols.iter().map(|table| link(table.protocol.as_str())).collect();
        page.push_str(&format!(
            "## Under the rules of others\n\nApart, and never ranked: {}.\n\n",
            links.join(", ")
        ));
    }
    page.push_str("## Figures\n\n");
    for Figure { name, caption, .. } in figures {
        page.push_str(&format!("![{caption}](figures/{name}.svg)\n\n"));
    }
    page.push_str(
        "Every number is in `leaderboard.csv`, `per_category.csv`, `per_scale.csv` and `per_scene.csv`; intervals of \
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
    if board.ranked().is_empty() {
        return "No method is ranked.\n\n".to_owned();
    }
    board.tracks().map(|(track, group)| ranked_table(board, track, group)).collect()
}

fn ranked_table(board: &Board, track: Track, methods: &[Method]) -> String {
    let mut table = Table::new(&["#", "method", "version"]);
    table.numbers(Metric::ALL.map(metric_title));
    table.numbers(["seconds"]);
    let best_two = |metric| BestTwo::of_track(board, track, metric, |method| method.headline(metric));
    let best_twos = BTreeMap::from(Metric::ALL.map(|metric| (metric, best_two(metric))));
    for method in methods {
        let mut cells = vec![rank(method), linked(&method.name, &method.link), escape(&method.version)];
        cells.extend(numbers(method, |metric| best_twos[&metric]));
        cells.push(seconds(method));
        table.row(cells);
    }
    format!("{}{}", track_heading(track), table.finish())
}

/// Above the methods that are ranked with each other.
pub(crate) fn track_heading(track: Track) -> String {
    format!("## Track: {}\n\n", track.title())
}

fn rank(method: &Method) -> String {
    or_dash(method.rank, |rank| rank.to_string())
}

fn unranked_table(board: &Board) -> String {
    if board.unranked().is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["method", "why not ranked"]);
    table.numbers(Metric::ALL.map(metric_title));
    table.numbers(["seconds"]);
    for method in board.unranked() {
        let mut cells = vec![linked(&method.name, &method.link), method.why_unranked()];
        cells.extend(numbers(method, |_| BestTwo::default()));
        cells.push(seconds(method));
        table.row(cells);
    }
    format!("## Not ranked, shown for scale\n\n{}", table.finish())
}

/// The numbers of a method; of the headline with its interval, the others have theirs in `groups.csv`.
fn numbers(method: &Method, best_two: impl Fn(Metric) -> BestTwo) -> impl Iterator<Item = String> {
    let cell = move |metric: Metric| {
        let interval = method.miou.filter(|_| metric == Metric::ALL[0]).and_then(|found| found.interval);
        or_dash(method.headline(metric), |value| number(value, best_two(metric).emphasis(value), interval))
    };
    Metric::ALL.into_iter().map(cell)
}

fn comparisons(board: &Board) -> String {
    let all = board.headline_pairs();
    let shown: Vec<&Pair> = match all.len() <= MOST_PAIRS {
        true => all.iter().collect(),
        // Partial methods are in no pair, so that the next one may be further down.
        false => board.neighbours(),
    };
    if shown.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["track", "first", "second", "told apart"]);
    table.numbers(["difference", "p", "p, corrected", "detectable", "queries", "scenes"]);
    let mut is_rough = false;
    for pair in &shown {
        let found = &pair.comparison;
        is_rough |= found.difference.is_of_few_scenes();
        let name = |index: usize| escape(&board.methods[index].name);
        let verdict = match pair.is_different() {
            true if found.difference.value > 0.0 => "the first is better",
            true => "the second is better",
            false => "no",
        };
        let mark = if found.difference.is_of_few_scenes() { "!" } else { "" };
        table.row(vec![
            board.methods[pair.first].track.title().to_owned(),
            name(pair.first),
            name(pair.second),
            verdict.to_owned(),
            format!("{:+.2}{}", found.difference.value, interval(found.difference.interval)),
            p_text(found.p),
            p_text(pair.holm_p),
            hundredths(found.detectable),
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
            "Each method beside the next one; all {} pairs are in `comparisons.csv`.\n\n",
            all.len()
        ));
    }
    let left_out = board.methods.len() - board.compared().len();
    if left_out > 0 {
        text.push_str(&format!(
            "Of the first {MOST_COMPARED} methods; {left_out} more are not compared.\n\n"
        ));
    }
    if is_rough {
        text.push_str(&format!("! fewer than {FEW_SCENES} scenes: intervals may be too narrow.\n\n"));
    }
    text
}

fn group_intervals(title: &str, kind: GroupKind, board: &Board) -> String {
    let names = columns_of(board, kind);
    if names.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["#", "track", "method"]);
    table.numbers(names.iter().cloned());
    for method in board.compared() {
        let mut cells = vec![rank(method), method.track.title().to_owned(), escape(&method.name)];
        cells.extend(names.iter().map(|name| {
            let found = method.group(kind, name).and_then(|group| group.estimates.miou);
            or_dash(found, |found| number(found.value, Emphasis::None, found.interval))
        }));
        table.row(cells);
    }
    format!("## {title}\n\n{}.\n\n{}", escape(&board.heading.line()), table.finish())
}

fn reported_table(board: &Board) -> String {
    let known: Vec<_> = reported_numbers(board).into_iter().filter(|row| row.recomputed.is_some()).collect();
    if known.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["method", "number"]);
    table.numbers(["as the method reports", "as counted here"]);
    for row in known {
        let values = [Some(row.reported), row.recomputed].map(hundredths);
        table.row([[escape(row.method), escape(row.number)], values].concat());
    }
    format!("## Reported by the methods themselves\n\nNever ranked.\n\n{}", table.finish())
}

fn group_table<K>(
    title: &str,
    board: &Board,
    groups: &[(&str, K)],
    miou: impl Fn(&Method, &K) -> Option<f64>,
) -> String {
    let mut table = Table::new(&["#", "track", "method"]);
    table.numbers(groups.iter().map(|(name, _)| (*name).to_owned()));
    let podiums_of = |track| -> Vec<BestTwo> {
        let best_two =
            |(_, key): &(&str, K)| BestTwo::of_track(board, track, Metric::Miou, |method| miou(method, key));
        groups.iter().map(best_two).collect()
    };
    let best_twos: BTreeMap<Track, Vec<BestTwo>> =
        board.tracks().map(|(track, _)| (track, podiums_of(track))).collect();
    for method in &board.methods {
        let mut cells =
            vec![rank(method), method.track.title().to_owned(), linked(&method.name, &method.link)];
        let best_twos = method.ranked_in().and_then(|track| best_twos.get(&track));
        for (index, (_, key)) in groups.iter().enumerate() {
            let best_two = best_twos.map(|best_twos| best_twos[index]).unwrap_or_default();
            cells.push(or_dash(miou(method, key), |value| number(value, best_two.emphasis(value), None)));
        }
        table.row(cells);
    }
    format!("## {title}\n\n{}.\n\n{}", escape(&board.heading.line()), table.finish())
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

/// A name that leads to paper or code, where they have an address.
pub(crate) fn linked(name: &str, link: &str) -> String {
    let name = escape(name);
    if is_plain_url(link) { format!("[{name}]({link})") } else { name }
}

/// A percentage; a dash where there is none.
pub(crate) fn hundredths(value: Option<f64>) -> String {
    or_dash(value, |value| format!("{value:.2}"))
}

/// A percentage, set off from others, with its interval where it has one.
pub(crate) fn number(value: f64, emphasis: Emphasis, interval: Option<[f64; 2]>) -> String {
    let value = match emphasis {
        Emphasis::Best => format!("**{value:.2}**"),
        Emphasis::Second => format!("*{value:.2}*"),
        Emphasis::None => format!("{value:.2}"),
    };
    value + &self::interval(interval)
}

/// ` (40.1 to 50.3)`; nothing where there is none.
fn interval(found: Option<[f64; 2]>) -> String {
    found.map(|[low, high]| format!(" ({low:.1} to {high:.1})")).unwrap_or_default()
}

/// What an optional value says; a dash where there is none.
pub(crate) fn or_dash<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), text)
}

fn seconds(method: &Method) -> String {
    or_dash(method.seconds, seconds_text)
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
    fn pages_are_the_hand_made_ones() {
        let mut one_scene = sample::tracks();
        (one_scene.heading.scenes, one_scene.comparisons) = (1, Vec::new());
        for (name, board) in [
            ("hand_made", sample::hand_made()),
            ("tracks", sample::tracks()),
            ("one_scene", one_scene),
            ("one_method", sample::board_of(4, vec![sample::method("a", 4, 50.0)])),
        ] {
            insta::assert_snapshot!(name, page(&board, &[]));
        }
    }

    #[test]
    fn every_row_of_a_table_has_as_many_cells_as_its_head() {
        let page = page(&sample::board(14), &[]);
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        let mut expected = None;
        for line in page.lines() {
            expected = line.starts_with('|').then(|| expected.unwrap_or_else(|| cells(line)));
            assert!(expected.is_none_or(|expected| cells(line) == expected), "{line}");
        }
    }
}
