//! The board as aligned text for a terminal, at most [`WIDTH`] columns wide.

use l4d_data::Category;
use l4d_data::results::Track;
use l4d_score::cluster::FEW_SCENES;

use crate::rank::Board;
use crate::row::{BoardRow, Metric};
use crate::statistics::{Statistics, p_text};

/// No line is wider.
pub(crate) const WIDTH: usize = 100;

const HEADLINES: [Metric; 4] = [Metric::Miou, Metric::Macc, Metric::TubeIou, Metric::Select];
const NUMBER_WIDTH: usize = 8;
const RANK_WIDTH: usize = 4;
const SECONDS_WIDTH: usize = 9;
const UNRANKED: &str = "not ranked, shown for scale";
/// In place of intervals and tests.
pub(crate) const ONE_SCENE: &str =
    "One scene says nothing of others: no intervals, no p values, and no method is called best.";

/// The board as lines of text: ranked methods, then those that are only shown, then other boards'.
pub fn text_table(board: &Board) -> String {
    let numbers = HEADLINES.len() + Category::ALL.len();
    let room = WIDTH - RANK_WIDTH - 1 - numbers * NUMBER_WIDTH - SECONDS_WIDTH;
    let foreign = board.others.iter().flat_map(|other| &other.rows);
    let longest =
        board.rows().map(|(_, row)| row).chain(foreign).map(|row| row.name.len()).max().unwrap_or(0);
    let name_width = longest.clamp("method".len(), room);

    let mut lines = wrap(&board.heading.line(), WIDTH);
    lines.push(String::new());
    lines.extend(header(name_width));
    if board.ranked.is_empty() {
        lines.push("   - no method is ranked".to_owned());
    }
    for (index, (track, group)) in board.tracks().enumerate() {
        lines.extend((index > 0).then(String::new));
        lines.push(track_line(track));
        for entry in group {
            lines.extend(row_lines(&entry.rank.to_string(), &entry.row, name_width));
        }
    }
    if !board.unranked.is_empty() {
        lines.push(String::new());
        lines.push(UNRANKED.to_owned());
        for entry in &board.unranked {
            lines.extend(row_lines("-", &entry.row, name_width));
            lines.push(format!("{:RANK_WIDTH$} ({})", "", entry.reason()));
        }
    }
    for other in &board.others {
        lines.push(String::new());
        lines.extend(wrap(&format!("not of this board: {}", other.line()), WIDTH));
        for row in &other.rows {
            lines.extend(row_lines("-", row, name_width));
        }
    }
    lines.join("\n")
}

