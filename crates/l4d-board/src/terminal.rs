//! The board as aligned text for a terminal, at most [`WIDTH`] columns wide.

use l4d_data::Category;
use l4d_data::results::Track;
use l4d_score::Metric;
use l4d_score::cluster::FEW_SCENES;

use crate::board::{Board, Method};
use crate::tables::p_text;

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
    let foreign = board.others.iter().flat_map(|other| &other.methods);
    let longest = board.methods.iter().chain(foreign).map(|method| method.name.len()).max().unwrap_or(0);
    let name_width = longest.clamp("method".len(), room);

    let mut lines = wrap(&board.heading.line(), WIDTH);
    lines.push(String::new());
    lines.extend(header(name_width));
    if board.ranked().is_empty() {
        lines.push("   - no method is ranked".to_owned());
    }
    for (index, (track, methods)) in board.tracks().enumerate() {
        lines.extend((index > 0).then(String::new));
        lines.push(track_line(track));
        methods.iter().for_each(|method| lines.extend(row_lines(method, name_width)));
    }
    if !board.unranked().is_empty() {
        lines.push(String::new());
        lines.push(UNRANKED.to_owned());
        for method in board.unranked() {
            lines.extend(row_lines(method, name_width));
            lines.push(format!("{:RANK_WIDTH$} ({})", "", method.why_unranked()));
        }
    }
    for other in &board.others {
        lines.push(String::new());
        lines.extend(wrap(&format!("not of this board: {}", other.line()), WIDTH));
        other.methods.iter().for_each(|method| lines.extend(row_lines(method, name_width)));
    }
    lines.join("\n")
}

/// What the means of the board can tell, as lines of text: intervals, and by how much each method is ahead of the next
/// of its track.
pub fn text_statistics(board: &Board) -> String {
    const VALUE_WIDTH: usize = 22;
    const SHORT_WIDTH: usize = 9;
    let neighbours = board.neighbours();
    let room = WIDTH - RANK_WIDTH - 1 - 2 * VALUE_WIDTH - 2 * SHORT_WIDTH;
    let longest = board.compared().iter().map(|method| method.name.len()).max().unwrap_or(0);
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
    for (index, method) in board.compared().iter().enumerate() {
        let track = method.ranked_in();
        if track != group || index == 0 {
            lines.push(track.map_or_else(|| UNRANKED.to_owned(), track_line));
            group = track;
        }
        let interval = |[low, high]: [f64; 2]| format!(" ({low:.1} to {high:.1})");
        let with_interval =
            |text: String, found: Option<[f64; 2]>| text + &found.map(interval).unwrap_or_default();
        is_rough |= method.miou.is_some_and(|found| found.interval.is_some() && found.is_of_few_scenes());
        let own = method.miou.map(|found| with_interval(format!("{:.2}", found.value), found.interval));
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
        let mut name_lines = split(&method.name, name_width).into_iter();
        let first = name_lines.next().unwrap_or_default();
        let line = format!(
            "{:>RANK_WIDTH$} {first:name_width$}{:>VALUE_WIDTH$}{ahead:>VALUE_WIDTH$}{p:>SHORT_WIDTH$}{detectable:>SHORT_WIDTH$}",
            rank(method),
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
    let left_out = board.methods.len() - board.compared().len();
    if left_out > 0 {
        lines.push(format!("{left_out} more methods are not compared."));
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

fn rank(method: &Method) -> String {
    method.rank.map_or_else(|| "-".to_owned(), |rank| rank.to_string())
}

fn row_lines(method: &Method, name_width: usize) -> Vec<String> {
    let headlines = HEADLINES.map(|metric| method.headline(metric));
    let categories = Category::ALL.map(|category| method.scores.categories.get(&category)?.get(Metric::Miou));
    let numbers: String = headlines.iter().chain(&categories).map(|&value| number(value)).collect();
    let seconds = method.seconds.map_or_else(|| "-".to_owned(), seconds_text);
    let mut name_lines = split(&method.name, name_width).into_iter();
    let first = name_lines.next().unwrap_or_default();
    let mut lines =
        vec![format!("{:>RANK_WIDTH$} {first:name_width$}{numbers}{seconds:>SECONDS_WIDTH$}", rank(method))];
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
pub(crate) fn wrap(sentence: &str, width: usize) -> Vec<String> {
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
    fn texts_are_the_hand_made_ones() {
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
    fn long_names_break_at_seams_and_stay_whole() {
        assert_eq!(split("short", 21), ["short"]);
        assert_eq!(
            split("panopticquery-robust-without-consensus", 21),
            ["panopticquery-robust-", "without-consensus"]
        );
        assert_eq!(split(&"x".repeat(45), 21).concat(), "x".repeat(45));
    }
}
