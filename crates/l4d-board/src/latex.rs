//! Tables for papers: `tabular` environments that need `booktabs` and nothing else.

use crate::board::Board;
use crate::layout::{Cell, Layout, Line, METRICS, PUBLISHED_TITLE};
use crate::ranking::Emphasis;

/// The table, ready for `\input`.
pub(crate) fn tabular(layout: &Layout, board: &Board) -> String {
    let numbers = layout.columns.len() * METRICS.len();
    let mut text = format!(
        "% {}: {}\n% Percent, macro means over queries.{}\n% A dagger marks methods that are not ranked.\n\
         % Needs \\usepackage{{booktabs}}.\n\\begin{{tabular}}{{l{}}}\n\\toprule\n",
        comment(layout.title),
        comment(&board.heading.line()),
        reading_note(board),
        "r".repeat(numbers)
    );
    let heads = layout.columns.iter().map(|column| format!("\\multicolumn{{2}}{{c}}{{{}}}", escape(column)));
    text.push_str(&row(std::iter::once(String::new()).chain(heads)));
    let rules = (0..layout.columns.len())
        .map(|column| format!("\\cmidrule(lr){{{}-{}}}", 2 * column + 2, 2 * column + 3));
    text.push_str(&format!("{}\n", rules.collect::<String>()));
    let titles = layout.columns.iter().flat_map(|_| METRICS.map(|metric| metric.title().to_owned()));
    text.push_str(&row(std::iter::once("method".to_owned()).chain(titles)));
    let title_row = |title: &str| row(std::iter::once(span(numbers + 1, title)));
    for (track, lines) in layout.groups() {
        text.push_str("\\midrule\n");
        text.extend(track.map(|track| title_row(&format!("Track: {}", track.title()))));
        // Intervals are below their values: room between rows says which belong together.
        let lines: Vec<String> = lines.iter().map(|line| line_text(layout, line)).collect();
        text.push_str(&lines.join("\\addlinespace[2pt]\n"));
    }
    if !layout.published.is_empty() {
        text.push_str("\\midrule\n");
        text.push_str(&title_row(PUBLISHED_TITLE));
        layout.published.iter().for_each(|line| text.push_str(&line_text(layout, line)));
    }
    text.push_str("\\bottomrule\n\\end{tabular}\n");
    text
}

/// What bold letters and small ones mean, where there are any.
fn reading_note(board: &Board) -> &'static str {
    match (board.is_of_one_scene(), board.has_rivals()) {
        (true, _) => " One scene: no intervals, and no method is called best.",
        (false, true) => {
            " Below, 95 % intervals clustered by scene.\n% Best bold, second best underlined among the ranked methods of a track."
        }
        (false, false) => " Below, 95 % intervals clustered by scene.",
    }
}

/// A line across all columns.
fn span(columns: usize, title: &str) -> String {
    format!("\\multicolumn{{{columns}}}{{l}}{{\\emph{{{title}}}}}")
}

fn row(cells: impl Iterator<Item = String>) -> String {
    format!("{} \\\\\n", cells.collect::<Vec<_>>().join(" & "))
}

fn line_text(layout: &Layout, line: &Line) -> String {
    let mark = if line.unranked_because.is_empty() { "" } else { "$^{\\dagger}$" };
    let cells = layout.cells(line).map(|found| found.map_or_else(|| "--".to_owned(), cell_text));
    row(std::iter::once(format!("{}{mark}", escape(&line.label))).chain(cells))
}

fn cell_text((cell, emphasis): (Cell, Emphasis)) -> String {
    let value = match emphasis {
        Emphasis::Best => format!("\\textbf{{{:.2}}}", cell.value),
        Emphasis::Second => format!("\\underline{{{:.2}}}", cell.value),
        Emphasis::None => format!("{:.2}", cell.value),
    };
    match cell.interval {
        // Aligned at its first line: a name is beside the value, not beside the interval.
        Some([low, high]) => format!(
            "\\begin{{tabular}}[t]{{@{{}}r@{{}}}}{value}\\\\[-4pt]{{\\tiny {low:.1}--{high:.1}}}\\end{{tabular}}"
        ),
        None => value,
    }
}

