//! Means over queries with intervals that know that the queries of a scene hang together.
//!
//! Queries of one scene share objects, cameras and a model, so they are no independent draws: a whole scene is drawn
//! with all its queries, as often as there are scenes, and the interval holds the middle 95 % of the means of
//! [`RESAMPLES`] such draws (cluster bootstrap, percentile interval). Differences of two methods are taken query by
//! query first. The module knows values and scenes; it refuses to say what is good.

use std::collections::BTreeMap;

use l4d_data::{Name, QueryId};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::metrics::{QueryTally, Ratios};

/// Draws behind each interval.
pub const RESAMPLES: usize = 2000;
/// Intervals from fewer scenes than this say little: there are too few ways to draw them.
pub const FEW_SCENES: usize = 5;
/// Share of the draws that lies below an interval, and above it.
const TAIL: f64 = 0.025;

/// A mean over queries, and how far it may be off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// Mean over queries.
    pub value: f64,
    /// The middle 95 % of the means of resampled scenes, low and high; none from a single scene, which says nothing of
    /// others.
    pub interval: Option<[f64; 2]>,
    /// Queries that it rests on.
    pub queries: usize,
    /// Scenes that they come from.
    pub scenes: usize,
}

impl Estimate {
    /// The mean of values that belong to scenes; none without values.
    pub fn of<'a>(values: impl IntoIterator<Item = (&'a Name, f64)>, seed: u64) -> Option<Self> {
        let mut scenes: BTreeMap<&Name, Sum> = BTreeMap::new();
        for (scene, value) in values {
            let sum = scenes.entry(scene).or_default();
            sum.total += value;
            sum.queries += 1;
        }
        let sums: Vec<Sum> = scenes.into_values().collect();
        let all = sums.iter().copied().fold(Sum::default(), Sum::plus);
        (all.queries > 0).then(|| Self {
            value: all.mean(),
            interval: (sums.len() > 1).then(|| interval(&sums, seed)),
            queries: all.queries,
            scenes: sums.len(),
        })
    }

    /// The mean of a ratio over queries, percent; queries without it are left out.
    pub fn of_ratio<'a>(
        tallies: impl IntoIterator<Item = &'a QueryTally>,
        ratio: impl Fn(&Ratios) -> Option<f64>,
        seed: u64,
    ) -> Option<Self> {
        let values = tallies
            .into_iter()
            .filter_map(|tally| ratio(&tally.ratios()).map(|ratio| (&tally.facts.id.scene, 100.0 * ratio)));
        Self::of(values, seed)
    }

    /// The mean over queries of what a ratio gains from `before` to `after`, percentage points; queries that lack it
    /// on either side are left out.
    pub fn of_gain<'a>(
        before: impl IntoIterator<Item = &'a QueryTally>,
        after: impl IntoIterator<Item = &'a QueryTally>,
        ratio: impl Fn(&Ratios) -> Option<f64>,
        seed: u64,
    ) -> Option<Self> {
        let known = |tally: &'a QueryTally| Some((&tally.facts.id, ratio(&tally.ratios())?));
        let before: BTreeMap<&QueryId, f64> = before.into_iter().filter_map(known).collect();
        let values = after
            .into_iter()
            .filter_map(known)
            .filter_map(|(id, ratio)| before.get(id).map(|before| (&id.scene, 100.0 * (ratio - before))));
        Self::of(values, seed)
    }

    /// Whether there are too few scenes for the interval to be trusted.
    pub fn is_of_few_scenes(&self) -> bool {
        self.scenes < FEW_SCENES
    }

    /// Whether the whole interval lies above zero.
    pub fn is_above_zero(&self) -> bool {
        self.interval.is_some_and(|[low, _]| low > 0.0)
    }

    /// Whether the whole interval lies below zero.
    pub fn is_below_zero(&self) -> bool {
        self.interval.is_some_and(|[_, high]| high < 0.0)
    }
}

/// The queries of one scene, or of many.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    total: f64,
    queries: usize,
}

impl Sum {
    fn plus(self, other: Self) -> Self {
        Self { total: self.total + other.total, queries: self.queries + other.queries }
    }

    fn mean(self) -> f64 {
        self.total / self.queries as f64
    }
}

fn interval(scenes: &[Sum], seed: u64) -> [f64; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut drawn = || scenes[random.random_range(0..scenes.len())];
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| scenes.iter().fold(Sum::default(), |sum, _| sum.plus(drawn())).mean())
        .collect();
    means.sort_by(f64::total_cmp);
    [quantile(&means, TAIL), quantile(&means, 1.0 - TAIL)]
}

/// Between the two nearest of some ascending values, by their ranks.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let rank = share * (ascending.len() - 1) as f64;
    let (below, above) = (ascending[rank.floor() as usize], ascending[rank.ceil() as usize]);
    below + (above - below) * rank.fract()
}

#[cfg(test)]
mod tests {
    use l4d_data::{Category, Scale};

    use super::*;
    use crate::counts::{FrameCount, State};
    use crate::metrics::{Options, QueryFacts};

    fn names(count: usize) -> Vec<Name> {
        (0..count).map(|index| Name::new(format!("scene{index}")).unwrap()).collect()
    }

    fn estimate(names: &[Name], values: &[(usize, f64)]) -> Option<Estimate> {
        Estimate::of(values.iter().map(|&(scene, value)| (&names[scene], value)), 0)
    }

    #[test]
    fn quantiles_lie_between_ranks() {
        assert_eq!(quantile(&[1.0], 0.3), 1.0);
        assert_eq!(
            [0.0, 0.25, 0.5, 1.0].map(|share| quantile(&[0.0, 10.0, 20.0], share)),
            [0.0, 5.0, 10.0, 20.0]
        );
    }

