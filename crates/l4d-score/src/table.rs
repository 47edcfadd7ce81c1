//! Scores as aligned text, at most 100 columns wide.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::results::Track;
use l4d_data::{Category, Scale};
use textwrap::WordSplitter;

use crate::cluster::{Estimate, FEW_SCENES};
use crate::groups::{Group, GroupKind};
use crate::metrics::{Metric, Metrics};
use crate::summary::Summary;

pub(crate) const NAME_WIDTH: usize = 24;
/// Behind the numbers of methods that are ranked apart.
const DEPTH_MARK: &str = " *";

/// One row a method: the headline, then mIoU and mAcc per category and per scale.
pub fn render(summaries: &[Summary]) -> String {
    let mut text = String::new();
    headline(&mut text, summaries);
    if !summaries.is_empty() {
        groups(&mut text, summaries, "category", &Category::ALL.map(|key| (key, key.as_str())), |summary| {
            &summary.scores.categories
        });
        groups(&mut text, summaries, "scale", &Scale::ALL.map(|key| (key, key.as_str())), |summary| {
            &summary.scores.scales
        });
    }
    text
}

/// Groups of one method with 95 % intervals, a line each; single queries are left out.
pub fn render_groups(name: &str, groups: &[Group]) -> String {
    const COLUMNS: [&str; 3] = ["mIoU", "mAcc", "tube"];
    let mut text = format!("{name}, with 95 % intervals clustered by scene\n");
    let titles = COLUMNS.iter().map(|title| format!("{title:>20}"));
    line(&mut text, "group", ["  queries scenes".to_owned()].into_iter().chain(titles));
    let mut is_rough = false;
    for group in groups.iter().filter(|group| group.kind != GroupKind::Query) {
        let name = match group.kind {
            GroupKind::All | GroupKind::Scene | GroupKind::ScaleCategory => group.name.clone(),
            kind => format!("{} {}", kind.as_str(), group.name),
        };
        // A single scene has no interval to distrust.
        let is_few = group.few_scenes && group.scenes > 1;
        is_rough |= is_few;
        let scenes = format!("{:>9}{:>6}{}", group.queries, group.scenes, if is_few { "!" } else { " " });
        let values = [group.estimates.miou, group.estimates.macc, group.estimates.tube_iou];
        let cells = values.map(|value| format!("{:>20}", value.map_or_else(|| "-".to_owned(), estimate)));
        line(&mut text, &name, [scenes].into_iter().chain(cells));
    }
    if is_rough {
        text.push_str(&format!("! fewer than {FEW_SCENES} scenes: the interval may be too narrow\n"));
    }
    text
}

/// `45.2 [40.1, 50.3]`.
fn estimate(found: Estimate) -> String {
    match found.interval {
        Some([low, high]) => format!("{:.1} [{low:.1}, {high:.1}]", found.value),
        None => format!("{:.1}", found.value),
    }
}

fn headline(text: &mut String, summaries: &[Summary]) {
    let titles = Metric::ALL.into_iter().map(Metric::short_title).chain(["queries"]);
    let titles = titles.map(|title| format!("{title:>8}"));
    line(text, "method", titles);
    for summary in summaries {
        let Metrics { percent: values, queries } = &summary.scores.headline;
        let cells = Metric::ALL.into_iter().map(|metric| format!("{:>8}", percent(values.get(metric))));
        let track = if summary.used.depth { DEPTH_MARK } else { "" };
        let mark = if summary.partial { " partial" } else { "" };
        line(text, &summary.name, cells.chain([format!("{queries:>8}{track}{mark}")]));
    }
    if summaries.iter().any(|summary| summary.used.depth) {
        let title = Track::ColourDepth.title();
        text.push_str(&format!(
            "*: track {title}, learned from rendered depth: never ranked with the others\n"
        ));
    }
}

fn groups<K: Ord + Copy>(
    text: &mut String,
    summaries: &[Summary],
    what: &str,
    keys: &[(K, &str)],
    table: impl Fn(&Summary) -> &BTreeMap<K, Metrics>,
) {
    text.push('\n');
    line(text, &format!("mIoU mAcc by {what}"), keys.iter().map(|(_, name)| format!("{name:>17}")));
    for summary in summaries {
        let cells = keys.iter().map(|(key, _)| {
            let metrics = table(summary).get(key).copied().unwrap_or_default();
            format!("{:>9}{:>8}", percent(metrics.percent.miou), percent(metrics.percent.macc))
        });
        line(text, &summary.name, cells);
    }
}

pub(crate) fn line(text: &mut String, name: &str, cells: impl Iterator<Item = String>) {
    let short: String = name.chars().take(NAME_WIDTH).collect();
    let row = format!("{short:<NAME_WIDTH$}{}", cells.collect::<String>());
    text.push_str(row.trim_end());
    text.push('\n');
}

/// A percentage with two decimals; `-` where there is none.
pub(crate) fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

pub(crate) fn wrapped(text: &str) -> String {
    wrap(text, 100).join("\n") + "\n"
}

/// Lines of at most so many columns, broken at spaces alone.
pub fn wrap(text: &str, width: usize) -> Vec<String> {
    let options = textwrap::Options::new(width).break_words(false);
    let lines = textwrap::wrap(text, options.word_splitter(WordSplitter::NoHyphenation));
    lines.into_iter().map(Cow::into_owned).collect()
}
