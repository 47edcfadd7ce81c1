//! Panels of bars side by side, each on its own scale: counts of names in rows, bins of a distribution in columns.

use super::drawing::{AXIS, Anchor, BLUE, Drawing, Lettering, MARGIN, WIDTH};
use crate::charts::{Chart, Layout, Panel};

/// Height of a row.
const ROW: f64 = 15.0;
const BAR: f64 = 10.0;
/// Space between panels.
const GAP: f64 = 26.0;
/// Height of the tallest column.
const COLUMN: f64 = 110.0;
/// Most panels in a line; more begin another.
const ABREAST: usize = 4;

/// The chart as a picture.
pub(crate) fn draw(chart: &Chart) -> Drawing {
    let (mut drawing, above) = Drawing::headed(&chart.title, &chart.notes);
    let mut top = above + 24.0;
    for line in chart.panels.chunks(ABREAST) {
        let count = line.len().max(1) as f64;
        let pitch = (WIDTH - 2.0 * MARGIN + GAP) / count;
        let mut bottom = top;
        for (index, panel) in line.iter().enumerate() {
            let left = MARGIN + index as f64 * pitch;
            drawing.text(left, top, &panel.title, Lettering::HEAD);
            drawing.text(left, top + 13.0, &panel.note, Lettering::NOTE);
            let below = match panel.layout {
                Layout::Rows => rows(&mut drawing, panel, left, pitch - GAP, top + 22.0),
                Layout::Columns => columns(&mut drawing, panel, left, pitch - GAP, top + 32.0),
            };
            bottom = f64::max(bottom, below);
        }
        top = bottom + 30.0;
    }
    drawing.height = top - 30.0 + MARGIN;
    drawing
}

fn most(panel: &Panel) -> f64 {
    panel.bars.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1) as f64
}

fn rows(drawing: &mut Drawing, panel: &Panel, left: f64, width: f64, top: f64) -> f64 {
    let label = Lettering::LABEL.anchored(Anchor::End);
    let label_width = panel.bars.iter().map(|(text, _)| label.width(text)).fold(0.0, f64::max);
    let start = left + label_width + 6.0;
    let number_room = Lettering::NUMBER.width("0000");
    let scale = (left + width - number_room - start).max(1.0) / most(panel);
    let bottom = top + panel.bars.len() as f64 * ROW;
    for (index, (text, count)) in panel.bars.iter().enumerate() {
        let middle = top + (index as f64 + 0.5) * ROW;
        let length = *count as f64 * scale;
        drawing.text(start - 6.0, middle + 4.0, text, label);
        drawing.bar(start, middle - BAR / 2.0, length, BAR, BLUE);
        drawing.text(start + length + 4.0, middle + 3.5, &count.to_string(), Lettering::NUMBER);
    }
    drawing.line([(start, top), (start, bottom)], 0.75, AXIS);
    bottom
}

fn columns(drawing: &mut Drawing, panel: &Panel, left: f64, width: f64, top: f64) -> f64 {
    let pitch = width / panel.bars.len().max(1) as f64;
    let scale = COLUMN / most(panel);
    let floor = top + COLUMN;
    let label = Lettering::NOTE.anchored(Anchor::Middle);
    // Where labels would meet, every second one stays.
    let widest = panel.bars.iter().map(|(text, _)| label.width(text)).fold(0.0, f64::max);
    let step = ((widest + 2.0) / pitch).ceil().max(1.0) as usize;
    for (index, (text, count)) in panel.bars.iter().enumerate() {
        let middle = left + (index as f64 + 0.5) * pitch;
        let height = *count as f64 * scale;
        let bar = (pitch * 0.8).min(28.0);
        drawing.bar(middle - bar / 2.0, floor - height, bar, height, BLUE);
        if *count > 0 {
            let number = Lettering::NUMBER.anchored(Anchor::Middle);
            drawing.text(middle, floor - height - 4.0, &count.to_string(), number);
        }
        if index % step == 0 {
            drawing.text(middle, floor + 13.0, text, label);
        }
    }
    drawing.line([(left, floor), (left + width, floor)], 0.75, AXIS);
    floor + 16.0
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Extent, Shape};
    use super::*;

    fn chart(labels: &[&str], layout: Layout, panels: usize) -> Chart {
        let bars: Vec<(String, usize)> =
            labels.iter().enumerate().map(|(index, label)| ((*label).to_owned(), index * 37)).collect();
        let panel = Panel { title: "Outdoor".into(), note: "pixels".into(), bars, layout };
        Chart {
            name: "x",
            title: "Sizes".into(),
            notes: vec!["of 21 scenes".into()],
            panels: vec![panel; panels],
        }
    }

    #[test]
    fn nothing_leaves_the_canvas_and_labels_do_not_meet() {
        let bins = ["0", "0.05", "0.1", "0.2", "0.5", "1", "2", "5 and more"];
        for (layout, panels) in
            [(Layout::Rows, 1), (Layout::Rows, 4), (Layout::Columns, 3), (Layout::Columns, 6)]
        {
            let drawing = draw(&chart(&bins, layout, panels));
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            let mut texts = Vec::new();
            for shape in &drawing.shapes {
                match shape {
                    Shape::Text { x, baseline, text, lettering } => {
                        let extent = Extent::of_text(*x, *baseline, text, *lettering);
                        assert!(canvas.holds(extent), "{layout:?} {panels}: {text} at {extent:?}");
                        texts.push((extent, text));
                    }
                    Shape::Bar { x, y, width, height, .. } => {
                        assert!(*x >= 0.0 && *y >= 0.0 && x + width <= WIDTH && y + height <= drawing.height);
                    }
                    _ => {}
                }
            }
            for (index, (extent, text)) in texts.iter().enumerate() {
                let met = texts[..index].iter().find(|(other, _)| extent.overlaps(*other));
                assert!(met.is_none(), "{layout:?} {panels}: {text} meets {met:?}");
            }
        }
    }

    #[test]
    fn the_longest_bar_is_the_largest_count() {
        let drawing = draw(&chart(&["a", "b", "c"], Layout::Rows, 1));
        let bars: Vec<f64> = drawing
            .shapes
            .iter()
            .filter_map(|shape| if let Shape::Bar { width, .. } = shape { Some(*width) } else { None })
            .collect();
        assert_eq!(bars.len(), 3);
        assert!(bars[0] == 0.0 && (bars[2] - 2.0 * bars[1]).abs() < 1e-9);
    }
}
