//! The board as aligned text for a terminal, at most [`WIDTH`] columns wide. Ranks and compares nothing itself.

use l4d_data::Category;
use l4d_data::results::Track;
use l4d_score::cluster::FEW_SCENES;
use l4d_score::table::wrap;
use l4d_score::{Estimate, Metric};

use crate::board::{Board, Method};
use crate::tables::p_text;

/// Of a line, columns.
const WIDTH: usize = 100;

const HEADLINES: [Metric; 4] = [Metric::Miou, Metric::Macc, Metric::TubeIou, Metric::Select];
const NUMBER_WIDTH: usize = 8;
const RANK_WIDTH: usize = 4;
const SECONDS_WIDTH: usize = 9;
const UNRANKED: &str = "not ranked, shown for scale";
/// Printed in place of intervals and tests.
pub(crate) const ONE_SCENE: &str =
    "One scene says nothing of others: no intervals, no p values, and no method is called best.";

/// The board as lines of text: ranked methods, then those that are only shown.
pub fn text_table(board: &Board) -> String {
    let cells_width = (HEADLINES.len() + Category::ALL.len()) * NUMBER_WIDTH + SECONDS_WIDTH;
    let name_width = name_width(board.methods.iter(), cells_width);
    let mut lines = wrap(&board.heading.line(), WIDTH);
    let indent = RANK_WIDTH + 1 + name_width + HEADLINES.len() * NUMBER_WIDTH;
    let categories_width = Category::ALL.len() * NUMBER_WIDTH;
    lines.push(String::new());
    lines.push(format!("{:indent$}{:>categories_width$}", "", "mIoU per category"));
    let titles = ["mIoU", "mAcc", "tube", "select", "attrib.", "action", "spatial", "inter."];
    let titles = titles.map(|title| format!("{title:>NUMBER_WIDTH$}")).concat();
    lines.extend(row("rank", "method", name_width, &format!("{titles}{:>SECONDS_WIDTH$}", "seconds")));
    if board.ranked().is_empty() {
        lines.push("   - no method is ranked".to_owned());
    }
    let method_row = |method: &Method| row(&rank(method), &method.name, name_width, &numbers(method));
    for (index, (track, methods)) in board.tracks().enumerate() {
        lines.extend((index > 0).then(String::new));
        lines.push(track_line(track));
        lines.extend(methods.iter().flat_map(method_row));
    }
    if !board.unranked().is_empty() {
        lines.extend([String::new(), UNRANKED.to_owned()]);
        for method in board.unranked() {
            lines.extend(method_row(method));
            lines.push(format!("{:RANK_WIDTH$} ({})", "", method.why_unranked()));
        }
    }
    lines.join("\n")
}

/// How sure the order of the board is, as lines of text: the interval of each mIoU, and how far each method is ahead of
/// the next of its track.
pub fn text_statistics(board: &Board) -> String {
    const VALUE_WIDTH: usize = 22;
    const SHORT_WIDTH: usize = 9;
    if board.is_of_one_scene() {
        return ONE_SCENE.to_owned();
    }
    let (compared, neighbours) = (board.compared(), board.neighbours());
    let name_width = name_width(compared.iter(), 2 * VALUE_WIDTH + 2 * SHORT_WIDTH);
    let line = |rank: &str, name: &str, [own, ahead, p, detectable]: [&str; 4]| {
        let values = format!("{own:>VALUE_WIDTH$} {ahead:>width$}", width = VALUE_WIDTH - 1);
        row(rank, name, name_width, &format!("{values}{p:>SHORT_WIDTH$}{detectable:>SHORT_WIDTH$}"))
    };
    let tests = if neighbours.is_empty() { [""; 3] } else { ["ahead of the next", "p", "detect."] };
    let mut lines = line("rank", "method", ["mIoU (95 % interval)", tests[0], tests[1], tests[2]]);
    let mut is_rough = false;
    let mut interval = |found: &Estimate| {
        is_rough |= found.interval.is_some() && found.is_of_few_scenes();
        found.interval.map(|[low, high]| format!(" ({low:.1} to {high:.1})")).unwrap_or_default()
    };
    for (index, method) in compared.iter().enumerate() {
        let track = method.ranked_in();
        if index == 0 || compared[index - 1].ranked_in() != track {
            lines.push(track.map_or_else(|| UNRANKED.to_owned(), track_line));
        }
        let own = method.miou.map(|found| format!("{:.2}{}", found.value, interval(&found)));
        let pair = neighbours.iter().find(|pair| pair.first == index);
        let [ahead, p, detectable] = pair.map_or_else(Default::default, |pair| {
            let found = &pair.comparison;
            [
                format!("{:+.2}{}", found.difference.value, interval(&found.difference)),
                p_text(pair.holm_p),
                found.detectable.map(|points| format!("{points:.2}")).unwrap_or_default(),
            ]
        });
        let own = own.unwrap_or_else(|| "-".to_owned());
        lines.extend(line(&rank(method), &method.name, [&own, &ahead, &p, &detectable]));
    }
    let mut legend = "Intervals are clustered by scene.".to_owned();
    if !neighbours.is_empty() {
        legend.push_str(
            " p: by flipping the signs of scenes, corrected for all pairs of the track (Holm); detect.: a true difference \
             of so many points would be found four times in five.",
        );
    }
    lines.extend(wrap(&legend, WIDTH));
    if is_rough {
        lines.push(format!("Fewer than {FEW_SCENES} scenes: intervals may be too narrow."));
    }
    let left_out = board.methods.len() - compared.len();
    if left_out > 0 {
        lines.push(format!("{left_out} more methods are not compared."));
    }
    lines.join("\n")
}

