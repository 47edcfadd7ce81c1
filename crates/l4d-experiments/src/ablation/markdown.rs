//! The page: the paper's layout, intervals, what consensus changes, and where each number comes from.

use std::fmt::Write as _;

use l4d_score::cluster::{FEW_SCENES, RESAMPLES};

use super::gain::{Gain, LosingScene};
use super::grid::ABSTAINING;
use super::table::{ALL, Cell, Column, Metric, Source, cell, settings};

/// Losing scenes that are named, for each correlation.
const NAMED_SCENES: usize = 3;
/// After rows that looked at the truth.
const TRUTH_MARK: &str = " †";

/// Everything that the page says.
pub(super) struct Page<'a> {
    pub(super) title: &'a str,
    /// What was run: a sentence each.
    pub(super) about: &'a [String],
    pub(super) columns: &'a [Column],
    pub(super) cells: &'a [Cell],
    pub(super) gains: &'a [Gain],
    pub(super) losing_scenes: &'a [LosingScene],
    pub(super) left_out: &'a [String],
}

impl Page<'_> {
    pub(super) fn text(&self) -> String {
        let mut text = format!("# {}\n\n", self.title);
        for sentence in self.about {
            text.push_str(&format!("{sentence}\n"));
        }
        text.push('\n');
        self.values(&mut text);
        self.notes(&mut text);
        self.intervals(&mut text);
        if !self.gains.is_empty() {
            self.changes(&mut text);
            self.losses(&mut text);
        }
        text
    }

    fn rows(&self) -> impl Iterator<Item = (Source, &str)> {
        [Source::Measured, Source::Published]
            .into_iter()
            .flat_map(|source| settings(self.cells, source).into_iter().map(move |setting| (source, setting)))
    }

    /// mAcc and mIoU of each kind of queries, a row a setting.
    fn values(&self, text: &mut String) {
        let titles = self
            .columns
            .iter()
            .flat_map(|column| Metric::PRINTED.map(|metric| format!("{} {}", column.name, metric.title())));
        let titles: Vec<String> = std::iter::once("setting".to_owned()).chain(titles).collect();
        header(text, &titles);
        for (source, setting) in self.rows() {
            let cells = self.columns.iter().flat_map(|column| {
                Metric::PRINTED.map(|metric| {
                    let found = cell(self.cells, source, setting, &column.name, metric);
                    found.map_or_else(|| "-".to_owned(), |cell| format!("{:.2}", cell.value))
                })
            });
            row(text, std::iter::once(self.label(source, setting)).chain(cells));
        }
        text.push('\n');
    }

    fn label(&self, source: Source, setting: &str) -> String {
        match source {
            Source::Measured if self.used_truth(setting) => format!("{setting}{TRUTH_MARK}"),
            Source::Measured => setting.to_owned(),
            Source::Published => format!("*paper, another data set:* {setting}"),
        }
    }

    fn used_truth(&self, setting: &str) -> bool {
        self.cells
            .iter()
            .any(|cell| cell.source == Source::Measured && cell.setting == setting && cell.used_truth)
    }

    fn notes(&self, text: &mut String) {
        text.push_str("Percent.");
        if self.cells.iter().any(|cell| cell.source == Source::Published) {
            text.push_str(
                " Rows of the paper are printed in it (arXiv 2604.05638) and belong to its own scenes, sentences and masks: no \
                 difference to them says who is better.",
            );
        }
        text.push('\n');
        if self.cells.iter().any(|cell| cell.used_truth) {
            text.push_str(
                "† looked at the truth of the training views: it measures consensus and lifting, is no result of a method, and \
                 cannot be ranked.\n",
            );
        }
        for missing in self.left_out {
            writeln!(text, "Left out: {missing}.").ok();
        }
        text.push('\n');
    }

    fn intervals(&self, text: &mut String) {
        writeln!(
            text,
            "## Intervals\n\n95 % intervals of the measured rows: studentized, {RESAMPLES} draws of whole scenes with all their queries.\n"
        )
        .ok();
        header(
            text,
            &["setting", "queries of", "number", "scenes", "mAcc", "mIoU", "tube IoU", "select"]
                .map(str::to_owned),
        );
        let mut is_rough = false;
        for setting in settings(self.cells, Source::Measured) {
            for column in self.columns {
                let found = |metric| cell(self.cells, Source::Measured, setting, &column.name, metric);
                let Some(first) = Metric::ALL.into_iter().find_map(found) else { continue };
                let scenes = first.scenes.unwrap_or_default();
                is_rough |= scenes < FEW_SCENES;
                let mark = if scenes < FEW_SCENES { " (!)" } else { "" };
                let head = [
                    self.label(Source::Measured, setting),
                    column.name.clone(),
                    first.queries.unwrap_or_default().to_string(),
                    format!("{scenes}{mark}"),
                ];
                let cells =
                    Metric::ALL.map(|metric| found(metric).map_or_else(|| "-".to_owned(), with_interval));
                row(text, head.into_iter().chain(cells));
            }
        }
        if is_rough {
            writeln!(text, "\n(!) fewer than {FEW_SCENES} scenes: the interval may be too narrow.").ok();
        }
        text.push('\n');
    }

    fn changes(&self, text: &mut String) {
        text.push_str(
            "## What consensus changes\n\nDifference of two rows, query by query, percentage points: with consensus less \
             without it. `gains` and `loses` where the whole interval lies on one side of zero.\n\n",
        );
        let titles = [
            "row",
            "rho",
            "queries of",
            "number",
            "scenes",
            "mAcc",
            "mIoU",
            "tube IoU",
            "by mIoU it",
            "paper's mIoU difference",
        ];
        header(text, &titles.map(str::to_owned));
        for gain in self.gains.iter().filter(|gain| gain.metric == Metric::Miou) {
            let same = |metric| {
                self.gains.iter().find(|other| {
                    other.metric == metric
                        && other.row == gain.row
                        && other.correlation == gain.correlation
                        && other.column == gain.column
                })
            };
            let value = |metric| {
                same(metric).map_or_else(|| "-".to_owned(), |gain| signed_with_interval(&gain.cell()))
            };
            let mark = if gain.found.is_of_few_scenes() { " (!)" } else { "" };
            row(
                text,
                [
                    gain.row.to_owned(),
                    gain.correlation.map_or_else(|| "-".to_owned(), |rho| rho.to_string()),
                    gain.column.clone(),
                    gain.found.queries.to_string(),
                    format!("{}{mark}", gain.found.scenes),
                    value(Metric::Macc),
                    value(Metric::Miou),
                    value(Metric::TubeIou),
                    gain.verdict().to_owned(),
                    gain.published.map_or_else(|| "-".to_owned(), |points| format!("{points:+.2}")),
                ],
            );
        }
        text.push('\n');
    }

    fn losses(&self, text: &mut String) {
        text.push_str("## Where consensus loses\n\n");
        let of_paper = |gain: &&Gain| Metric::PRINTED.contains(&gain.metric) && gain.found.value < 0.0;
        let losing: Vec<&Gain> = self.gains.iter().filter(of_paper).collect();
        if losing.is_empty() {
            text.push_str("In no kind of queries, by mean mAcc or mIoU.\n");
        }
        for gain in losing {
            let kind = if gain.column == ALL {
                "all queries".to_owned()
            } else {
                format!("{} queries", gain.column)
            };
            let certainty = match gain.found.interval {
                Some([_, high]) if high < 0.0 => "the interval lies below zero",
                Some(_) => "the interval holds zero",
                None => "one scene, no interval",
            };
            let abstaining = if gain.row == ABSTAINING { ", abstaining" } else { "" };
            let errors = format!("{}{abstaining}", correlated(gain.correlation));
            let value = signed_with_interval(&gain.cell());
            writeln!(text, "- {kind}{errors}: {} {value}; {certainty}.", gain.metric.title()).ok();
        }
        let mut correlations: Vec<Option<f64>> =
            self.losing_scenes.iter().map(|scene| scene.correlation).collect();
        correlations.dedup();
        for correlation in correlations {
            let scenes: Vec<&LosingScene> =
                self.losing_scenes.iter().filter(|scene| scene.correlation == correlation).collect();
            let named = scenes
                .iter()
                .take(NAMED_SCENES)
                .map(|scene| format!("{} {:+.2} ({} queries)", scene.scene, scene.points, scene.queries));
            let named: Vec<String> = named.collect();
            let more = if scenes.len() > NAMED_SCENES { ", worst first" } else { "" };
            writeln!(
                text,
                "- Scenes with a lower mean mIoU{}: {}{more}: {}.",
                correlated(correlation),
                scenes.len(),
                named.join(", ")
            )
            .ok();
        }
    }
}

fn correlated(rho: Option<f64>) -> String {
    rho.map(|rho| format!(" at rho {rho}")).unwrap_or_default()
}

fn with_interval(cell: &Cell) -> String {
    match (cell.low, cell.high) {
        (Some(low), Some(high)) => format!("{:.2} ({low:.2} to {high:.2})", cell.value),
        _ => format!("{:.2}", cell.value),
    }
}

fn signed_with_interval(cell: &Cell) -> String {
    match (cell.low, cell.high) {
        (Some(low), Some(high)) => format!("{:+.2} ({low:+.2} to {high:+.2})", cell.value),
        _ => format!("{:+.2}", cell.value),
    }
}

fn header(text: &mut String, titles: &[String]) {
    row(text, titles.iter().cloned());
    let rules =
        titles.iter().enumerate().map(|(index, _)| if index == 0 { "---" } else { "---:" }.to_owned());
    row(text, rules);
}

fn row(text: &mut String, cells: impl IntoIterator<Item = String>) {
    // A setting may come from a file name; a bar would end its cell.
    let cells: Vec<String> = cells.into_iter().map(|cell| cell.replace('|', "\\|")).collect();
    writeln!(text, "| {} |", cells.join(" | ")).ok();
}
