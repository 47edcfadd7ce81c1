//! Lines over a common axis: mean IoU over the clip, and scores against a setting.

use std::collections::BTreeSet;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    AXIS, Area, BLUE, Chart, Drawn, GREEN, GRID, INK, ORANGE, PURPLE, Plot, QUIET, SHADE, SKY, VERMILLION,
    beside, bold, font, px, shortened, side_labels,
};
use super::{named, shown};
use crate::board::Board;
use crate::charts::{Trend, TrendPanel, TrendPoint};

const COLOURS: [RGBColor; 6] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY];

/// Mean IoU of methods by frame.
pub(crate) struct Clip(Vec<Line>);

struct Line {
    name: String,
    colour: RGBColor,
    /// Place among the coloured ones: which shape its points have.
    coloured: Option<usize>,
    /// Frame and percent.
    points: Vec<(f64, f64)>,
}

/// The figure of a board.
pub(crate) fn over_time(board: &Board) -> Clip {
    let is_in_colour = |rank: Option<usize>| rank.is_some() || board.ranked().is_empty();
    let line = |(place, method): (usize, &crate::board::Method)| {
        let coloured = (is_in_colour(method.rank) && place < COLOURS.len()).then_some(place);
        let colour = coloured.map_or(SHADE, |place| COLOURS[place]);
        let points = method.iou_of_frames.iter().map(|(&frame, &iou)| (f64::from(frame), iou)).collect();
        Line { name: shortened(&named(method), 26), colour, coloured, points }
    };
    let lines = shown(board).into_iter().filter(|method| !method.iou_of_frames.is_empty()).enumerate();
    Clip(lines.map(line).collect())
}

/// Axes in percent upwards.
fn percent_chart<'a, DB: DrawingBackend>(
    area: &'a Area<DB>,
    (first, last): (f64, f64),
    (floor, ceiling): (f64, f64),
    (x_title, y_title): (&str, &str),
) -> Result<Chart<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
    let room = if last > first { 0.04 * (last - first) } else { 1.0 };
    let mut chart = ChartBuilder::on(area)
        .margin_top(px(4))
        .x_label_area_size(px(36))
        .y_label_area_size(px(44))
        .build_cartesian_2d(first - room..last + room, floor..ceiling)?;
    let mut mesh = chart.configure_mesh();
    mesh.disable_x_mesh().x_labels(8).y_labels(6).max_light_lines(0);
    mesh.bold_line_style(GRID.stroke_width(1)).axis_style(AXIS.stroke_width(2)).label_style(font(10, QUIET));
    mesh.x_label_formatter(&|value| format!("{value:.0}")).y_label_formatter(&|value| format!("{value:.0}"));
    mesh.axis_desc_style(font(10, INK)).x_desc(x_title).y_desc(y_title).draw()?;
    Ok(chart)
}

impl Plot for Clip {
    fn height(&self) -> i32 {
        300.max(20 + 13 * self.0.len() as i32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let frames: BTreeSet<i64> =
            self.0.iter().flat_map(|line| &line.points).map(|point| point.0 as i64).collect();
        let [Some(first), Some(last)] = [frames.first(), frames.last()] else {
            return area.draw(&Text::new("No frame has a target.", (0, 0), font(11, INK)));
        };
        let (width, height) = area.dim_in_pixel();
        let names = width as i32 - px(190);
        let (plot, _) = area.split_horizontally(names);
        let range = (*first as f64, *last as f64);
        let mut chart = percent_chart(&plot, range, (0.0, 100.0), ("canonical frame", "mean IoU, %"))?;
        // The best method is drawn last, on top.
        for Line { colour, coloured, points, .. } in self.0.iter().rev() {
            let width = if coloured.is_some() { 3 } else { 2 };
            chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(width)))?;
            let step = points.len().div_ceil(8).max(1);
            let marked = points.iter().skip(coloured.unwrap_or(0) % step).step_by(step);
            for &point in marked.filter(|_| coloured.is_some()) {
                let marker = coloured.unwrap_or(0);
                super::scatter::draw_marker(&mut chart, marker, point, *colour, 4)?;
            }
        }
        let base = area.get_base_pixel();
        let labels = self.0.iter().filter_map(|Line { name, colour, coloured, points }| {
            let (x, y) = chart.backend_coord(points.last()?);
            let ink = if coloured.is_some() { *colour } else { QUIET };
            Some(((x - base.0, y - base.1), name.clone(), ink))
        });
        side_labels(area, labels.collect(), names + px(16), (px(6), height as i32 - px(8)))
    }
}

