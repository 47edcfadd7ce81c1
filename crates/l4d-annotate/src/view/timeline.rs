//! Two rows: where in the clip the picture is, and when the answer holds.

use l4d_data::Interval;
use l4d_data::timeline::{FPS, LAST_FRAME};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::theme::{dim, strong};
use crate::layout::timeline_bar;
use crate::model::{Mode, Model};

pub(super) fn draw(model: &Model, area: Rect, buffer: &mut Buffer) {
    let bar = timeline_bar(area);
    let frame = model.frame_number();
    let state = if model.playing.is_some() { "▶" } else { " " };
    buffer.set_string(area.x + 1, area.y, state, strong());
    buffer.set_string(bar.x, bar.y, "─".repeat(usize::from(bar.width)), dim());
    buffer.set_string(bar.x + column_of(frame, bar), bar.y, "●", strong());
    let place = format!(" frame {frame:>2}  {:.2} s", f64::from(frame) / FPS);
    buffer.set_string(bar.right(), bar.y, place, Style::new());
    holds(model, bar, buffer);
}

fn holds(model: &Model, bar: Rect, buffer: &mut Buffer) {
    let frames = model.draft.frames;
    let style = if model.mode == Mode::When { strong() } else { dim() };
    let (first, last) = (column_of(frames.first(), bar), column_of(frames.last(), bar));
    let y = bar.y + 1;
    for column in first..=last {
        let symbol = match column {
            _ if first == last => "│",
            _ if column == first => "├",
            _ if column == last => "┤",
            _ => "═",
        };
        buffer.set_string(bar.x + column, y, symbol, style);
    }
    buffer.set_string(bar.right(), y, format!(" {}", in_words(frames)), style);
}

/// An interval in words that fit beside the bar.
pub(super) fn in_words(frames: Interval) -> String {
    match frames {
        Interval::WHOLE => "whole clip".to_owned(),
        frames => format!("frames {} to {}", frames.first(), frames.last()),
    }
}

fn column_of(frame: u32, bar: Rect) -> u16 {
    let last = f64::from(bar.width.saturating_sub(1));
    (f64::from(frame.min(LAST_FRAME)) / f64::from(LAST_FRAME) * last).round() as u16
}