/// Text that LaTeX prints as it is. What it has no command for becomes a question mark: method names are ASCII.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', character]),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '\\' => escaped.push_str("\\textbackslash{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            // A straight one is not in the fonts that LaTeX starts with.
            '"' => escaped.push_str("{''}"),
            // Two would join into a dash, and a row that starts with one of these would be read as an argument of `\\`.
            '-' if escaped.ends_with('-') => escaped.push_str("{}-"),
            '[' | '*' => escaped.extend(['{', character, '}']),
            ' '..='~' => escaped.push(character),
            control if control.is_control() => escaped.push(' '),
            _ => escaped.push('?'),
        }
    }
    escaped
}

/// Text for a comment: one line of ASCII.
fn comment(text: &str) -> String {
    text.chars().map(|character| if character == '·' { '-' } else { character }).map(ascii).collect()
}

fn ascii(character: char) -> char {
    match character {
        ' '..='~' => character,
        _ => ' ',
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout;
    use crate::sample;

    fn tables(board: &Board) -> Vec<String> {
        layout::all(board).iter().map(|layout| tabular(layout, board)).collect()
    }

    /// Cells of a row; those that span several count as many.
    fn cells(line: &str) -> usize {
        let spans = line.split("\\multicolumn{").skip(1);
        let wide: usize =
            spans.map(|rest| rest.split('}').next().unwrap().parse::<usize>().unwrap() - 1).sum();
        line.replace("\\&", "").matches('&').count() + 1 + wide
    }

    #[test]
    fn every_row_has_as_many_cells_as_the_table_has_columns() {
        for board in [sample::hand_made(), sample::board(14), sample::long_names(), sample::tracks()] {
            for text in tables(&board) {
                let head = text.lines().find(|line| line.starts_with("\\begin{tabular}")).unwrap();
                let columns = head.trim_start_matches("\\begin{tabular}{").trim_end_matches('}').len();
                let rows: Vec<&str> = text.lines().filter(|line| line.ends_with(" \\\\")).collect();
                assert!(rows.len() > 3 && rows.iter().all(|row| cells(row) == columns), "{text}");
                assert_eq!(text.matches('{').count(), text.matches('}').count());
                assert!(text.is_ascii(), "{text}");
            }
        }
    }

    #[test]
    fn tables_are_the_hand_made_ones() {
        insta::assert_snapshot!("hand_made", tables(&sample::hand_made()).join("\n"));
        insta::assert_snapshot!("tracks", tables(&sample::tracks())[0]);
        assert!(!tables(&sample::board(1))[0].contains("textbf"), "one method is not better than others");
    }

    #[test]
    #[ignore = "needs pdflatex, or another LaTeX in L4D_LATEX, with booktabs"]
    fn latex_takes_the_tables() {
        let program = std::env::var_os("L4D_LATEX").unwrap_or_else(|| "pdflatex".into());
        let printable: String = (' '..='~').collect();
        let mut texts = tables(&sample::hand_made());
        for label in [printable.as_str(), "[x] first", "*", "--- ''``", "a_b--c.d-"] {
            texts.push(format!(
                "\\begin{{tabular}}{{lr}}\n{}\\end{{tabular}}\n",
                row([label; 2].map(escape).into_iter()).repeat(2)
            ));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tables.tex");
        let head = "\\documentclass{article}\n\\usepackage{booktabs}\n\\begin{document}\n";
        std::fs::write(&path, format!("{head}{}\\end{{document}}\n", texts.join("\n\n\\clearpage\n")))
            .unwrap();
        let mut latex = std::process::Command::new(program);
        let run = latex
            .args(["-halt-on-error", "-interaction=nonstopmode", "tables.tex"])
            .current_dir(folder.path());
        let output = run.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }

    #[test]
    fn names_stay_text() {
        assert_eq!(escape("a_b&c%$#{}"), "a\\_b\\&c\\%\\$\\#\\{\\}");
        assert_eq!(escape("~^\\é\n"), "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}? ");
        assert_eq!(escape("[a]--*b\"<|>"), "{[}a]-{}-{*}b{''}\\textless{}\\textbar{}\\textgreater{}");
        assert_eq!(comment("a · b\n\\end{x}é"), "a - b \\end{x} ");
    }
}
