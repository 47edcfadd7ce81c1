//! From the sums of single queries to tables: the four ways to average and every breakdown.

use std::collections::BTreeMap;

use l4d_data::{Category, Name, Scale};
use serde::{Deserialize, Serialize};

use crate::metrics::{Metrics, QueryTally, Ratios, Sums, ratio};

/// Ways to average. The headline is [`Average::MacroQuery`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Average {
    /// Every query weighs the same.
    MacroQuery,
    /// Every frame (mIoU, mAcc, false positives) or pixel (tube IoU) weighs the same.
    Micro,
    /// Every scene weighs the same.
    MacroScene,
    /// Every category weighs the same.
    MacroCategory,
}

/// All tables of one method.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Breakdown {
    /// The headline: mean over queries.
    #[serde(flatten)]
    pub headline: Metrics,
    /// By kind of reasoning; a composite query counts in each of its categories.
    pub categories: BTreeMap<Category, Metrics>,
    /// By scale of the scene.
    pub scales: BTreeMap<Scale, Metrics>,
    pub scenes: BTreeMap<Name, Metrics>,
    /// The same numbers averaged in other ways.
    pub averages: BTreeMap<Average, Metrics>,
}

impl Breakdown {
    /// Averages the queries of one method. The order of `tallies` fixes the order of every sum.
    pub fn of(tallies: &[QueryTally]) -> Self {
        let all: Vec<&QueryTally> = tallies.iter().collect();
        let categories =
            groups(Category::ALL, &all, |tally, category| tally.facts.categories.contains(category));
        let scales = groups(Scale::ALL, &all, |tally, scale| tally.facts.scale == *scale);
        let mut scenes: Vec<Name> = all.iter().map(|tally| tally.facts.id.scene.clone()).collect();
        scenes.dedup();
        let scenes = groups(scenes, &all, |tally, scene| tally.facts.id.scene == *scene);
        let headline = by_query(&all);
        let averages = BTreeMap::from([
            (Average::MacroQuery, headline),
            (Average::Micro, micro(&all)),
            (Average::MacroScene, by_group(&scenes, headline.1)),
            (Average::MacroCategory, by_group(&categories, headline.1)),
        ]);
        Self {
            headline: to_metrics(headline),
            categories: table(categories),
            scales: table(scales),
            scenes: table(scenes),
            averages: table(averages),
        }
    }
}

/// Ratios with the number of queries that they rest on.
type Averaged = (Ratios, usize);

fn by_query(tallies: &[&QueryTally]) -> Averaged {
    let ratios: Vec<Ratios> = tallies.iter().map(|tally| tally.ratios()).collect();
    (Ratios::mean(&ratios), tallies.iter().filter(|tally| tally.is_counted()).count())
}

fn micro(tallies: &[&QueryTally]) -> Averaged {
    let mut sums = Sums::default();
    let counted = tallies.iter().filter(|tally| tally.is_counted()).count() as u64;
    let selected = tallies.iter().filter(|tally| tally.is_counted() && tally.is_selected).count() as u64;
    for tally in tallies {
        // A query that is not counted adds to the false-positive rate and to nothing else.
        let mut added = tally.sums;
        if !tally.is_counted() {
            (added.intersection, added.union) = (0, 0);
        }
        sums.add(&added);
    }
    (sums.ratios(ratio(selected, counted)), counted as usize)
}

fn by_group<K>(groups: &BTreeMap<K, Averaged>, queries: usize) -> Averaged {
    let ratios: Vec<Ratios> = groups.values().map(|(ratios, _)| *ratios).collect();
    (Ratios::mean(&ratios), queries)
}

/// Averages each group that has a query.
fn groups<K: Ord>(
    keys: impl IntoIterator<Item = K>,
    tallies: &[&QueryTally],
    belongs: impl Fn(&QueryTally, &K) -> bool,
) -> BTreeMap<K, Averaged> {
    let members = |key: &K| -> Vec<&QueryTally> {
        tallies.iter().copied().filter(|tally| belongs(tally, key)).collect()
    };
    let groups = keys.into_iter().map(|key| (members(&key), key));
    groups
        .filter(|(members, _)| !members.is_empty())
        .map(|(members, key)| (key, by_query(&members)))
        .collect()
}

fn table<K: Ord>(groups: BTreeMap<K, Averaged>) -> BTreeMap<K, Metrics> {
    groups.into_iter().map(|(key, averaged)| (key, to_metrics(averaged))).collect()
}

fn to_metrics((ratios, queries): Averaged) -> Metrics {
    Metrics::new(&ratios, queries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::made_up as tally;

    #[test]
    fn the_four_averages_weigh_as_they_say() {
        // IoU 1/2 and 1; 0; 1/4 of one frame and a false alarm of 6 pixels in another; never present.
        let tallies = [
            tally("farm/001", Category::Action, Scale::Outdoor, &[(2, 4, 4), (4, 4, 4)]),
            tally("farm/002", Category::Spatial, Scale::Outdoor, &[(0, 8, 4)]),
            tally("room/001", Category::Action, Scale::Room, &[(1, 4, 2), (0, 6, 0)]),
            tally("room/002", Category::Attribute, Scale::Room, &[(0, 0, 0)]),
        ];
        let found = Breakdown::of(&tallies);
        let miou = |average| found.averages[&average].percent.miou.unwrap() / 100.0;
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
        };
        close(miou(Average::MacroQuery), (0.75 + 0.0 + 0.25) / 3.0);
        close(miou(Average::Micro), (0.5 + 1.0 + 0.0 + 0.25) / 4.0);
        close(miou(Average::MacroScene), (0.375 + 0.25) / 2.0);
        close(miou(Average::MacroCategory), (0.5 + 0.0) / 2.0);

        let tube = |average| found.averages[&average].percent.tube_iou.unwrap() / 100.0;
        close(tube(Average::MacroQuery), (6.0 / 8.0 + 0.0 + 1.0 / 10.0) / 3.0);
        close(tube(Average::Micro), 7.0 / 26.0);

        // One frame without a target in each of the last two queries, and an alarm in the first of them.
        let false_positives = |average| found.averages[&average].percent.false_positive_rate.unwrap() / 100.0;
        close(false_positives(Average::MacroQuery), (1.0 + 0.0) / 2.0);
        close(false_positives(Average::Micro), 1.0 / 2.0);

        assert_eq!(found.headline.queries, 3);
        assert_eq!(found.categories[&Category::Attribute].percent.miou, None);
        assert_eq!(found.categories[&Category::Attribute].queries, 0);
        assert!(!found.categories.contains_key(&Category::Interaction));
        close(found.scales[&Scale::Outdoor].percent.select.unwrap(), 50.0);
    }

    #[test]
    fn nothing_to_average_is_null_and_never_nan() {
        let found = Breakdown::of(&[tally("room/002", Category::Attribute, Scale::Room, &[(0, 0, 0)])]);
        let text = serde_json::to_string(&found).unwrap();
        assert!(text.starts_with(r#"{"miou":null,"macc":null"#) && !text.contains("NaN"), "{text}");
        let again: Breakdown = serde_json::from_str(&text).unwrap();
        assert_eq!(again, found);
    }
}
