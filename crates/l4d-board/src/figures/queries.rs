//! IoU of every query over the clip: one row per query, best first, one panel per category.

use l4d_data::Category;
use l4d_score::counts::State;
use plotters::prelude::*;

use super::canvas::{AXIS, Area, Drawn, Plot, QUIET, VERMILLION, bold, font, legend, px};
use crate::board::{Answer, Board, BoardScene, Method};

/// Print pixels of a row, where there are few and where there are many.
const ROWS: (f64, f64) = (9.0, 2.5);
const TALLEST: f64 = 420.0;
const GAP: i32 = 22;
/// Light to dark in even steps of luminance, so that grey says the same: a miss is the lightest.
const MISSED: RGBColor = RGBColor(0xFB, 0xDC, 0x9C);
const BLUES: [RGBColor; 5] = [
    RGBColor(0x8F, 0xBD, 0xE0),
    RGBColor(0x5B, 0x9B, 0xCB),
    RGBColor(0x35, 0x79, 0xB0),
    RGBColor(0x18, 0x53, 0x88),
    RGBColor(0x08, 0x25, 0x52),
];

/// The queries of one method: the colour of each frame; none where there is nothing to find and nothing was marked.
pub(crate) struct Heat(Vec<(Category, Vec<Vec<Option<RGBColor>>>)>);

/// The figure of one method.
pub(crate) fn heat(board: &Board, method: &Method) -> Heat {
    let panel = |category: Category| {
        let queries = board.queries().zip(&method.answers);
        let of_category = queries.filter(|((_, query), _)| query.categories.first() == Some(&category));
        let mut rows: Vec<(f64, Vec<Option<RGBColor>>)> = of_category
            .filter_map(|((scene, _), answer)| Some((answer.ratios.miou?, colours(scene, answer))))
            .collect();
        rows.sort_by(|a, b| b.0.total_cmp(&a.0));
        (category, rows.into_iter().map(|(_, row)| row).collect())
    };
    Heat(Category::ALL.map(panel).into())
}

fn colours(scene: &BoardScene, answer: &Answer) -> Vec<Option<RGBColor>> {
    let colour = |position: usize| match answer.state(scene, position) {
        State::Hit => {
            let step = answer.iou(position).unwrap_or(0.0) * BLUES.len() as f64;
            Some(BLUES[(step as usize).min(BLUES.len() - 1)])
        }
        State::Miss | State::Missing if answer.union[position] > 0 => Some(MISSED),
        State::FalseAlarm => Some(VERMILLION),
        _ => None,
    };
    let is_annotated = |position: &usize| answer.state(scene, *position) != State::NotAnnotated;
    (0..answer.union.len()).filter(is_annotated).map(colour).collect()
}

impl Heat {
    fn most(&self) -> usize {
        self.0.iter().map(|(_, rows)| rows.len()).max().unwrap_or(0).max(1)
    }

    /// Print pixels.
    fn row(&self) -> f64 {
        (TALLEST / self.most() as f64).clamp(ROWS.1, ROWS.0)
    }
}

impl Plot for Heat {
    fn height(&self) -> i32 {
        24 + 16 + (self.most() as f64 * self.row()).ceil() as i32 + 4
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let (above, below) = area.split_vertically(px(24));
        legend(
            &above,
            &[
                (BLUES[0], ""),
                (BLUES[1], ""),
                (BLUES[2], ""),
                (BLUES[3], ""),
                (BLUES[4], "IoU, 0 to 100 in steps of 20"),
                (MISSED, "missed"),
                (VERMILLION, "marked where there is nothing"),
                (WHITE, "nothing to find, nothing marked"),
            ],
        )?;
        for ((category, rows), panel) in self.0.iter().zip(below.split_evenly((1, self.0.len()))) {
            let noun = if rows.len() == 1 { "query" } else { "queries" };
            let title = format!("{}: {} {noun}", category.as_str(), rows.len());
            panel.draw(&Text::new(title, (0, 0), bold(11)))?;
            let height = (rows.len() as f64 * self.row() * f64::from(px(1))) as i32;
            let (width, _) = panel.dim_in_pixel();
            let plot = panel.clone().shrink((0, px(16)), (width - px(GAP) as u32, height.max(px(9)) as u32));
            let frames = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
            let chart = ChartBuilder::on(&plot)
                .build_cartesian_2d(0.0..frames as f64, 0.0..rows.len().max(1) as f64)?;
            for (row, cells) in rows.iter().enumerate() {
                let y = (rows.len() - row) as f64;
                let mut first = 0;
                for run in cells.chunk_by(|a, b| a == b) {
                    let last = first + run.len();
                    if let Some(colour) = run[0] {
                        let edge = if colour == VERMILLION { 0.35 } else { 0.0 };
                        let corners = [(first as f64, y - 1.0 + edge), (last as f64, y - edge)];
                        chart.plotting_area().draw(&Rectangle::new(corners, colour.filled()))?;
                    }
                    first = last;
                }
            }
            let (width, height) = plot.dim_in_pixel();
            plot.draw(&Rectangle::new(
                [(0, 0), (width as i32 - 1, height as i32 - 1)],
                AXIS.stroke_width(2),
            ))?;
            if rows.is_empty() {
                plot.draw(&Text::new("no query", (px(4), px(2)), font(9, QUIET)))?;
            }
        }
        Ok(())
    }
}