/// What the means of the board can tell, as lines of text: intervals, and by how much each method is ahead of the next
/// of its track. Empty without a method whose counts were read.
pub fn text_statistics(board: &Board, statistics: &Statistics) -> String {
    const VALUE_WIDTH: usize = 22;
    const SHORT_WIDTH: usize = 9;
    let neighbours = statistics.neighbours(board);
    let room = WIDTH - RANK_WIDTH - 1 - 2 * VALUE_WIDTH - 2 * SHORT_WIDTH;
    let longest = statistics.methods.iter().map(|method| method.name.len()).max().unwrap_or(0);
    if longest == 0 {
        return String::new();
    }
    if board.is_of_one_scene() {
        return ONE_SCENE.to_owned();
    }
    let name_width = longest.clamp("method".len(), room);
    let tests = match neighbours.is_empty() {
        true => String::new(),
        false => {
            format!("{:>VALUE_WIDTH$}{:>SHORT_WIDTH$}{:>SHORT_WIDTH$}", "ahead of the next", "p", "detect.")
        }
    };
    let mut lines = vec![format!(
        "{:>RANK_WIDTH$} {:name_width$}{:>VALUE_WIDTH$}{tests}",
        "rank", "method", "mIoU (95 % interval)"
    )];
    let mut is_rough = false;
    let mut group = None;
    for (index, ((rank, row), method)) in board.rows().zip(&statistics.methods).enumerate() {
        let track = rank.map(|_| row.track);
        if track != group || index == 0 {
            lines.push(track.map_or_else(|| UNRANKED.to_owned(), track_line));
            group = track;
        }
        let interval = |[low, high]: [f64; 2]| format!(" ({low:.1} to {high:.1})");
        let with_interval =
            |text: String, found: Option<[f64; 2]>| text + &found.map(interval).unwrap_or_default();
        is_rough |= row.miou.is_some_and(|found| found.interval.is_some() && found.is_of_few_scenes());
        let own = row.miou.map(|found| with_interval(format!("{:.2}", found.value), found.interval));
        let pair = neighbours.iter().find(|pair| pair.first == index);
        let [ahead, p, detectable] = pair.map_or_else(Default::default, |pair| {
            let found = &pair.comparison;
            is_rough |= found.difference.is_of_few_scenes();
            [
                with_interval(format!("{:+.2}", found.difference.value), found.difference.interval),
                p_text(pair.holm_p),
                found.detectable.map(|points| format!("{points:.2}")).unwrap_or_default(),
            ]
        });
        let rank = rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string());
        let mut name_lines = split(&method.name, name_width).into_iter();
        let first = name_lines.next().unwrap_or_default();
        let line = format!(
            "{rank:>RANK_WIDTH$} {first:name_width$}{:>VALUE_WIDTH$}{ahead:>VALUE_WIDTH$}{p:>SHORT_WIDTH$}{detectable:>SHORT_WIDTH$}",
            own.unwrap_or_else(|| "-".to_owned())
        );
        lines.push(line.trim_end().to_owned());
        lines.extend(name_lines.map(|rest| format!("{:RANK_WIDTH$} {rest}", "")));
    }
    let mut about = "Intervals are clustered by scene.".to_owned();
    if !neighbours.is_empty() {
        about.push_str(
            " p: by flipping the signs of scenes, corrected for all pairs of the track (Holm); detect.: a true difference \
             of so many points would be found four times in five.",
        );
    }
    lines.extend(wrap(&about, WIDTH));
    if is_rough {
        lines.push(format!("Fewer than {FEW_SCENES} scenes: intervals may be too narrow."));
    }
    if statistics.left_out > 0 {
        lines.push(format!("{} more methods are not compared.", statistics.left_out));
    }
    lines.join("\n")
}

/// Above the methods that are ranked with each other.
fn track_line(track: Track) -> String {
    format!("track: {}", track.title())
}

fn header(name_width: usize) -> Vec<String> {
    let metrics = ["mIoU", "mAcc", "tube", "select"].map(|name| format!("{name:>NUMBER_WIDTH$}")).concat();
    let categories = ["attrib.", "action", "spatial", "inter."].map(|name| format!("{name:>NUMBER_WIDTH$}"));
    let (seconds, method) = (format!("{:>SECONDS_WIDTH$}", "seconds"), "method");
    let over = format!("{:1$}", "", RANK_WIDTH + 1 + name_width + HEADLINES.len() * NUMBER_WIDTH);
    vec![
        format!("{over}{:>1$}", "mIoU per category", Category::ALL.len() * NUMBER_WIDTH),
        format!("{:>RANK_WIDTH$} {method:name_width$}{metrics}{}{seconds}", "rank", categories.concat()),
    ]
}

fn row_lines(rank: &str, row: &BoardRow, name_width: usize) -> Vec<String> {
    let headlines = HEADLINES.map(|metric| metric.of(&row.scores.headline));
    let categories =
        Category::ALL.map(|category| row.scores.categories.get(&category).and_then(|metrics| metrics.miou));
    let numbers: String = headlines.iter().chain(&categories).map(|&value| number(value)).collect();
    let seconds = row.seconds.map_or_else(|| "-".to_owned(), seconds_text);
    let mut name_lines = split(&row.name, name_width).into_iter();
    let first = name_lines.next().unwrap_or_default();
    let mut lines =
        vec![format!("{rank:>RANK_WIDTH$} {first:name_width$}{numbers}{seconds:>SECONDS_WIDTH$}")];
    lines.extend(name_lines.map(|rest| format!("{:RANK_WIDTH$} {rest}", "")));
    lines
}

fn number(value: Option<f64>) -> String {
    match value {
        Some(value) => format!("{value:>NUMBER_WIDTH$.2}"),
        None => format!("{:>NUMBER_WIDTH$}", "-"),
    }
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
        let seam = rest[..width].rfind(['_', '-', '.']).map(|at| at + 1).filter(|&at| at > width / 2);
        let (piece, tail) = rest.split_at(seam.unwrap_or(width));
        pieces.push(piece);
        rest = tail;
    }
    pieces.push(rest);
    pieces
}