impl Plot for Trend {
    fn height(&self) -> i32 {
        240 * self.panels.len().div_ceil(ABREAST) as i32 + 20
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let (above, below) = area.split_vertically(px(20));
        super::canvas::legend(
            &above,
            &[
                (BLUE, "measured; upright lines: 95 % intervals clustered by scene"),
                (SHADE, "reported, of other data"),
            ],
        )?;
        let points = || self.panels.iter().flat_map(|panel| panel.measured.iter().chain(&panel.reported));
        let settings = points().map(|point| point.at);
        let ends =
            (settings.clone().fold(f64::INFINITY, f64::min), settings.fold(f64::NEG_INFINITY, f64::max));
        let abreast = self.panels.len().clamp(1, ABREAST);
        let areas = below.split_evenly((self.panels.len().div_ceil(abreast).max(1), abreast));
        for (panel, area) in self.panels.iter().zip(&areas) {
            area.draw(&Text::new(shortened(&panel.title, 36), (px(44), 0), bold(11)))?;
            let plot = area.margin(px(18), px(6), 0, px(14));
            let mut chart = percent_chart(&plot, ends, range(points()), (&self.setting, &self.score))?;
            draw_panel(&mut chart, panel)?;
        }
        Ok(())
    }
}

const ABREAST: usize = 3;

fn draw_panel<DB: DrawingBackend>(chart: &mut Chart<DB>, panel: &TrendPanel) -> Drawn<DB> {
    let ascending = |points: &[TrendPoint]| {
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.at.total_cmp(&b.at));
        points
    };
    if panel.measured.is_empty() && panel.reported.is_empty() {
        let middle = chart.plotting_area().get_x_range();
        let at = (f64::midpoint(middle.start, middle.end), chart.plotting_area().get_y_range().start);
        let style = beside(font(10, QUIET), HPos::Center);
        chart.draw_series([EmptyElement::at(at) + Text::new("no query", (0, -px(20)), style)])?;
    }
    let reported = ascending(&panel.reported);
    let of = |point: &TrendPoint| (point.at, point.value);
    chart.draw_series(LineSeries::new(reported.iter().map(of), SHADE.stroke_width(2)))?;
    for point in &reported {
        super::scatter::draw_marker(chart, 1, of(point), SHADE, 4)?;
    }
    let measured = ascending(&panel.measured);
    chart.draw_series(LineSeries::new(measured.iter().map(of), BLUE.stroke_width(4)))?;
    chart.draw_series(measured.iter().filter_map(|point| {
        let [low, high] = point.interval?;
        let value = point.value.clamp(low, high);
        Some(ErrorBar::new_vertical(point.at, low, value, high, BLUE.filled().stroke_width(2), px(6) as u32))
    }))?;
    for point in &measured {
        super::scatter::draw_marker(chart, 0, of(point), BLUE, 4)?;
    }
    Ok(())
}

/// Zero to a hundred, or the tens around all values where that would leave most of it empty.
fn range<'a>(points: impl Iterator<Item = &'a TrendPoint>) -> (f64, f64) {
    let values =
        points.flat_map(|point| [point.value].into_iter().chain(point.interval.into_iter().flatten()));
    let (low, high) =
        values.fold((100.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let (low, high) = ((low / 10.0).floor() * 10.0, ((high / 10.0).ceil() * 10.0).min(100.0));
    if high - low >= 50.0 { (0.0, 100.0) } else { (low, f64::max(high, low + 10.0)) }
}
