//! Cost against gain with the points that nothing beats: methods of a board, or settings of a benchmark.

use l4d_data::results::Track;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;

use super::canvas::{
    AXIS, Area, BLUE, Drawn, GREEN, GRID, INK, ORANGE, PURPLE, Plot, QUIET, SHADE, SKY, VERMILLION, font,
    legend, px, shortened, side_labels,
};
use super::{named, shown};
use crate::board::{Board, Method};
use crate::charts::Tradeoff;

const COLOURS: [RGBColor; 7] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, QUIET];
const HEIGHT: i32 = 360;

/// The plot: costs are above 0.
pub(crate) struct Scatter {
    cost: String,
    gain: String,
    points: Vec<Point>,
    /// Series with colour and marker, in the order of the legend.
    series: Vec<(RGBColor, String)>,
    /// Of these points each is cheaper or better than all others of its front: cost and gain, cheapest first.
    fronts: Vec<Vec<(f64, f64)>>,
    /// Percent, or what was measured.
    is_percent: bool,
}

struct Point {
    cost: f64,
    gain: f64,
    interval: Option<[f64; 2]>,
    series: usize,
    /// Named points have their label in the column beside the plot.
    name: Option<String>,
}

/// Seconds per query, as methods report them, against mIoU; and the methods without a time.
pub(crate) fn speed(board: &Board) -> (Scatter, Vec<String>) {
    let series =
        [("ranked, track colour", BLUE), ("ranked, track colour + depth", SKY), ("not ranked", SHADE)];
    let of = |method: &Method| match method.ranked_in() {
        Some(Track::Colour) => 0,
        Some(Track::ColourDepth) => 1,
        None => 2,
    };
    let timed = |method: &Method| {
        let cost = method.seconds? / method.asked as f64;
        let gain = method.headline(l4d_score::Metric::Miou)?;
        (cost.is_finite() && cost > 0.0).then(|| Point {
            cost,
            gain,
            interval: method.miou.and_then(|found| found.interval),
            series: of(method),
            name: Some(shortened(&named(method), 26)),
        })
    };
    let methods = shown(board);
    let untimed =
        methods.iter().filter(|method| timed(method).is_none()).map(|method| named(method)).collect();
    let points: Vec<Point> = methods.iter().filter_map(|method| timed(method)).collect();
    let of_series = |wanted: usize| {
        let points = points.iter().filter(move |point| point.series == wanted);
        front(&points.map(|point| (point.cost, point.gain)).collect::<Vec<_>>())
    };
    let fronts = (0..2).map(of_series).collect();
    let scatter = Scatter {
        cost: "seconds per query".to_owned(),
        gain: "mIoU, %".to_owned(),
        series: series.map(|(name, colour)| (colour, name.to_owned())).to_vec(),
        fronts,
        points,
        is_percent: true,
    };
    (scatter, untimed)
}

/// Points of other verbs.
pub(crate) fn tradeoff(tradeoff: &Tradeoff) -> Scatter {
    let mut series: Vec<(RGBColor, String)> = Vec::new();
    let pairs: Vec<(f64, f64)> = tradeoff.points.iter().map(|point| (point.cost, point.gain)).collect();
    let best = front(&pairs);
    let mut points = Vec::new();
    for point in &tradeoff.points {
        let name = if point.is_base { "default" } else { point.series.as_str() };
        let place = series.iter().position(|(_, other)| other == name).unwrap_or_else(|| {
            let colour = if point.is_base { INK } else { COLOURS[series.len() % COLOURS.len()] };
            series.push((colour, name.to_owned()));
            series.len() - 1
        });
        let is_named = point.is_base || best.contains(&(point.cost, point.gain));
        let name = is_named.then(|| shortened(&point.label, 30));
        points.push(Point { cost: point.cost, gain: point.gain, interval: None, series: place, name });
    }
    let (cost, gain) = (tradeoff.cost.clone(), tradeoff.gain.clone());
    Scatter { cost, gain, points, series, fronts: vec![best], is_percent: false }
}

/// The pairs of cost and gain that no other beats, cheapest first: nothing that costs as little or less gives as much or
/// more.
pub(crate) fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut order = points.to_vec();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut best = f64::NEG_INFINITY;
    order.retain(|point| {
        let gives_more = point.1 > best;
        best = best.max(point.1);
        gives_more
    });
    order
}