/// Breaks a sentence at spaces so that no line is wider than `width` characters.
fn wrap(sentence: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in sentence.split(' ') {
        let line = lines.last_mut().expect("starts with one line");
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        for board in [sample::board(1), sample::board(14), sample::long_names(), sample::tracks()] {
            let text = text_table(&board);
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
            }
            for (_, row) in board.rows() {
                let glued: String = text.split_whitespace().collect();
                let start: String = row.name.chars().take(20).collect();
                assert!(glued.contains(&start), "{} is not in\n{text}", row.name);
            }
        }
    }

    #[test]
    fn no_line_of_statistics_is_wider_than_the_terminal() {
        for board in [sample::board(1), sample::board(14), sample::long_names(), sample::tracks()] {
            let text = text_statistics(&board, &sample::statistics(&board));
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
            }
        }
        let board = sample::hand_made();
        let text = text_statistics(&board, &sample::statistics(&board));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "rank method  mIoU (95 % interval)     ahead of the next        p  detect.");
        assert_eq!(lines[1], "track: colour");
        assert_eq!(lines[2], "   1 alpha   62.50 (58.0 to 66.5)   +0.00 (-4.5 to 4.5)   1.0000     6.20");
        assert_eq!(lines[5], UNRANKED);
        assert_eq!(lines[7], "   - half    80.00 (75.5 to 84.0)", "a partial method is compared with none");
        assert_eq!(text_statistics(&board, &Statistics::default()), "");
    }

    #[test]
    fn tracks_are_apart_and_not_tested_against_each_other() {
        let board = sample::tracks();
        let text = text_table(&board);
        let starts: Vec<&str> = text
            .lines()
            .skip(4)
            .map(|line| line.split("  ").find(|part| !part.is_empty()).unwrap_or_default().trim())
            .collect();
        let expected = [
            "track: colour",
            "1 bright",
            "2 dim",
            "",
            "track: colour + depth",
            "1 deeper",
            "2 deep",
            "",
            UNRANKED,
            "- oracle",
            "(baseline)",
        ];
        assert_eq!(starts, expected, "{text}");
        let text = text_statistics(&board, &sample::statistics(&board));
        let line = |start: &str| text.lines().find(|line| line.contains(start)).unwrap();
        assert!(line("deeper").contains("+5.00") && line("bright").contains("+10.00"), "{text}");
        assert!(!line("dim").contains('+') && !line("2 deep ").contains('+'), "{text}");
    }

    #[test]
    fn one_scene_and_one_method_have_no_p() {
        let mut board = sample::board(14);
        board.heading.scenes = 1;
        assert_eq!(text_statistics(&board, &sample::statistics(&board)), ONE_SCENE);
        let board = sample::board(1);
        let text = text_statistics(&board, &sample::statistics(&board));
        assert!(text.contains("rank method") && !text.contains("p:") && !text.contains("detect."), "{text}");
    }

    #[test]
    fn long_names_break_at_seams_and_stay_whole() {
        assert_eq!(split("short", 21), ["short"]);
        assert_eq!(
            split("panopticquery-robust-without-consensus", 21),
            ["panopticquery-robust-", "without-consensus"]
        );
        assert_eq!(split(&"x".repeat(45), 21).concat(), "x".repeat(45));
    }

    #[test]
    fn columns_line_up_and_say_what_is_missing() {
        let text = text_table(&sample::hand_made());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0],
            "Panoptic-L4D 1.0.0 · protocol l4d · profile small · 4 queries, 1 verified by people"
        );
        assert_eq!(
            lines[3],
            "rank method       mIoU    mAcc    tube  select attrib.  action spatial  inter.  seconds"
        );
        assert_eq!(
            lines[5],
            "   1 alpha       62.50   62.50   62.50   62.50   62.50   62.50   62.50   62.50     12.3"
        );
        assert_eq!(
            lines[7],
            "   3 gamma       50.00   50.00   50.00       -   50.00   50.00       -   50.00        -"
        );
        assert!(text.contains("   - oracle     100.00  100.00"), "{text}");
        assert!(text.contains("     (baseline, used ground truth)\n"), "{text}");
        assert!(text.contains("not of this board: benchmark 1.0.0 · protocol l4d · profile tiny"), "{text}");
    }
}
