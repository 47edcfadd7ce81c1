//! Bars of mIoU: one panel a group, one row a method, the value at the end of each bar.

use l4d_data::{Category, Scale};
use l4d_score::Metrics;

use super::drawing::{AXIS, Anchor, BLUE, Drawing, GRID, Lettering, MARGIN, QUIET, SHADE, WIDTH, leading};
use super::{lettering, shown};
use crate::rank::{Board, Podium};
use crate::row::{BoardRow, Metric};

const BAR: f64 = 11.0;
const GAP: f64 = 18.0;
const LONGEST_LABEL: f64 = 190.0;

/// mIoU of each method in each category.
pub(crate) fn per_category(board: &Board) -> Drawing {
    let panels = Category::ALL
        .map(|key| panel(board, title_case(key.as_str()), move |row| row.scores.categories.get(&key)));
    draw("mIoU per category", board, &panels)
}

/// mIoU of each method at each spatial scale.
pub(crate) fn per_scale(board: &Board) -> Drawing {
    let panels =
        Scale::ALL.map(|key| panel(board, title_case(key.as_str()), move |row| row.scores.scales.get(&key)));
    draw("mIoU per scale", board, &panels)
}

struct Panel {
    title: String,
    queries: usize,
    /// One for each method shown.
    values: Vec<Option<f64>>,
    podium: Podium,
}

fn panel(board: &Board, title: String, metrics_of: impl Fn(&BoardRow) -> Option<&Metrics>) -> Panel {
    let miou = |row: &BoardRow| metrics_of(row).and_then(|metrics| metrics.miou);
    let queries = board.rows().filter_map(|(_, row)| metrics_of(row)).map(|metrics| metrics.queries).max();
    Panel {
        title,
        queries: queries.unwrap_or(0),
        values: shown(board).0.into_iter().map(|(_, row)| miou(row)).collect(),
        podium: Podium::of(board.ranked.iter().filter_map(|entry| miou(&entry.row)), Metric::Miou),
    }
}

fn draw(title: &str, board: &Board, panels: &[Panel]) -> Drawing {
    let (rows, left_out) = shown(board);
    let mut notes = Vec::new();
    if left_out > 0 {
        notes.push(format!("{left_out} more methods stand in the tables."));
    }
    let (mut drawing, above) = Drawing::titled(title, board, &notes);
    let top = legend(&mut drawing, board, above);

    let label = Lettering::LABEL.anchored(Anchor::End);
    let labels: Vec<Vec<String>> = rows
        .iter()
        .map(|(_, row)| lettering::wrap_name(&row.name, |line| label.width(line) <= LONGEST_LABEL))
        .collect();
    let label_width = labels.iter().flatten().map(|line| label.width(line)).fold(0.0, f64::max);
    let left = MARGIN + label_width + 8.0;
    let number_room = Lettering::NUMBER.bold().width("100.0") + 4.0;
    let count = panels.len() as f64;
    let pitch = (WIDTH - MARGIN - left + GAP) / count;
    let scale = pitch - GAP - number_room;

    // Rows: heights first, so that grid lines can go beneath the bars.
    let mut y = top + 30.0;
    let mut middles = Vec::new();
    for (index, (rank, _)) in rows.iter().enumerate() {
        let begins_unranked = rank.is_none() && index > 0 && rows[index - 1].0.is_some();
        y += if begins_unranked { 8.0 } else { 0.0 };
        let height = (BAR + 8.0).max(labels[index].len() as f64 * leading(label) + 5.0);
        middles.push(y + height / 2.0);
        y += height;
    }
    let bottom = y + 2.0;

    for (index, panel) in panels.iter().enumerate() {
        let x = left + index as f64 * pitch;
        drawing.text(x, top + 8.0, &panel.title, Lettering::HEAD);
        drawing.text(x, top + 21.0, &counted(panel.queries), Lettering::NOTE);
        axis(&mut drawing, x, scale, top + 28.0, bottom);
        for ((&value, &middle), (rank, _)) in panel.values.iter().zip(&middles).zip(&rows) {
            let Some(value) = value else {
                drawing.text(x + 4.0, middle + 3.5, "–", Lettering::NUMBER.coloured(QUIET));
                continue;
            };
            let length = value / 100.0 * scale;
            drawing.bar(
                x,
                middle - BAR / 2.0,
                length,
                BAR,
                if rank.is_some() || board.ranked.is_empty() { BLUE } else { SHADE },
            );
            let best = rank.is_some() && panel.podium.is_best(value);
            let number = if best { Lettering::NUMBER.bold() } else { Lettering::NUMBER };
            drawing.text(x + length + 4.0, middle + 3.5, &format!("{value:.1}"), number);
        }
        drawing.line([(x, top + 28.0), (x, bottom)], 0.75, AXIS);
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

/// What the colours mean; gives the first free height below.
fn legend(drawing: &mut Drawing, board: &Board, above: f64) -> f64 {
    if board.unranked.is_empty() || board.ranked.is_empty() {
        return above + 16.0;
    }
    let baseline = above + 18.0;
    let mut x = MARGIN;
    for (fill, text) in [(BLUE, "ranked (bold: best)"), (SHADE, "not ranked, shown for scale")] {
        drawing.bar(x, baseline - 8.0, 9.0, 9.0, fill);
        drawing.text(x + 13.0, baseline, text, Lettering::NOTE);
        x += 13.0 + Lettering::NOTE.width(text) + 14.0;
    }
    baseline + 18.0
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

fn counted(queries: usize) -> String {
    match queries {
        0 => "no query".to_owned(),
        1 => "1 query".to_owned(),
        _ => format!("{queries} queries"),
    }
}

fn title_case(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
