//! Beside the picture: the question, the answer so far, what the last act led to, the keys that matter now.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::Widget as _;

use super::theme::{self, dim, marked, strong};
use super::timeline;
use crate::draft::DraftChoice;
use crate::field::Field;
use crate::layout::{width, wrap};
use crate::model::{Mode, Model};

const ITEM_KEYS: &[&str] = &[
    "1-9 object    Enter go on",
    "n none        a ambiguous",
    "s skip        u undo",
    "Left Right    frame",
    "Up Down view  Space play",
    "+ - z zoom    o open",
    "? all keys    q quit",
];
const WHEN_KEYS: &[&str] = &[
    "[ from this frame",
    "] up to this frame",
    "w whole clip",
    "Enter save   Esc back",
    "",
    "Left Right frame",
    "Space play   ? all keys",
];

pub(super) fn draw(model: &Model, area: Rect, buffer: &mut Buffer) {
    let mut page = Page { lines: Vec::new(), width: area.width };
    looking(model, &mut page);
    let keys = match &model.mode {
        Mode::Choose | Mode::Summary { .. } => {
            which(model, &mut page, strong());
            when(model, &mut page, dim());
            ITEM_KEYS
        }
        Mode::When => {
            which(model, &mut page, dim());
            when(model, &mut page, strong());
            WHEN_KEYS
        }
        Mode::Reason(field) => {
            text(field, "What makes it ambiguous?", &mut page);
            &["Enter save   Esc back"]
        }
        Mode::Comment(field) => {
            text(field, "Your comment", &mut page);
            &["Enter save   Esc back"]
        }
        Mode::Leave => {
            page.text("Leave?", strong());
            page.text("An answer or a text was entered and not saved. What was saved stays.", Style::new());
            &["q leave", "any other key: back"]
        }
    };
    if let Some(notice) = &model.notice {
        page.gap();
        page.text(&notice.text, if notice.is_error { marked() } else { strong() });
    }
    page.draw(keys, area, buffer);
}

fn looking(model: &Model, page: &mut Page) {
    let zoom = if model.viewport.is_whole() {
        String::new()
    } else {
        format!(" · zoom {:.1}", model.viewport.zoom())
    };
    let outlines = if model.outlines { "" } else { " · no outlines" };
    let loading = if model.is_loading() && model.picture().is_some() { " · loading" } else { "" };
    let text = format!("view {} of {}{zoom}{outlines}{loading}", model.view + 1, model.scene().views.len());
    page.text(&text, dim());
    page.gap();
}

fn which(model: &Model, page: &mut Page, style: Style) {
    page.text("Which objects are meant?", style);
    numbers(model, page);
    let answer = match &model.draft.choice {
        _ if !model.draft.typed.is_empty() => format!("{}_", model.draft.typed),
        DraftChoice::None => "none".to_owned(),
        DraftChoice::Ambiguous(reason) => format!("ambiguous: {reason}"),
        DraftChoice::Objects(numbers) => {
            numbers.iter().map(ToString::to_string).collect::<Vec<String>>().join(", ")
        }
    };
    let response = &model.question().response;
    let state = match (&response.answer, model.is_unsaved()) {
        (_, true) => "not saved yet",
        (Some(_), false) => "saved",
        (None, false) if response.skipped => "skipped",
        (None, false) => "no answer yet",
    };
    page.text(
        &if answer.is_empty() { state.to_owned() } else { format!("{answer} ({state})") },
        Style::new(),
    );
    match response.comments.len() {
        0 => {}
        1 => page.text("1 comment", dim()),
        count => page.text(&format!("{count} comments"), dim()),
    }
}

fn when(model: &Model, page: &mut Page, style: Style) {
    // Nothing that could hold at a time is no reason to move the lines below.
    page.gap();
    page.text("When is it so?", style);
    page.text(&timeline::in_words(model.holds(), model.scene().whole()), style);
}

/// All numbers of the scene; those whose objects are not in the picture are named below.
fn numbers(model: &Model, page: &mut Page) {
    let marks = model.scene().marks();
    let chosen = model.chosen_ids();
    let mut spans: Vec<Span<'static>> = Vec::new();
    let mut column = 0;
    for mark in &marks {
        let is_chosen = chosen.contains(&mark.id);
        let chip = if is_chosen { format!("[{}]", mark.number) } else { format!(" {} ", mark.number) };
        if column + width(&chip) > usize::from(page.width) {
            page.lines.push(Line::from(std::mem::take(&mut spans)));
            column = 0;
        }
        column += width(&chip);
        spans.push(Span::styled(chip, theme::number(mark.colour.0, is_chosen, model.look.colours)));
    }
    page.lines.push(Line::from(spans));
    let Some(picture) = model.picture() else { return };
    let visible = picture.source.visible(picture.request.region);
    let hidden: Vec<String> =
        marks.iter().filter(|mark| !visible.contains(&mark.id)).map(|mark| mark.number.to_string()).collect();
    if !hidden.is_empty() {
        page.text(&format!("not in this picture: {}", hidden.join(" ")), dim());
    }
}

fn text(field: &Field, title: &str, page: &mut Page) {
    page.text(title, strong());
    let (before, after) = field.parts();
    // The cursor is a bar, so that it shows without colours and between any two letters.
    let lines = typed_lines(&format!("{before}│{after}"), page.width);
    // The end is where one types.
    const MOST_LINES: usize = 8;
    let hidden = lines.len().saturating_sub(MOST_LINES);
    page.lines.extend(lines.into_iter().skip(hidden).map(Line::from));
    page.gap();
}

/// Breaks typed text where the line is full: spaces count, since they were typed.
fn typed_lines(text: &str, columns: u16) -> Vec<String> {
    let mut lines = vec![String::new()];
    for letter in text.chars() {
        if let Some(line) = lines.last_mut().filter(|line| width(line) < usize::from(columns).max(1)) {
            line.push(letter);
        } else {
            lines.push(letter.to_string());
        }
    }
    lines
}

/// Lines from the top, keys from the bottom.
struct Page {
    lines: Vec<Line<'static>>,
    width: u16,
}

impl Page {
    fn text(&mut self, text: &str, style: Style) {
        let lines = wrap(text, self.width).into_iter();
        self.lines.extend(lines.map(|line| Line::from(Span::styled(line, style))));
    }

    fn gap(&mut self) {
        self.lines.push(Line::default());
    }

    fn draw(self, keys: &[&'static str], area: Rect, buffer: &mut Buffer) {
        let room = usize::from(area.height).saturating_sub(self.lines.len());
        // Keys can be looked up; the last act's outcome cannot.
        let shown = if room > keys.len() { keys } else { &[] };
        let top = usize::from(area.height) - shown.len();
        let keys = shown.iter().map(|key| Line::from(Span::styled(*key, dim())));
        let rows = (0..top).zip(self.lines).chain((top..).zip(keys));
        for (row, line) in rows {
            line.render(Rect { y: area.y + row as u16, height: 1, ..area }, buffer);
        }
    }
}
