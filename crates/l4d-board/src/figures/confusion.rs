//! Which instance was taken for which: a small matrix per scene, look-alikes in frames of their own.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    AXIS, Area, BLUE, Drawn, GRID, INK, ORANGE, Plot, QUIET, SHADE, VERMILLION, beside, bold, font, legend,
    px, shortened,
};
use crate::board::Confusion;

/// Print pixels: side of a cell, width of all matrices, space between them, head of one.
const CELL: i32 = 14;
const ROOM: i32 = 692;
const GAP: i32 = 12;
const HEAD: i32 = 34;
/// Names need at least so much.
const LEAST_NAMES: i32 = 76;
/// More make a figure that nothing can be read from.
const MOST_SCENES: usize = 24;
const MOST_OBJECTS: usize = 24;

/// The matrices of one method.
pub(crate) struct Matrices<'a> {
    scenes: Vec<&'a Confusion>,
    abreast: usize,
}

/// The figure of some scenes, and how many it leaves out.
pub(crate) fn matrices(confusions: &[Confusion]) -> (Matrices<'_>, usize) {
    let fits = |scene: &&Confusion| scene.objects.len() <= MOST_OBJECTS;
    let scenes: Vec<&Confusion> = confusions.iter().filter(fits).take(MOST_SCENES).collect();
    let most = scenes.iter().map(|scene| scene.objects.len()).max().unwrap_or(0) as i32;
    let needed = LEAST_NAMES + (most + 2) * CELL + GAP;
    let left_out = confusions.len() - scenes.len();
    (Matrices { scenes, abreast: (ROOM / needed).clamp(1, 4) as usize }, left_out)
}

fn height(scene: &Confusion) -> i32 {
    HEAD + scene.objects.len() as i32 * CELL + GAP
}

impl Plot for Matrices<'_> {
    fn height(&self) -> i32 {
        let rows = self.scenes.chunks(self.abreast);
        24 + rows.map(|row| row.iter().map(|scene| height(scene)).max().unwrap_or(0)).sum::<i32>().max(20)
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        if self.scenes.is_empty() {
            let text = "No query has a visible target, or every scene has too many objects for a picture.";
            return area.draw(&Text::new(text, (0, 0), font(11, INK)));
        }
        let (above, mut below) = area.split_vertically(px(24));
        legend(
            &above,
            &[
                (BLUE, "the one meant"),
                (VERMILLION, "a look-alike"),
                (ORANGE, "another object"),
                (SHADE, "a landmark (L), or nothing (–); fuller: more of the row"),
            ],
        )?;
        for row in self.scenes.chunks(self.abreast) {
            let tallest = row.iter().map(|scene| height(scene)).max().unwrap_or(0);
            let (line, rest) = below.split_vertically(px(tallest));
            for (scene, panel) in row.iter().zip(line.split_evenly((1, self.abreast))) {
                matrix(&panel, scene, ROOM / self.abreast as i32 - GAP)?;
            }
            below = rest;
        }
        Ok(())
    }
}

fn matrix<DB: DrawingBackend>(area: &Area<DB>, scene: &Confusion, width: i32) -> Drawn<DB> {
    let count = scene.objects.len() as i32;
    let cells = width - (count + 2) * CELL;
    let letters = |room: i32| (room / 6).max(4) as usize;
    area.draw(&Text::new(shortened(&scene.scene, letters(width)), (0, 0), bold(11)))?;
    let heads = (1..=count).map(|place| place.to_string()).chain(["L".to_owned(), "–".to_owned()]);
    for (column, head) in heads.enumerate() {
        let x = cells + column as i32 * CELL + CELL / 2;
        area.draw(&Text::new(head, (px(x), px(HEAD - 9)), beside(font(9, QUIET), HPos::Center)))?;
    }
    for (row, (object, queries)) in scene.objects.iter().zip(&scene.queries).enumerate() {
        let y = HEAD + row as i32 * CELL;
        let all: usize = queries.iter().sum();
        let name = shortened(&object.name, letters(cells - 20));
        let ink = if all > 0 { INK } else { QUIET };
        area.draw(&Text::new(name, (px(cells - 18), px(y + CELL / 2)), beside(font(10, ink), HPos::Right)))?;
        let number = Text::new(
            (row + 1).to_string(),
            (px(cells - 4), px(y + CELL / 2)),
            beside(font(9, QUIET), HPos::Right),
        );
        area.draw(&number)?;
        for (column, &found) in queries.iter().enumerate() {
            let colour = colour(scene, row, column);
            let share = found as f64 / all.max(1) as f64;
            cell(area, (cells + column as i32 * CELL, y), colour, (found, share))?;
        }
    }
    frame(area, (cells, HEAD), (count + 2, count), AXIS.stroke_width(2))?;
    let mut first = 0;
    for alike in scene.objects.chunk_by(|a, b| a.category == b.category) {
        let size = alike.len() as i32;
        frame(area, (cells + first * CELL, HEAD + first * CELL), (size, size), INK.stroke_width(2))?;
        first += size;
    }
    Ok(())
}

fn colour(scene: &Confusion, row: usize, column: usize) -> RGBColor {
    match scene.objects.get(column) {
        _ if row == column => BLUE,
        None => SHADE,
        Some(taken) if taken.category == scene.objects[row].category => VERMILLION,
        Some(_) => ORANGE,
    }
}

fn cell<DB: DrawingBackend>(
    area: &Area<DB>,
    (x, y): (i32, i32),
    colour: RGBColor,
    (queries, share): (usize, f64),
) -> Drawn<DB> {
    let corners = [(px(x), px(y)), (px(x + CELL), px(y + CELL))];
    let opacity = 0.3 + 0.7 * share;
    if queries > 0 {
        area.draw(&Rectangle::new(corners, colour.mix(opacity).filled()))?;
    }
    area.draw(&Rectangle::new(corners, GRID.stroke_width(1)))?;
    if queries > 0 {
        let ink = if colour == BLUE && opacity > 0.6 { WHITE } else { INK };
        let size = if queries > 99 { 7 } else { 10 };
        let middle = (px(x) + px(CELL) / 2, px(y) + px(CELL) / 2);
        area.draw(&Text::new(queries.to_string(), middle, beside(font(size, ink), HPos::Center)))?;
    }
    Ok(())
}

fn frame<DB: DrawingBackend>(
    area: &Area<DB>,
    (x, y): (i32, i32),
    (columns, rows): (i32, i32),
    style: ShapeStyle,
) -> Drawn<DB> {
    area.draw(&Rectangle::new([(px(x), px(y)), (px(x + columns * CELL), px(y + rows * CELL))], style))
}
