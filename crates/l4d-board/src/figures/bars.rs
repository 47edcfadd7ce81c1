//! Bars with intervals: one panel per group of queries or metric, one row per method.

use l4d_data::{Category, Scale};
use l4d_score::cluster::FEW_SCENES;
use l4d_score::{GroupKind, Metric};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{
    Area, BLUE, Chart, Drawn, INK, Plot, QUIET, SHADE, beside, bold, font, legend, percent_rows, px,
    shortened,
};
use super::{named, shown};
use crate::board::{Board, Method};
use crate::ranking::{BestTwo, Emphasis};

/// Print pixels of a row, of the names, and beside the bars for their values.
const ROW: i32 = 20;
const NAMES: i32 = 150;
const VALUES: i32 = 38;
const NAME_LETTERS: usize = 26;

/// Panels side by side with common rows.
pub(crate) struct Bars {
    /// Names of the methods, and whether they are ranked.
    names: Vec<(String, bool)>,
    panels: Vec<Panel>,
}

struct Panel {
    title: String,
    note: String,
    /// One per method.
    bars: Vec<Option<Bar>>,
}

/// Percent.
struct Bar {
    value: f64,
    interval: Option<[f64; 2]>,
    /// Among the ranked methods of its track.
    is_best: bool,
}

/// mIoU in each category.
pub(crate) fn per_category(board: &Board) -> Bars {
    let groups = Category::ALL.map(|category| (GroupKind::Category, category.as_str()));
    of_groups(board, &groups, |method, place| {
        method.scores.categories.get(&Category::ALL[place])?.get(Metric::Miou)
    })
}

/// mIoU at each spatial scale.
pub(crate) fn per_scale(board: &Board) -> Bars {
    let groups = Scale::ALL.map(|scale| (GroupKind::Scale, scale.as_str()));
    of_groups(board, &groups, |method, place| method.scores.scales.get(&Scale::ALL[place])?.get(Metric::Miou))
}

/// mIoU beside the metrics that see what it does not: times without a target, and the wrong instance.
pub(crate) fn metrics(board: &Board) -> Bars {
    let panel = |metric: Metric| {
        let estimate = |method: &Method| method.group(GroupKind::All, "all")?.estimates.get(metric);
        Panel {
            title: metric.title().to_owned(),
            note: counted(board.heading.queries, Some(board.heading.scenes)),
            bars: bars(board, metric, |method| method.headline(metric), |method| estimate(method)?.interval),
        }
    };
    Bars { names: names(board), panels: [Metric::Miou, Metric::TubeIou, Metric::Select].map(panel).into() }
}

fn of_groups(
    board: &Board,
    groups: &[(GroupKind, &str)],
    miou: impl Fn(&Method, usize) -> Option<f64>,
) -> Bars {
    let panel = |(place, (kind, name)): (usize, &(GroupKind, &str))| {
        let found = board.methods.iter().filter_map(|method| method.group(*kind, name));
        let (queries, scenes) =
            (found.clone().map(|group| group.queries).max(), found.map(|group| group.scenes).max());
        let interval = |method: &Method| method.group(*kind, name)?.estimates.miou?.interval;
        Panel {
            title: title_case(name),
            note: counted(queries.unwrap_or(0), scenes),
            bars: bars(board, Metric::Miou, |method| miou(method, place), interval),
        }
    };
    Bars { names: names(board), panels: groups.iter().enumerate().map(panel).collect() }
}

fn names(board: &Board) -> Vec<(String, bool)> {
    shown(board)
        .iter()
        .map(|method| (shortened(&named(method), NAME_LETTERS), method.rank.is_some()))
        .collect()
}