    #[test]
    fn two_scenes_by_hand() {
        // A has two queries at 0, B one at 90. Drawn are AA (0), BB (90) and twice a mix (30): each pure draw is a
        // quarter, so both ends of the middle 95 % are pure.
        let found = estimate(&names(2), &[(0, 0.0), (1, 90.0), (0, 0.0)]).unwrap();
        assert_eq!(found, Estimate { value: 30.0, interval: Some([0.0, 90.0]), queries: 3, scenes: 2 });
        assert!(found.is_of_few_scenes() && !found.is_above_zero() && !found.is_below_zero());
    }

    #[test]
    fn no_values_one_scene_and_equal_values() {
        let names = names(6);
        assert_eq!(estimate(&names, &[]), None);
        let alone = estimate(&names, &[(0, 1.0), (0, 3.0)]).unwrap();
        assert_eq!((alone.value, alone.interval, alone.scenes), (2.0, None, 1));
        assert!(!alone.is_above_zero());
        let equal: Vec<(usize, f64)> = (0..12).map(|index| (index % 6, -4.0)).collect();
        let equal = estimate(&names, &equal).unwrap();
        assert_eq!((equal.value, equal.interval, equal.scenes), (-4.0, Some([-4.0, -4.0]), 6));
        assert!(equal.is_below_zero() && !equal.is_of_few_scenes());
    }

    #[test]
    fn the_order_of_queries_does_not_matter_and_the_seed_does() {
        let names = names(7);
        let values: Vec<(usize, f64)> =
            (0..40).map(|index| (index * 3 % 7, (index * index % 11) as f64)).collect();
        let reversed: Vec<(usize, f64)> = values.iter().rev().copied().collect();
        assert_eq!(estimate(&names, &values), estimate(&names, &reversed));
        let seeded = |seed| Estimate::of(values.iter().map(|&(scene, value)| (&names[scene], value)), seed);
        assert_ne!(seeded(0), seeded(1));
        assert_eq!(seeded(0).unwrap().value, seeded(1).unwrap().value);
    }

    /// How often the interval holds the true mean, 0, of some made-up studies: 20 scenes of 6 queries, which share a
    /// normal effect of their scene (deviation 10) beside their own (deviation 5).
    fn coverage(is_clustered: bool, studies: u64) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let names = names(120);
        let mut normal = |deviation: f64| {
            let uniform = (0..12).map(|_| random.random_range(0.0..1.0_f64)).sum::<f64>();
            deviation * (uniform - 6.0)
        };
        let mut holds = 0;
        for study in 0..studies {
            let mut values = Vec::new();
            for scene in 0..20 {
                let shared = normal(10.0);
                for query in 0..6 {
                    let cluster = if is_clustered { scene } else { scene * 6 + query };
                    values.push((&names[cluster], shared + normal(5.0)));
                }
            }
            let [low, high] = Estimate::of(values, study).unwrap().interval.unwrap();
            holds += u32::from(low <= 0.0 && 0.0 <= high);
        }
        f64::from(holds) / studies as f64
    }

    #[test]
    fn intervals_hold_the_true_mean_about_as_often_as_they_say() {
        let clustered = coverage(true, 100);
        assert!((0.85..=0.99).contains(&clustered), "{clustered}");
    }

    #[test]
    fn without_clusters_intervals_would_be_far_too_narrow() {
        let naive = coverage(false, 40);
        assert!(naive < 0.82, "{naive}");
    }

    /// A query of a scene with one frame of this IoU; none: its target is never present.
    fn tally(id: &str, percent: Option<u64>) -> QueryTally {
        let id: QueryId = id.parse().unwrap();
        let facts = QueryFacts {
            id: id.clone(),
            categories: vec![Category::Action],
            scale: Scale::Room,
            referents: Vec::new(),
            verified: false,
        };
        let count = FrameCount {
            query: id,
            frame: 0,
            state: State::Hit,
            intersection: percent.unwrap_or_default(),
            union: if percent.is_some() { 100 } else { 0 },
            predicted: percent.unwrap_or_default(),
            truth: if percent.is_some() { 100 } else { 0 },
            instance: None,
            instance_overlap: 0,
        };
        QueryTally::of(facts, &[count], &Options::default())
    }

    #[test]
    fn ratios_are_percent_and_gains_are_paired() {
        let before = [
            tally("a/001", Some(50)),
            tally("a/002", Some(20)),
            tally("b/001", Some(90)),
            tally("b/002", None),
        ];
        let after = [
            tally("b/002", Some(10)),
            tally("b/001", Some(80)),
            tally("a/001", Some(70)),
            tally("c/001", Some(5)),
        ];
        let mean = Estimate::of_ratio(&before, |ratios| ratios.miou, 0).unwrap();
        assert!((mean.value - 160.0 / 3.0).abs() < 1e-9, "{mean:?}");
        assert_eq!((mean.queries, mean.scenes), (3, 2));
        // Only a/001 (+20) and b/001 (-10) are on both sides.
        let gain = Estimate::of_gain(&before, &after, |ratios| ratios.miou, 0).unwrap();
        assert!((gain.value - 5.0).abs() < 1e-9, "{gain:?}");
        assert_eq!((gain.queries, gain.scenes), (2, 2));
        let [low, high] = gain.interval.unwrap();
        assert!((low + 10.0).abs() < 1e-9 && (high - 20.0).abs() < 1e-9, "{gain:?}");
    }
}
