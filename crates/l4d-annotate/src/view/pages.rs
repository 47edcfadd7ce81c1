//! Screens of text: the keys, and what is left to do.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{List, ListState, StatefulWidget, Widget as _};

use super::theme::{dim, marked, strong};
use crate::keys::{HELP, HELP_COLUMNS};
use crate::layout::{width, wrap};
use crate::model::{Mode, Model};

/// Columns that the names of keys take.
const KEY_COLUMNS: usize = 11;
/// A column of the help page with the gap behind it.
const HELP_COLUMN_WIDTH: u16 = (KEY_COLUMNS + 1 + HELP_COLUMNS) as u16 + 1;

pub(super) fn help(area: Rect, buffer: &mut Buffer) {
    buffer.set_string(area.x + 1, area.y, "Keys", strong());
    let closing = "any key goes back";
    buffer.set_string(area.right().saturating_sub(closing.len() as u16 + 1), area.y, closing, dim());
    let room = usize::from(area.height - 2);
    let mut column = Vec::new();
    let mut x = area.x + 1;
    for (title, keys) in HELP {
        if column.len() + keys.len() + 1 > room {
            help_column(&std::mem::take(&mut column), x, area, buffer);
            x += HELP_COLUMN_WIDTH;
        }
        if !column.is_empty() && column.len() + keys.len() + 2 <= room {
            column.push(Line::default());
        }
        column.push(Line::from(Span::styled(*title, strong())));
        let line = |(key, what): &(&'static str, &'static str)| {
            Line::from(vec![Span::raw(format!("{key:<KEY_COLUMNS$} ")), Span::styled(*what, dim())])
        };
        column.extend(keys.iter().map(line));
    }
    help_column(&column, x, area, buffer);
}

fn help_column(lines: &[Line<'_>], x: u16, area: Rect, buffer: &mut Buffer) {
    let columns = area.right().saturating_sub(x).min(HELP_COLUMN_WIDTH - 1);
    for (row, line) in (area.y + 2..area.bottom()).zip(lines) {
        line.render(Rect::new(x, row, columns, 1), buffer);
    }
}

pub(super) fn summary(model: &Model, area: Rect, buffer: &mut Buffer) {
    let Mode::Summary { selected, sealing } = model.mode else { return };
    let unanswered = model.unanswered();
    let (answered, skipped) = model.progress();
    let open = model.questions.len() - answered - skipped;
    let title = format!("Round {} · {}", model.title, model.annotator);
    buffer.set_string(area.x + 1, area.y, title, strong());
    let counts =
        format!("{} items: {answered} answered, {skipped} skipped, {open} open", model.questions.len());
    buffer.set_string(area.x + 1, area.y + 1, counts, dim());
    let closing = closing_lines(model, sealing, open, area.width.saturating_sub(2));
    let list_rows = area.height.saturating_sub(3 + closing.len() as u16 + 1);
    let list_area = Rect::new(area.x + 1, area.y + 3, area.width.saturating_sub(2), list_rows);
    let rows = unanswered.iter().map(|&place| {
        let question = &model.questions[place];
        let state = if question.response.skipped { "skipped" } else { "open   " };
        let start = format!(" {}  {state}  ", question.id);
        let room = list_area.width.saturating_sub(width(&start) as u16);
        Line::from(start + &cut(&question.text, room))
    });
    let list = List::new(rows).style(dim()).highlight_style(marked());
    let mut state = ListState::default().with_selected(Some(selected));
    StatefulWidget::render(list, list_area, buffer, &mut state);
    let top = area.bottom() - closing.len() as u16;
    for (row, (text, is_strong)) in (top..).zip(closing) {
        buffer.set_string(area.x + 1, row, text, if is_strong { strong() } else { dim() });
    }
}

/// What can be done now, from the bottom of the page; true where it matters most.
fn closing_lines(model: &Model, sealing: bool, open: usize, columns: u16) -> Vec<(String, bool)> {
    let (_, skipped) = model.progress();
    let mut lines: Vec<(String, bool)> = Vec::new();
    let mut say = |text: &str, is_strong: bool| {
        lines.extend(wrap(text, columns).into_iter().map(|line| (line, is_strong)));
    };
    if let Some(notice) = &model.notice {
        say(&notice.text, true);
    }
    if model.sealed {
        say("The ballot is sealed. Thank you.", true);
        say("q: quit", false);
    } else if sealing {
        let left = match skipped {
            0 => String::new(),
            1 => " The skipped item stays without an answer.".to_owned(),
            count => format!(" The {count} skipped items stay without an answer."),
        };
        say(&format!("Seal the ballot? Nothing can be changed afterwards.{left}"), true);
        say("y: seal · any other key: back", false);
    } else if open == 0 {
        say("Nothing is open. Sealing the ballot ends your work on this round.", true);
        say("Up Down: choose · Enter: open the item · S: seal · u: undo · Esc: back · q: quit", false);
    } else {
        say("Up Down: choose · Enter: open the item · u: undo · Esc: back · q: quit", false);
    }
    lines
}

fn cut(text: &str, columns: u16) -> String {
    if width(text) <= usize::from(columns) {
        return text.to_owned();
    }
    wrap(text, columns.saturating_sub(3)).remove(0) + "..."
}
