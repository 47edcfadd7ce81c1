//! Bars of mIoU with their intervals: one panel a group, one row a method, the value in a column beside the bars.

use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Category, Scale};
use l4d_score::cluster::FEW_SCENES;
use l4d_score::groups::Kind;
use l4d_score::{Group, Metrics};

use super::drawing::{
    AXIS, Anchor, BLUE, Drawing, GRID, INK, Lettering, MARGIN, PAPER, QUIET, SHADE, WIDTH, leading,
};
use super::{group_of, lettering, named, shown};
use crate::rank::{Board, Podium};
use crate::row::{BoardRow, Metric};
use crate::statistics::Statistics;

const BAR: f64 = 11.0;
const GAP: f64 = 18.0;
const LONGEST_LABEL: f64 = 190.0;

/// mIoU of each method in each category.
pub(crate) fn per_category(board: &Board, statistics: &Statistics) -> Drawing {
    let panels = Category::ALL.map(|key| {
        panel(board, statistics, (Kind::Category, key.as_str()), move |row| row.scores.categories.get(&key))
    });
    draw("mIoU per category", board, &panels)
}

/// mIoU of each method at each spatial scale.
pub(crate) fn per_scale(board: &Board, statistics: &Statistics) -> Drawing {
    let panels = Scale::ALL.map(|key| {
        panel(board, statistics, (Kind::Scale, key.as_str()), move |row| row.scores.scales.get(&key))
    });
    draw("mIoU per scale", board, &panels)
}

struct Panel {
    title: String,
    queries: usize,
    scenes: Option<usize>,
    /// One for each method shown.
    bars: Vec<Option<Bar>>,
}

/// Percent.
struct Bar {
    value: f64,
    interval: Option<[f64; 2]>,
    is_of_few_scenes: bool,
    /// Of its track.
    is_best: bool,
}

fn panel(
    board: &Board,
    statistics: &Statistics,
    (kind, name): (Kind, &str),
    metrics_of: impl Fn(&BoardRow) -> Option<&Metrics>,
) -> Panel {
    let miou = |row: &BoardRow| metrics_of(row).and_then(|metrics| metrics.miou);
    let (rows, _) = shown(board);
    let group = |row: &BoardRow| statistics.group(&row.name, kind, name);
    let podiums: BTreeMap<Track, Podium> =
        board.tracks().map(|(track, _)| (track, board.podium(track, Metric::Miou, miou))).collect();
    let bar = |rank: Option<usize>, row: &BoardRow| {
        let (found, value) = (group(row), miou(row)?);
        let podium = rank.and_then(|_| podiums.get(&row.track)).copied().unwrap_or_default();
        Some(Bar {
            value,
            is_best: podium.is_best(value),
            interval: found.and_then(|group: &Group| group.estimates.miou?.interval),
            is_of_few_scenes: found.is_some_and(|group| group.few_scenes),
        })
    };
    let queries = board.rows().filter_map(|(_, row)| metrics_of(row)).map(|metrics| metrics.queries).max();
    Panel {
        title: title_case(name),
        queries: queries.unwrap_or(0),
        scenes: rows.iter().filter_map(|(_, row)| group(row)).map(|group| group.scenes).max(),
        bars: rows.iter().map(|&(rank, row)| bar(rank, row)).collect(),
    }
}

fn draw(title: &str, board: &Board, panels: &[Panel]) -> Drawing {
    let (rows, left_out) = shown(board);
    let (mut drawing, above) = Drawing::titled(title, board, &notes(panels, left_out));
    let top = legend(&mut drawing, board, panels, above);

    let label = Lettering::LABEL.anchored(Anchor::End);
    let labels: Vec<Vec<String>> = rows
        .iter()
        .map(|(_, row)| lettering::wrap_name(&named(row), |line| label.width(line) <= LONGEST_LABEL))
        .collect();
    let label_width = labels.iter().flatten().map(|line| label.width(line)).fold(0.0, f64::max);
    let left = MARGIN + label_width + 8.0;
    let number_room = Lettering::NUMBER.bold().width("100.0") + 4.0;
    let count = panels.len() as f64;
    let pitch = (WIDTH - MARGIN - left + GAP) / count;
    let scale = pitch - GAP - number_room;
    let head = if panels.iter().any(|panel| panel.scenes.is_some()) { 43.0 } else { 30.0 };

    // Rows: heights first, so that grid lines can go beneath the bars.
    let mut y = top + head;
    let mut middles = Vec::new();
    for index in 0..rows.len() {
        let begins_group = index > 0 && group_of(&rows[index]) != group_of(&rows[index - 1]);
        y += if begins_group { 8.0 } else { 0.0 };
        let height = (BAR + 8.0).max(labels[index].len() as f64 * leading(label) + 5.0);
        middles.push(y + height / 2.0);
        y += height;
    }
    let bottom = y + 2.0;

    for (index, panel) in panels.iter().enumerate() {
        let x = left + index as f64 * pitch;
        drawing.text(x, top + 8.0, &panel.title, Lettering::HEAD);
        drawing.text(x, top + 21.0, &counted(panel.queries, "query", "queries"), Lettering::NOTE);
        if let Some(scenes) = panel.scenes {
            let mark = if scenes < FEW_SCENES { " !" } else { "" };
            let text = format!("{}{mark}", counted(scenes, "scene", "scenes"));
            drawing.text(x, top + 34.0, &text, Lettering::NOTE);
        }
        axis(&mut drawing, x, scale, top + head - 2.0, bottom);
        let numbers = x + scale + number_room;
        for ((bar, &middle), (rank, _)) in panel.bars.iter().zip(&middles).zip(&rows) {
            let Some(Bar { value, interval, is_of_few_scenes, is_best }) = bar else {
                let number = Lettering::NUMBER.coloured(QUIET).anchored(Anchor::End);
                drawing.text(numbers, middle + 3.5, "–", number);
                continue;
            };
            let length = value / 100.0 * scale;
            let fill = if rank.is_some() || board.ranked.is_empty() { BLUE } else { SHADE };
            drawing.bar(x, middle - BAR / 2.0, length, BAR, fill);
            if let Some(ends) = interval {
                let [low, high] = ends.map(|end| (x + end / 100.0 * scale, middle));
                whisker(&mut drawing, low, high, *is_of_few_scenes);
            }
            let number = if *is_best { Lettering::NUMBER.bold() } else { Lettering::NUMBER };
            drawing.text(numbers, middle + 3.5, &format!("{value:.1}"), number.anchored(Anchor::End));
        }
        drawing.line([(x, top + head - 2.0), (x, bottom)], 0.75, AXIS);
    }
    for ((lines, &middle), (rank, _)) in labels.iter().zip(&middles).zip(&rows) {
        let first = middle + 4.0 - (lines.len() as f64 - 1.0) * leading(label) / 2.0;
        let ink = if rank.is_some() { label } else { label.coloured(QUIET) };
        drawing.lines(MARGIN + label_width, first, lines, ink);
    }
    drawing.text(left, bottom + 28.0, "mIoU, %", Lettering::NOTE);
    drawing.height = bottom + 28.0 + MARGIN;
    drawing
}