/// The line above the methods of a track.
fn track_line(track: Track) -> String {
    format!("track: {}", track.title())
}

fn rank(method: &Method) -> String {
    method.rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string())
}

/// Width of the longest name, at most what the cells leave of a line; columns.
fn name_width<'a>(methods: impl Iterator<Item = &'a Method>, cells_width: usize) -> usize {
    let longest = methods.map(|method| method.name.len()).max().unwrap_or(0);
    longest.clamp("method".len(), WIDTH - RANK_WIDTH - 1 - cells_width)
}

/// A row of a table; a name that is too long is continued on the lines below.
fn row(rank: &str, name: &str, name_width: usize, cells: &str) -> Vec<String> {
    let mut pieces = split(name, name_width).into_iter();
    let first = pieces.next().unwrap_or_default();
    let line = format!("{rank:>RANK_WIDTH$} {first:name_width$}{cells}");
    let rest = pieces.map(|piece| format!("{:RANK_WIDTH$} {piece}", ""));
    std::iter::once(line.trim_end().to_owned()).chain(rest).collect()
}

fn numbers(method: &Method) -> String {
    let headlines = HEADLINES.map(|metric| method.headline(metric));
    let categories = Category::ALL.map(|category| method.scores.categories.get(&category)?.get(Metric::Miou));
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
    let numbers = headlines.into_iter().chain(categories).map(number);
    let seconds = method.seconds.map_or_else(|| "-".to_owned(), seconds_text);
    let numbers: String = numbers.map(|number| format!("{number:>NUMBER_WIDTH$}")).collect();
    format!("{numbers}{seconds:>SECONDS_WIDTH$}")
}

/// Seconds in at most eight characters.
pub(crate) fn seconds_text(seconds: f64) -> String {
    if seconds < 100_000.0 { format!("{seconds:.1}") } else { format!("{seconds:.1e}") }
}

/// Cuts a name into pieces of at most `width` bytes, after `_`, `-` or `.` where one is near. Names are ASCII.
fn split(name: &str, width: usize) -> Vec<&str> {
    let mut pieces = Vec::new();
    let mut rest = name;
    while rest.len() > width {
        let separator_end =
            rest[..width].rfind(['_', '-', '.']).map(|at| at + 1).filter(|&at| at > width / 2);
        let (piece, tail) = rest.split_at(separator_end.unwrap_or(width));
        pieces.push(piece);
        rest = tail;
    }
    pieces.push(rest);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn tables_fit_the_width_and_match_their_snapshots() {
        let mut one_scene = sample::board(14);
        one_scene.heading.scenes = 1;
        assert_eq!(text_statistics(&one_scene), ONE_SCENE);
        for (name, board) in [
            ("hand_made", sample::hand_made()),
            ("tracks", sample::tracks()),
            ("one_method", sample::board(1)),
            ("long_names", sample::long_names()),
        ] {
            let text = format!("{}\n\n{}", text_table(&board), text_statistics(&board));
            assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
            insta::assert_snapshot!(name, text);
        }
    }

    #[test]
    fn long_names_break_after_separators_and_lose_nothing() {
        assert_eq!(split("short", 21), ["short"]);
        assert_eq!(
            split("panopticquery-robust-without-consensus", 21),
            ["panopticquery-robust-", "without-consensus"]
        );
        assert_eq!(split(&"x".repeat(45), 21).concat(), "x".repeat(45));
    }
}
