//! Two rows: where in the clip the picture is, and when the answer holds.

use l4d_data::Interval;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::theme::{dim, strong};
use crate::layout::timeline_bar;
use crate::model::{Mode, Model};

pub(super) fn draw(model: &Model, area: Rect, buffer: &mut Buffer) {
    let bar = timeline_bar(area);
    let (frame, whole) = (model.frame_number(), model.scene().whole());
    let state = if model.playing.is_some() { "▶" } else { " " };
    buffer.set_string(area.x + 1, area.y, state, strong());
    buffer.set_string(bar.x, bar.y, "─".repeat(usize::from(bar.width)), dim());
    buffer.set_string(bar.x + column_of(frame, whole, bar), bar.y, "●", strong());
    let seconds = model.scene().frames_per_second.map(|rate| format!("  {:.2} s", f64::from(frame) / rate));
    let place = format!(" frame {frame:>2}{}", seconds.unwrap_or_default());
    buffer.set_string(bar.right(), bar.y, place, Style::new());
    holds(model, bar, buffer);
}

fn holds(model: &Model, bar: Rect, buffer: &mut Buffer) {
    let (frames, whole) = (model.holds(), model.scene().whole());
    let style = if model.mode == Mode::When { strong() } else { dim() };
    let (first, last) = (column_of(frames.first(), whole, bar), column_of(frames.last(), whole, bar));
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
    buffer.set_string(bar.right(), y, format!(" {}", in_words(frames, whole)), style);
}

/// An interval in words that fit beside the bar.
pub(super) fn in_words(frames: Interval, whole: Interval) -> String {
    match frames {
        frames if frames == whole => "whole clip".to_owned(),
        frames => format!("frames {} to {}", frames.first(), frames.last()),
    }
}

fn column_of(frame: u32, whole: Interval, bar: Rect) -> u16 {
    let last = f64::from(bar.width.saturating_sub(1));
    let passed = frame.clamp(whole.first(), whole.last()) - whole.first();
    let length = whole.frame_count().saturating_sub(1).max(1);
    (f64::from(passed) / f64::from(length) * last).round() as u16
}
