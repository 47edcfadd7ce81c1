//! The page: the paper's layout, intervals, what consensus changes, and where each number comes from.

use std::iter::once;

use l4d_score::Estimate;
use l4d_score::cluster::{FEW_SCENES, RESAMPLES};

use super::gain::Gain;
use super::table::{Cell, Column, Metric, Source, cell, settings};

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
    pub(super) left_out: &'a [String],
}

impl Page<'_> {
    pub(super) fn text(&self) -> String {
        let mut text = format!("# {}\n\n{}\n\n", self.title, self.about.join("\n"));
        self.values(&mut text);
        self.notes(&mut text);
        self.intervals(&mut text);
        if !self.gains.is_empty() {
            self.changes(&mut text);
        }
        text
    }

    /// mAcc and mIoU of each kind of queries, a row a setting.
    fn values(&self, text: &mut String) {
        let columns =
            || self.columns.iter().flat_map(|column| Metric::PRINTED.map(|metric| (column, metric)));
        let titles = columns().map(|(column, metric)| format!("{} {}", column.name, metric.title()));
        header(text, once("setting".to_owned()).chain(titles));
        for source in [Source::Measured, Source::Published] {
            for setting in settings(self.cells, source) {
                let cells = columns().map(|(column, metric)| {
                    let found = cell(self.cells, source, setting, &column.name, metric);
                    found.map_or_else(|| "-".to_owned(), |cell| format!("{:.2}", cell.value))
                });
                row(text, once(self.label(source, setting)).chain(cells));
            }
        }
        text.push('\n');
    }

    fn label(&self, source: Source, setting: &str) -> String {
        let used_truth = |cell: &Cell| cell.source == source && cell.setting == setting && cell.used_truth;
        match source {
            Source::Published => format!("*paper, another data set:* {setting}"),
            Source::Measured if self.cells.iter().any(used_truth) => format!("{setting}{TRUTH_MARK}"),
            Source::Measured => setting.to_owned(),
        }
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
            text.push_str(&format!("Left out: {missing}.\n"));
        }
        text.push('\n');
    }

    fn intervals(&self, text: &mut String) {
        text.push_str(&format!(
            "## Intervals\n\n95 % intervals of the measured rows: studentized, {RESAMPLES} draws of whole scenes with all their \
             queries.\n\n"
        ));
        let titles = ["setting", "queries of", "number", "scenes"].map(str::to_owned);
        header(text, titles.into_iter().chain(Metric::ALL.map(|metric| metric.title().to_owned())));
        let mut is_rough = false;
        for setting in settings(self.cells, Source::Measured) {
            for column in self.columns {
                let found = |metric| cell(self.cells, Source::Measured, setting, &column.name, metric);
                let Some(first) = Metric::ALL.into_iter().find_map(found) else { continue };
                let scenes = first.scenes.unwrap_or_default();
                is_rough |= scenes < FEW_SCENES;
                let head = [
                    self.label(Source::Measured, setting),
                    column.name.clone(),
                    first.queries.unwrap_or_default().to_string(),
                    marked(scenes),
                ];
                let value = |cell: &Cell| match (cell.low, cell.high) {
                    (Some(low), Some(high)) => format!("{:.2} ({low:.2} to {high:.2})", cell.value),
                    _ => format!("{:.2}", cell.value),
                };
                let cells = Metric::ALL.map(|metric| found(metric).map_or_else(|| "-".to_owned(), value));
                row(text, head.into_iter().chain(cells));
            }
        }
        if is_rough {
            text.push_str(&format!(
                "\n(!) fewer than {FEW_SCENES} scenes: the interval may be too narrow.\n"
            ));
        }
        text.push('\n');
    }

    fn changes(&self, text: &mut String) {
        text.push_str(
            "## What consensus changes\n\nDifference of two rows, query by query, percentage points: with consensus less \
             without it. `gains` and `loses` where the whole interval lies on one side of zero.\n\n",
        );
        let titles = ["row", "rho", "queries of", "number", "scenes", "mAcc", "mIoU", "tube IoU"];
        let titles = titles.into_iter().chain(["by mIoU it", "paper's mIoU difference"]);
        header(text, titles.map(str::to_owned));
        let dash = || "-".to_owned();
        for gain in self.gains {
            let Some(found) = gain.of(Metric::Miou) else { continue };
            let value = |metric| gain.of(metric).map_or_else(dash, signed);
            let verdict = match found {
                found if found.is_above_zero() => "gains",
                found if found.is_below_zero() => "loses",
                _ => "not told apart",
            };
            row(
                text,
                [
                    gain.pair.row.to_owned(),
                    gain.pair.correlation.map_or_else(dash, |rho| rho.to_string()),
                    gain.column.clone(),
                    found.queries.to_string(),
                    marked(found.scenes),
                    value(Metric::Macc),
                    value(Metric::Miou),
                    value(Metric::TubeIou),
                    verdict.to_owned(),
                    gain.published.map_or_else(dash, |points| format!("{points:+.2}")),
                ],
            );
        }
        text.push('\n');
    }
}

/// A number of scenes, and whether they are few.
fn marked(scenes: usize) -> String {
    format!("{scenes}{}", if scenes < FEW_SCENES { " (!)" } else { "" })
}

fn signed(found: &Estimate) -> String {
    match found.interval {
        Some([low, high]) => format!("{:+.2} ({low:+.2} to {high:+.2})", found.value),
        None => format!("{:+.2}", found.value),
    }
}

fn header(text: &mut String, titles: impl Iterator<Item = String>) {
    let titles: Vec<String> = titles.collect();
    let rules = once("---").chain(titles.iter().skip(1).map(|_| "---:")).map(str::to_owned);
    let rules: Vec<String> = rules.collect();
    row(text, titles);
    row(text, rules);
}

fn row(text: &mut String, cells: impl IntoIterator<Item = String>) {
    // A setting may come from a file name; a bar would end its cell.
    let cells: Vec<String> = cells.into_iter().map(|cell| cell.replace('|', "\\|")).collect();
    text.push_str(&format!("| {} |\n", cells.join(" | ")));
}
