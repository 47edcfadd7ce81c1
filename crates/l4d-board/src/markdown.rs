//! `leaderboard.md`: the page that a repository shows.

use l4d_data::{Category, Scale};

use crate::rank::{Board, Podium};
use crate::row::{BoardRow, Metric};
use crate::terminal::seconds_text;

/// The page; `figures` are (path, what it shows) in order.
pub(crate) fn page(board: &Board, figures: &[(String, &str)]) -> String {
    let mut page = format!("# Leaderboard\n\n{}.\n\n", escape(&board.heading.line()));
    page.push_str(
        "Percentages; macro means over queries. Ranked by mIoU; equal printed values share a rank. \
         **Best** and *second best* among ranked methods.\n\n",
    );
    page.push_str(&ranked_table(board));
    page.push_str(&unranked_table(board));
    let categories: Vec<_> = Category::ALL.iter().map(|key| (key.as_str(), key)).collect();
    page.push_str(&group_table("mIoU per category", board, &categories, |row, key| {
        row.scores.categories.get(key)?.miou
    }));
    let scales: Vec<_> = Scale::ALL.iter().map(|key| (key.as_str(), key)).collect();
    page.push_str(&group_table("mIoU per scale", board, &scales, |row, key| {
        row.scores.scales.get(key)?.miou
    }));
    page.push_str(&other_tables(board));
    page.push_str("## Figures\n\n");
    for (path, caption) in figures {
        page.push_str(&format!("![{caption}]({path})\n\n"));
    }
    page.push_str(
        "Every number stands in `leaderboard.csv`, `per_category.csv`, `per_scale.csv` and `per_scene.csv`.\n",
    );
    page
}

fn ranked_table(board: &Board) -> String {
    if board.ranked.is_empty() {
        return "No method is ranked.\n\n".to_owned();
    }
    let mut table = Table::new(&["#", "method", "version"]);
    table.numbers(Metric::ALL.map(metric_title));
    table.numbers(["seconds"]);
    for entry in &board.ranked {
        let mut cells = vec![entry.rank.to_string(), method(&entry.row), escape(&entry.row.version)];
        cells.extend(
            Metric::ALL.map(|metric| honoured(metric.of(&entry.row.scores.headline), board.podium(metric))),
        );
        cells.push(seconds(&entry.row));
        table.row(cells);
    }
    table.finish()
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
        cells.extend(Metric::ALL.map(|metric| plain(metric.of(&entry.row.scores.headline))));
        cells.push(seconds(&entry.row));
        table.row(cells);
    }
    format!("## Not ranked, shown for scale\n\n{}", table.finish())
}

fn group_table<K>(
    title: &str,
    board: &Board,
    groups: &[(&str, &K)],
    miou: impl Fn(&BoardRow, &K) -> Option<f64>,
) -> String {
    let mut table = Table::new(&["#", "method"]);
    table.numbers(groups.iter().map(|(name, _)| (*name).to_owned()));
    let podiums: Vec<Podium> = groups
        .iter()
        .map(|(_, key)| {
            Podium::of(board.ranked.iter().filter_map(|entry| miou(&entry.row, key)), Metric::Miou)
        })
        .collect();
    for (rank, row) in board.rows() {
        let mut cells = vec![rank.map_or_else(|| "–".to_owned(), |rank| rank.to_string()), method(row)];
        for ((_, key), &podium) in groups.iter().zip(&podiums) {
            let value = miou(row, key);
            cells.push(if rank.is_some() { honoured(value, podium) } else { plain(value) });
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

struct Table {
    titles: Vec<String>,
    text_columns: usize,
    rows: String,
}

impl Table {
    fn new(text_titles: &[&str]) -> Self {
        let titles: Vec<String> = text_titles.iter().map(|&title| title.to_owned()).collect();
        Self { text_columns: titles.len(), titles, rows: String::new() }
    }

    fn numbers<S: Into<String>>(&mut self, titles: impl IntoIterator<Item = S>) {
        self.titles.extend(titles.into_iter().map(Into::into));
    }

    fn row(&mut self, cells: Vec<String>) {
        self.rows.push_str(&format!("| {} |\n", cells.join(" | ")));
    }

    fn finish(self) -> String {
        let rule = |index| if index < self.text_columns { "---" } else { "---:" };
        let rules: Vec<&str> = (0..self.titles.len()).map(rule).collect();
        format!("| {} |\n| {} |\n{}\n", self.titles.join(" | "), rules.join(" | "), self.rows)
    }
}

fn metric_title(metric: Metric) -> String {
    format!("{} {}", metric.title(), if metric.higher_is_better() { "↑" } else { "↓" })
}

fn method(row: &BoardRow) -> String {
    let name = escape(&row.name);
    if is_plain_url(&row.link) { format!("[{name}]({})", row.link) } else { name }
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
        let page = page(&sample::hand_made(), &[]);
        let line = |start: &str| {
            page.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{start}\n{page}"))
        };
        assert!(line("| 1 | alpha |").contains("| **62.50** |"), "{}", line("| 1 | alpha |"));
        assert!(line("| 3 | gamma |").contains("| *50.00* |"), "{}", line("| 3 | gamma |"));
        assert!(line("| oracle |").contains("used ground truth | 100.00 |"));
    }

    #[test]
    fn every_row_of_a_table_has_as_many_cells_as_its_head() {
        let page = page(&sample::board(14), &[]);
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