fn bars(
    board: &Board,
    metric: Metric,
    value: impl Fn(&Method) -> Option<f64>,
    interval: impl Fn(&Method) -> Option<[f64; 2]>,
) -> Vec<Option<Bar>> {
    let bar = |method: &&Method| {
        let found = value(method)?;
        let best_two = |track| BestTwo::of_track(board, track, metric, &value);
        let is_best =
            method.ranked_in().is_some_and(|track| best_two(track).emphasis(found) == Emphasis::Best);
        Some(Bar { value: found, interval: interval(method), is_best })
    };
    shown(board).iter().map(bar).collect()
}

fn counted(queries: usize, scenes: Option<usize>) -> String {
    let plural =
        |count: usize, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
    let mark = if scenes.is_some_and(|scenes| scenes < FEW_SCENES) { " !" } else { "" };
    let scenes = scenes.map(|scenes| format!(", {}{mark}", plural(scenes, "scene", "scenes")));
    format!("{}{}", plural(queries, "query", "queries"), scenes.unwrap_or_default())
}

fn title_case(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

impl Plot for Bars {
    fn height(&self) -> i32 {
        20 + 34 + ROW * self.names.len().max(1) as i32 + 20
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let (above, below) = area.split_vertically(px(20));
        legend(
            &above,
            &[
                (BLUE, "ranked (bold: best of its track)"),
                (SHADE, "not ranked, shown for scale"),
                (INK, "line: 95 % interval, ! from fewer than 8 scenes: may be too narrow"),
            ],
        )?;
        let (_, panels) = below.split_horizontally(px(NAMES));
        for (place, (panel, area)) in
            self.panels.iter().zip(panels.split_evenly((1, self.panels.len()))).enumerate()
        {
            area.draw(&Text::new(panel.title.clone(), (0, 0), bold(11)))?;
            area.draw(&Text::new(panel.note.clone(), (0, px(15)), font(10, QUIET)))?;
            let plot = area.margin(px(34), 0, 0, px(VALUES));
            let mut chart = percent_rows(&plot, self.names.len())?;
            self.panel(&mut chart, panel)?;
            if place == 0 {
                let rows = self.names.iter().enumerate();
                chart.draw_series(rows.map(|(row, (name, is_ranked))| {
                    let colour = if *is_ranked { INK } else { QUIET };
                    let style = beside(font(11, colour), HPos::Right);
                    EmptyElement::at((0.0, self.y(row))) + Text::new(name.clone(), (-px(6), 0), style)
                }))?;
            }
        }
        Ok(())
    }
}

impl Bars {
    fn y(&self, row: usize) -> f64 {
        self.names.len() as f64 - row as f64 - 0.5
    }

    fn panel<DB: DrawingBackend>(&self, chart: &mut Chart<DB>, panel: &Panel) -> Drawn<DB> {
        let bars = || panel.bars.iter().zip(&self.names).enumerate();
        chart.draw_series(bars().filter_map(|(row, (bar, (_, is_ranked)))| {
            let fill = if *is_ranked { BLUE } else { SHADE };
            let (value, y) = (bar.as_ref()?.value, self.y(row));
            Some(Rectangle::new([(0.0, y - 0.28), (value, y + 0.28)], fill.filled()))
        }))?;
        chart.draw_series(bars().filter_map(|(row, (bar, _))| {
            let bar = bar.as_ref()?;
            let [low, high] = bar.interval.filter(|[low, high]| high - low > 0.5)?;
            let style = INK.filled().stroke_width(2);
            Some(ErrorBar::new_horizontal(
                self.y(row),
                low,
                bar.value.clamp(low, high),
                high,
                style,
                px(5) as u32,
            ))
        }))?;
        chart.draw_series(bars().map(|(row, (bar, _))| {
            let (text, style) = match bar {
                None => ("–".to_owned(), font(10, QUIET)),
                Some(bar) if bar.is_best => (format!("{:.1}", bar.value), bold(10)),
                Some(bar) => (format!("{:.1}", bar.value), font(10, INK)),
            };
            let style = beside(style, HPos::Right);
            EmptyElement::at((100.0, self.y(row))) + Text::new(text, (px(VALUES - 6), 0), style)
        }))?;
        Ok(())
    }
}
