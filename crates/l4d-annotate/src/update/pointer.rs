//! The mouse: a click on an object chooses it, one on the timeline goes there, dragging moves the picture.

use std::collections::BTreeSet;

use glam::DVec2;
use l4d_masks::mask::PixelBox;
use ratatui::layout::{Position, Rect};

use super::{answer, looking};
use crate::layout::timeline_bar;
use crate::model::{Model, MouseDrag};
use crate::picture::{Art, Picture};

/// Cells beside an object in which a click still means it.
const TOLERANCE_CELLS: u16 = 1;

pub(super) fn press(model: &mut Model, column: u16, row: u16) {
    let Some(screen) = model.screen() else { return };
    let at = Position::new(column, row);
    if timeline_bar(screen.timeline).contains(at) {
        model.grip = Some(MouseDrag::Scrub);
        scrub(model, column);
    } else if picture_area(model).is_some_and(|area| area.contains(at)) {
        model.grip = Some(MouseDrag::Press(column, row));
    }
}

pub(super) fn drag(model: &mut Model, column: u16, row: u16) {
    match model.grip {
        Some(MouseDrag::Scrub) => scrub(model, column),
        Some(MouseDrag::Press(from_column, from_row) | MouseDrag::Pan(from_column, from_row)) => {
            let Some(area) = picture_area(model) else { return };
            let moved = DVec2::new(
                (f64::from(from_column) - f64::from(column)) / f64::from(area.width),
                (f64::from(from_row) - f64::from(row)) / f64::from(area.height),
            );
            model.viewport = model.viewport.panned(moved);
            model.grip = Some(MouseDrag::Pan(column, row));
        }
        None => {}
    }
}

pub(super) fn release(model: &mut Model, column: u16, row: u16) {
    if let Some(MouseDrag::Press(..)) = model.grip.take() {
        click(model, column, row);
    }
}

pub(super) fn wheel(model: &mut Model, column: u16, row: u16, turns: i32) {
    let at = Position::new(column, row);
    if let Some(area) = picture_area(model).filter(|area| area.contains(at)) {
        let hold = DVec2::new(
            (f64::from(column - area.x) + 0.5) / f64::from(area.width),
            (f64::from(row - area.y) + 0.5) / f64::from(area.height),
        );
        model.viewport = model.viewport.zoomed(turns, hold);
    } else if model.screen().is_some_and(|screen| screen.timeline.contains(at)) {
        looking::step_frame(model, -i64::from(turns));
    }
}

/// The cells that the wanted picture covers.
fn picture_area(model: &Model) -> Option<Rect> {
    let pane = model.screen()?.picture;
    let cells = model.requested.as_ref()?.cells;
    Some(Rect::new(pane.x, pane.y, cells.width, cells.height))
}

fn click(model: &mut Model, column: u16, row: u16) {
    let Some(area) = picture_area(model) else { return };
    let Some(picture) = model.picture() else { return };
    let at = Position::new(column - area.x.min(column), row - area.y.min(row));
    let ids: BTreeSet<u32> = model.scene().objects.iter().map(|object| object.id).collect();
    let hit = label_at(picture, at).or_else(|| {
        let exact = picture.under_cell(at.x, at.y);
        let around = around_cell(picture, at);
        let most = |part: PixelBox| picture.source.most_frequent(part, &ids);
        most(exact).or_else(|| most(around))
    });
    let number = hit.and_then(|id| model.scene().objects.iter().find(|object| object.id == id));
    match number.map(|object| object.number) {
        Some(number) => answer::toggle(model, number),
        None => model.say("There is no numbered object"),
    }
}

fn label_at(picture: &Picture, at: Position) -> Option<u32> {
    let Art::Cells { labels, .. } = &picture.art else { return None };
    let covers = |label: &&crate::picture::Label| label.at.y == at.y && label.at.x.abs_diff(at.x) <= 1;
    labels.iter().find(covers).map(|label| label.id)
}

fn around_cell(picture: &Picture, at: Position) -> PixelBox {
    let cells = picture.request.cells;
    let first =
        picture.under_cell(at.x.saturating_sub(TOLERANCE_CELLS), at.y.saturating_sub(TOLERANCE_CELLS));
    let last = picture.under_cell(
        (at.x + TOLERANCE_CELLS).min(cells.width - 1),
        (at.y + TOLERANCE_CELLS).min(cells.height - 1),
    );
    PixelBox { last_col: last.last_col, last_row: last.last_row, ..first }
}

fn scrub(model: &mut Model, column: u16) {
    let Some(screen) = model.screen() else { return };
    let bar = timeline_bar(screen.timeline);
    let last = model.scene().frames.len() - 1;
    let along = f64::from(column.saturating_sub(bar.x)) / f64::from(bar.width.saturating_sub(1).max(1));
    model.playing = None;
    model.frame = ((along * last as f64).round() as usize).min(last);
}