impl Plot for Scatter {
    fn height(&self) -> i32 {
        HEIGHT.max(40 + 13 * self.points.iter().filter(|point| point.name.is_some()).count() as i32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let Some(first) = self.points.first() else {
            return area.draw(&Text::new("No method says how long it took.", (0, 0), font(11, INK)));
        };
        let (above, below) = area.split_vertically(px(22));
        let used = |place: &usize| self.points.iter().any(|point| point.series == *place);
        let entries: Vec<(RGBColor, &str)> = (0..self.series.len())
            .filter(used)
            .map(|place| (self.series[place].0, self.series[place].1.as_str()))
            .collect();
        legend(&above, &entries)?;
        let (width, height) = below.dim_in_pixel();
        let names = width as i32 - px(180);
        let (plot, _) = below.split_horizontally(names);
        let extent = |value: fn(&Point) -> f64| {
            let ends = self.points.iter().map(value);
            ends.fold((value(first), value(first)), |(low, high), value| (low.min(value), high.max(value)))
        };
        let (cheap, dear) = extent(|point| point.cost);
        let (low, high) = extent(|point| point.gain);
        let room = (0.08 * (high - low)).max(0.5);
        let gains = if self.is_percent { 0.0..100.0 } else { low - room..high + room };
        let costs = (cheap / 1.5..dear * 1.5).log_scale();
        let end = dear * 1.5;
        let mut chart = ChartBuilder::on(&plot)
            .margin_top(px(4))
            .x_label_area_size(px(36))
            .y_label_area_size(px(48))
            .build_cartesian_2d(costs, gains)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_labels(6).y_labels(7).max_light_lines(0).x_label_formatter(&|cost| plain(*cost));
        mesh.y_label_formatter(&|gain| plain(*gain)).bold_line_style(GRID.stroke_width(1));
        mesh.axis_style(AXIS.stroke_width(2)).label_style(font(10, QUIET)).axis_desc_style(font(10, INK));
        mesh.x_desc(self.cost.clone()).y_desc(self.gain.clone()).draw()?;
        for front in &self.fronts {
            chart.draw_series(LineSeries::new(stairs(front, end), SHADE.stroke_width(5)))?;
        }
        chart.draw_series(self.points.iter().filter_map(|point| {
            let [low, high] = point.interval.filter(|[low, high]| high - low > 0.5)?;
            let style = self.series[point.series].0.filled().stroke_width(2);
            Some(ErrorBar::new_vertical(
                point.cost,
                low,
                point.gain.clamp(low, high),
                high,
                style,
                px(6) as u32,
            ))
        }))?;
        let base = below.get_base_pixel();
        let labels = self.points.iter().filter_map(|point| {
            let (x, y) = chart.backend_coord(&(point.cost, point.gain));
            Some(((x - base.0, y - base.1), point.name.clone()?, INK))
        });
        side_labels(&below, labels.collect(), names + px(14), (px(6), height as i32 - px(8)))?;
        for point in &self.points {
            let size = if point.name.is_some() { 5 } else { 3 };
            let colour = self.series[point.series].0;
            draw_marker(&mut chart, point.series, (point.cost, point.gain), colour, size)?;
        }
        Ok(())
    }
}

/// From each point of a front straight on to the cost at which more is had, then up.
fn stairs(front: &[(f64, f64)], end: f64) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for &(cost, gain) in front {
        line.extend(line.last().map(|&(_, before)| (cost, before)));
        line.push((cost, gain));
    }
    line.extend(line.last().map(|&(_, gain)| (end, gain)));
    line
}

/// A number in as few letters as it takes.
fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A point of a series: shapes tell series apart without their colours.
pub(crate) fn draw_marker<DB: DrawingBackend, X, Y>(
    chart: &mut ChartContext<DB, Cartesian2d<X, Y>>,
    series: usize,
    at: (f64, f64),
    colour: RGBColor,
    size: i32,
) -> Drawn<DB>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let r = px(size);
    let corners = match series % 5 {
        0 => {
            chart.draw_series([Circle::new(at, r, colour.filled())])?;
            return Ok(());
        }
        1 => vec![(-r, -r), (r, -r), (r, r), (-r, r)],
        2 => vec![(0, -r * 6 / 5), (r * 6 / 5, r), (-r * 6 / 5, r)],
        3 => vec![(0, -r * 4 / 3), (r * 4 / 3, 0), (0, r * 4 / 3), (-r * 4 / 3, 0)],
        _ => vec![(0, r * 6 / 5), (r * 6 / 5, -r), (-r * 6 / 5, -r)],
    };
    chart.draw_series([EmptyElement::at(at) + Polygon::new(corners, colour.filled())])?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [(3.0, 30.0), (1.0, 20.0), (2.0, 20.0), (4.0, 29.0), (1.0, 19.0)];
        assert_eq!(front(&points), [(1.0, 20.0), (3.0, 30.0)]);
        assert_eq!(stairs(&front(&points), 9.0), [(1.0, 20.0), (3.0, 20.0), (3.0, 30.0), (9.0, 30.0)]);
        assert!(front(&[]).is_empty());
        assert_eq!([plain(0.5), plain(20.0), plain(1e-9), plain(2e7)], ["0.5", "20", "1e-9", "2e7"]);
    }
}
