//! Draws the picture pane: pixels if the terminal can, else characters with the numbers of the objects over them, else
//! a line of text. Paints no picture itself.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Rect;
use ratatui::text::Line;
use ratatui::widgets::Widget as _;
use ratatui_image::Image;

use super::theme;
use crate::layout::{width, wrap};
use crate::model::Model;
use crate::picture::{Art, Label, Picture};

pub(super) fn draw(model: &Model, pane: Rect, buffer: &mut Buffer) {
    if let Some(why) = &model.picture_error {
        return draw_text(&format!("This picture cannot be shown: {why}"), pane, buffer);
    }
    let Some(picture) = model.picture() else {
        return draw_text("loading ...", pane, buffer);
    };
    let cells = picture.request.cells;
    let area = Rect::new(pane.x, pane.y, cells.width.min(pane.width), cells.height.min(pane.height));
    match &picture.art {
        Art::Pixels(protocol) => Image::new(protocol).render(pane, buffer),
        Art::Cells { cells: art, labels } => {
            draw_cells(art, cells.width, area, buffer);
            for label in labels {
                draw_label(model, picture, label, area, buffer);
            }
        }
    }
}

fn draw_cells(art: &[Cell], columns: u16, area: Rect, buffer: &mut Buffer) {
    for (row, cells) in area.rows().zip(art.chunks_exact(usize::from(columns.max(1)))) {
        for (place, source) in row.columns().zip(cells) {
            if let Some(cell) = buffer.cell_mut(place.as_position()) {
                cell.clone_from(source);
            }
        }
    }
}

fn draw_label(model: &Model, picture: &Picture, label: &Label, area: Rect, buffer: &mut Buffer) {
    let marks = model.scene().marks();
    let Some(mark) = marks.iter().find(|mark| mark.id == label.id) else { return };
    // The model, not the picture: that one is painted in the background and may be older than the choice.
    let chosen = model.chosen_ids().contains(&label.id);
    let text = if chosen { format!("[{}]", label.number) } else { label.number.to_string() };
    let columns = width(&text) as u16;
    let last = picture.request.cells.width.min(area.width).saturating_sub(columns);
    let x = label.at.x.saturating_sub(columns / 2).min(last);
    if label.at.y >= area.height {
        return;
    }
    let style = theme::number(mark.colour.0, chosen, model.look.colours);
    buffer.set_string(area.x + x, area.y + label.at.y, text, style);
}

fn draw_text(text: &str, pane: Rect, buffer: &mut Buffer) {
    let lines = wrap(text, pane.width.saturating_sub(4));
    let top = pane.height.saturating_sub(lines.len() as u16) / 2;
    for (row, line) in (top..pane.height).zip(lines) {
        let place = Rect { y: pane.y + row, height: 1, ..pane };
        Line::from(line).centered().render(place, buffer);
    }
}
