//! What was taken for the referents: one bar per method, cut by what its prediction overlaps most.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    Area, BLUE, Drawn, INK, ORANGE, Plot, QUIET, SHADE, SKY, VERMILLION, beside, font, legend, percent_rows,
    px, shortened,
};
use super::{named, shown};
use crate::board::{Board, Choice};

const ROW: i32 = 22;
/// Percent: narrower parts have no room for their number.
const NARROWEST: f64 = 4.5;

/// The bars, one per method.
pub(crate) struct Shares(Vec<Row>);

struct Row {
    name: String,
    is_ranked: bool,
    /// Percent of the queries.
    shares: [(Choice, f64); 6],
}

/// The figure of a board.
pub(crate) fn shares(board: &Board) -> Shares {
    let detailed = shown(board).into_iter().filter(|method| !method.choices.is_empty());
    let rows = detailed.map(|method| {
        let all = method.choices.values().sum::<usize>().max(1) as f64;
        let share = |choice| method.choices.get(&choice).copied().unwrap_or_default() as f64 / all;
        let shares = Choice::ALL.map(|choice| (choice, 100.0 * share(choice)));
        Row { name: shortened(&named(method), 26), is_ranked: method.rank.is_some(), shares }
    });
    Shares(rows.collect())
}

/// Fill, ink on it, and meaning.
fn look(choice: Choice) -> (RGBColor, RGBColor, &'static str) {
    match choice {
        Choice::Meant => (BLUE, WHITE, "the one meant"),
        Choice::Tied => (SKY, INK, "undecided"),
        Choice::LookAlike => (VERMILLION, WHITE, "a look-alike"),
        Choice::OtherObject => (ORANGE, INK, "another object"),
        Choice::Landmark => (SHADE, INK, "a landmark"),
        Choice::Nothing => (WHITE, INK, "nothing"),
    }
}

impl Plot for Shares {
    fn height(&self) -> i32 {
        22 + ROW * self.0.len().max(1) as i32 + 20
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let (above, below) = area.split_vertically(px(22));
        let entries = Choice::ALL.map(|choice| (look(choice).0, look(choice).2));
        legend(&above, &entries)?;
        let plot = below.margin(0, 0, px(150), px(10));
        let mut chart = percent_rows(&plot, self.0.len())?;
        for (row, Row { name, is_ranked, shares }) in self.0.iter().enumerate() {
            let y = self.0.len() as f64 - row as f64 - 0.5;
            let mut x = 0.0;
            for &(choice, share) in shares {
                let (fill, ink, _) = look(choice);
                let corners = [(x, y - 0.33), (x + share, y + 0.33)];
                chart.draw_series([Rectangle::new(corners, fill.filled())])?;
                chart.draw_series([Rectangle::new(corners, INK.stroke_width(1))])?;
                if share >= NARROWEST {
                    let style = beside(font(10, ink), HPos::Center);
                    chart.draw_series([Text::new(format!("{share:.0}"), (x + share / 2.0, y), style)])?;
                }
                x += share;
            }
            let style = beside(font(11, if *is_ranked { INK } else { QUIET }), HPos::Right);
            chart.draw_series([EmptyElement::at((0.0, y)) + Text::new(name.clone(), (-px(6), 0), style)])?;
        }
        Ok(())
    }
}