/// An interval that can be seen on a bar as well as beside it. One that has no length has nothing to say.
fn whisker(drawing: &mut Drawing, low: (f64, f64), high: (f64, f64), is_of_few_scenes: bool) {
    if high.0 - low.0 < 0.5 {
        return;
    }
    drawing.line([low, high], 3.0, PAPER);
    drawing.whisker(low, high, is_of_few_scenes, INK);
}

fn notes(panels: &[Panel], left_out: usize) -> Vec<String> {
    let bars = || panels.iter().flat_map(|panel| &panel.bars).flatten();
    let mut notes = Vec::new();
    if bars().any(|bar| bar.interval.is_none()) && bars().any(|bar| bar.interval.is_some()) {
        notes
            .push("Without an interval: from a single scene, or of a method beyond the foremost.".to_owned());
    }
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    notes
}

/// What colours and lines mean; gives the first free height below.
fn legend(drawing: &mut Drawing, board: &Board, panels: &[Panel], above: f64) -> f64 {
    const LINE: f64 = 22.0;
    let mut baseline = above + 18.0;
    let mut x = MARGIN;
    if !(board.unranked.is_empty() || board.ranked.is_empty()) {
        let ranked = if board.has_rivals() { "ranked (bold: best of its track)" } else { "ranked" };
        for (fill, text) in [(BLUE, ranked), (SHADE, "not ranked, shown for scale")] {
            drawing.bar(x, baseline - 8.0, 9.0, 9.0, fill);
            drawing.text(x + 13.0, baseline, text, Lettering::NOTE);
            x += 13.0 + Lettering::NOTE.width(text) + 14.0;
        }
    }
    let few = format!("95 % interval, ! from fewer than {FEW_SCENES} scenes: may be too narrow");
    for (is_of_few_scenes, text) in [(false, "95 % interval"), (true, few.as_str())] {
        let mut with_interval = panels.iter().flat_map(|panel| &panel.bars).flatten();
        if with_interval.any(|bar| bar.interval.is_some() && bar.is_of_few_scenes == is_of_few_scenes) {
            let width = LINE + 5.0 + Lettering::NOTE.width(text);
            if x + width > WIDTH - MARGIN {
                (x, baseline) = (MARGIN, baseline + 16.0);
            }
            whisker(drawing, (x, baseline - 3.5), (x + LINE, baseline - 3.5), is_of_few_scenes);
            drawing.text(x + LINE + 5.0, baseline, text, Lettering::NOTE);
            x += width + 14.0;
        }
    }
    if x > MARGIN { baseline + 18.0 } else { above + 16.0 }
}

fn axis(drawing: &mut Drawing, x: f64, scale: f64, top: f64, bottom: f64) {
    for tick in [0, 25, 50, 75, 100] {
        let at = x + f64::from(tick) / 100.0 * scale;
        drawing.line([(at, top), (at, bottom)], 0.5, GRID);
        if tick % 50 == 0 {
            drawing.text(at, bottom + 13.0, &tick.to_string(), Lettering::NOTE.anchored(Anchor::Middle));
        }
    }
}

fn counted(count: usize, one: &str, many: &str) -> String {
    match count {
        0 => format!("no {one}"),
        1 => format!("1 {one}"),
        _ => format!("{count} {many}"),
    }
}

fn title_case(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
