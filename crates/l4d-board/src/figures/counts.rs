//! Panels of bars side by side, each on its own scale: counts of names in rows, bins of a distribution in columns.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{AXIS, Area, BLUE, Drawn, INK, Plot, QUIET, beside, bold, font, px};
use crate::charts::{Layout, Panel};

const ROW: i32 = 15;
/// Print pixels of columns, of the head of a panel, and between panels.
const COLUMNS: i32 = 130;
const HEAD: i32 = 32;
const GAP: i32 = 26;
/// Most panels in a line.
const ABREAST: usize = 4;

/// The panels of a chart.
pub(crate) struct Counts<'a>(pub(crate) &'a [Panel]);

impl Counts<'_> {
    fn line_height(line: &[Panel]) -> i32 {
        let height = |panel: &Panel| match panel.layout {
            Layout::Rows => ROW * panel.bars.len() as i32,
            Layout::Columns => COLUMNS,
        };
        HEAD + line.iter().map(height).max().unwrap_or(0) + GAP
    }
}

impl Plot for Counts<'_> {
    fn height(&self) -> i32 {
        self.0.chunks(ABREAST).map(Self::line_height).sum()
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let mut below = area.clone();
        for line in self.0.chunks(ABREAST) {
            let (now, rest) = below.split_vertically(px(Self::line_height(line)));
            for (panel, area) in line.iter().zip(now.split_evenly((1, line.len()))) {
                area.draw(&Text::new(panel.title.clone(), (0, 0), bold(11)))?;
                area.draw(&Text::new(panel.note.clone(), (0, px(14)), font(10, QUIET)))?;
                match panel.layout {
                    Layout::Rows => rows(&area.margin(px(HEAD), 0, px(90), px(GAP + 24)), panel)?,
                    Layout::Columns => columns(&area.margin(px(HEAD), px(GAP), 0, px(GAP)), panel)?,
                }
            }
            below = rest;
        }
        Ok(())
    }
}

fn most(panel: &Panel) -> f64 {
    panel.bars.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1) as f64
}

fn rows<DB: DrawingBackend>(area: &Area<DB>, panel: &Panel) -> Drawn<DB> {
    let count = panel.bars.len() as f64;
    let (width, _) = area.dim_in_pixel();
    let plot = area.clone().shrink((0, 0), (width, (px(ROW) * panel.bars.len() as i32) as u32));
    let mut chart = ChartBuilder::on(&plot).build_cartesian_2d(0.0..most(panel), 0.0..count.max(1.0))?;
    let y = |row: usize| count - row as f64 - 0.5;
    let bars = || panel.bars.iter().enumerate();
    chart.draw_series(bars().map(|(row, (_, found))| {
        Rectangle::new([(0.0, y(row) - 0.33), (*found as f64, y(row) + 0.33)], BLUE.filled())
    }))?;
    chart.draw_series(bars().map(|(row, (text, _))| {
        let style = beside(font(11, INK), HPos::Right);
        EmptyElement::at((0.0, y(row))) + Text::new(text.clone(), (-px(6), 0), style)
    }))?;
    chart.draw_series(bars().map(|(row, (_, found))| {
        let style = beside(font(10, INK), HPos::Left);
        EmptyElement::at((*found as f64, y(row))) + Text::new(found.to_string(), (px(4), 0), style)
    }))?;
    Ok(())
}

fn columns<DB: DrawingBackend>(area: &Area<DB>, panel: &Panel) -> Drawn<DB> {
    let count = panel.bars.len().max(1) as f64;
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(14))
        .x_label_area_size(px(16))
        .build_cartesian_2d(0.0..count, 0.0..most(panel))?;
    let x = |column: usize| column as f64 + 0.5;
    let bars = || panel.bars.iter().enumerate();
    chart.draw_series(bars().map(|(column, (_, found))| {
        Rectangle::new([(x(column) - 0.4, 0.0), (x(column) + 0.4, *found as f64)], BLUE.filled())
    }))?;
    chart.draw_series([PathElement::new([(0.0, 0.0), (count, 0.0)], AXIS.stroke_width(2))])?;
    chart.draw_series(bars().filter(|(_, (_, found))| *found > 0).map(|(column, (_, found))| {
        let style = beside(font(9, INK), HPos::Center);
        EmptyElement::at((x(column), *found as f64)) + Text::new(found.to_string(), (0, -px(7)), style)
    }))?;
    chart.draw_series(bars().map(|(column, (text, _))| {
        let style = beside(font(9, QUIET), HPos::Center);
        EmptyElement::at((x(column), 0.0)) + Text::new(text.clone(), (0, px(9)), style)
    }))?;
    Ok(())
}
