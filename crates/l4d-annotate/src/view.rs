//! The state as cells of a screen. Draws, and changes nothing.

mod art;
mod pages;
mod panel;
mod theme;
mod timeline;

use ratatui::buffer::Buffer;
use ratatui::layout::{Alignment, Rect};
use ratatui::style::Modifier;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Paragraph, Widget as _};

use crate::layout::{SMALLEST, width, wrap};
use crate::look::Look;
use crate::model::{Mode, Model};
use theme::{dim, strong};

pub(crate) fn draw(model: &Model, area: Rect, buffer: &mut Buffer) {
    match model.screen() {
        None => too_small(area, buffer),
        Some(_) if model.help => pages::help(area, buffer),
        Some(_) if matches!(model.mode, Mode::Summary { .. }) => pages::summary(model, area, buffer),
        Some(screen) => {
            header(model, screen.header, buffer);
            prompt(&model.question().text, screen.prompt, buffer);
            art::draw(model, screen.picture, buffer);
            panel::draw(model, screen.panel, buffer);
            timeline::draw(model, screen.timeline, buffer);
        }
    }
    translate(&model.look, buffer);
}

fn header(model: &Model, area: Rect, buffer: &mut Buffer) {
    let (answered, skipped) = model.progress();
    let left = format!(" round {} · {} · {}", model.title, model.annotator, model.question().id);
    let skipped = if skipped > 0 { format!(" · {skipped} skipped") } else { String::new() };
    let right = format!("item {} of {} · {answered} answered{skipped} ", model.at + 1, model.questions.len());
    Line::from(Span::styled(left, dim())).render(area, buffer);
    Line::from(Span::styled(right, dim())).alignment(Alignment::Right).render(area, buffer);
}

fn prompt(text: &str, area: Rect, buffer: &mut Buffer) {
    let mut lines = wrap(text, area.width);
    let room = usize::from(area.height);
    if lines.len() > room {
        lines.truncate(room);
        if let Some(last) = lines.last_mut() {
            let notice = " ... (enlarge the terminal to read on)";
            while width(last) + width(notice) > usize::from(area.width) && last.pop().is_some() {}
            last.push_str(notice);
        }
    }
    // One line in a room for two is next to the picture.
    let top = area.height.saturating_sub(lines.len() as u16);
    for (row, line) in (top..).zip(lines) {
        let place = Rect { y: area.y + row, height: 1, ..area };
        Line::from(Span::styled(line, strong())).render(place, buffer);
    }
}

fn too_small(area: Rect, buffer: &mut Buffer) {
    let text = format!(
        "The terminal has {} columns and {} rows. At least {} and {} are needed: enlarge it, or make its letters \
         smaller. Nothing is lost. q quits.",
        area.width, area.height, SMALLEST.width, SMALLEST.height
    );
    let lines: Vec<Line<'_>> = wrap(&text, area.width).into_iter().map(Line::from).collect();
    Paragraph::new(lines).render(area, buffer);
}

/// Turns what was drawn into what the terminal understands.
fn translate(look: &Look, buffer: &mut Buffer) {
    for cell in &mut buffer.content {
        if !look.unicode && !cell.symbol().is_ascii() {
            let symbol: String = cell.symbol().chars().map(in_ascii).collect();
            cell.set_symbol(&symbol);
        }
        cell.fg = theme::shown(cell.fg, look.colours);
        cell.bg = theme::shown(cell.bg, look.colours);
        // A shade of grey is a colour, too: without them it would be drawn like the rest, or not at all.
        if look.colours == crate::look::Colours::None {
            cell.modifier.remove(Modifier::DIM);
        }
    }
}

fn in_ascii(letter: char) -> char {
    match letter {
        '─' | '·' | '–' | '—' => '-',
        '│' => '|',
        '═' => '=',
        '├' => '[',
        '┤' => ']',
        '●' => 'O',
        '▶' => '>',
        '“' | '”' => '"',
        '‘' | '’' => '\'',
        letter if letter.is_ascii() => letter,
        _ => '?',
    }
}

#[cfg(test)]
mod tests;
