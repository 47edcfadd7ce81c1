//! Means over queries with confidence intervals clustered by scene.
//!
//! Queries of one scene share objects, cameras and a model, so they are not independent: the scene is the unit.
//! The standard error is cluster-robust (Liang and Zeger, Biometrika 1986). The interval is studentized (bootstrap-t;
//! Cameron, Gelbach and Miller, Review of Economics and Statistics 2008): each of [`RESAMPLES`] resamples draws as many
//! scenes as there are, with replacement, and has a t statistic: how many of its own standard errors its mean is off.
//! Unlike a percentile interval this one follows skewed values; with 21 simulated scenes its coverage is about the
//! nominal one. Below [`FEW_SCENES`] the interval is Student's.
//!
//! The module knows values and scenes, not whether more is better. Differences of two methods: [`crate::compare`].

use std::collections::BTreeMap;

use l4d_data::{Name, QueryId};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF as _, StudentsT};

use crate::metrics::{QueryTally, Ratios};

/// Bootstrap resamples behind each interval.
pub const RESAMPLES: usize = 4000;
/// Intervals from fewer scenes than this may be too narrow: in simulations their coverage is 85 to 95 %.
pub const FEW_SCENES: usize = 8;
/// Probability below an interval, and above it.
pub(crate) const TAIL: f64 = 0.025;
/// Share of resamples without any spread beyond which the bootstrap is not used: these have no t statistic.
const MAX_DEGENERATE_SHARE: f64 = 0.01;
/// Relative to the values: smaller differences are rounding errors.
const ROUNDING: f64 = 1e-12;

/// A mean over queries with its standard error and confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    pub value: f64,
    /// Cluster-robust standard error of the mean; none from a single scene.
    pub standard_error: Option<f64>,
    /// 95 % confidence interval, low and high; none from a single scene.
    pub interval: Option<[f64; 2]>,
    /// Number of queries.
    pub queries: usize,
    /// Number of scenes that they come from.
    pub scenes: usize,
}

impl Estimate {
    /// The mean of values, each with its scene; none without values. The seed is that of the bootstrap.
    pub fn of<'a>(values: impl IntoIterator<Item = (&'a Name, f64)>, seed: u64) -> Option<Self> {
        Some(Sample::of(values)?.estimate(seed))
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
        Self::of(values, seed).map(|found| found.within(0.0, 100.0))
    }

    /// The mean over queries of what a ratio gains from `before` to `after`, percentage points; queries that lack it
    /// on either side are left out.
    pub fn of_gain<'a>(
        before: impl IntoIterator<Item = &'a QueryTally>,
        after: impl IntoIterator<Item = &'a QueryTally>,
        ratio: impl Fn(&Ratios) -> Option<f64>,
        seed: u64,
    ) -> Option<Self> {
        Some(Sample::of(gains(before, after, ratio))?.estimate(seed).within(-100.0, 100.0))
    }

    /// Clamps the interval to the range of the mean.
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { interval: self.interval.map(|interval| interval.map(|end| end.clamp(low, high))), ..self }
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

/// Paired differences of a ratio by query, percentage points, each with its scene.
pub(crate) fn gains<'a>(
    before: impl IntoIterator<Item = &'a QueryTally>,
    after: impl IntoIterator<Item = &'a QueryTally>,
    ratio: impl Fn(&Ratios) -> Option<f64>,
) -> Vec<(&'a Name, f64)> {
    let known = |tally: &'a QueryTally| Some((&tally.facts.id, ratio(&tally.ratios())?));
    let before: BTreeMap<&QueryId, f64> = before.into_iter().filter_map(known).collect();
    let gain = |(id, ratio): (&'a QueryId, f64)| Some((&id.scene, 100.0 * (ratio - before.get(id)?)));
    after.into_iter().filter_map(known).filter_map(gain).collect()
}

/// The values of one scene, summed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SceneSum {
    pub(crate) total: f64,
    pub(crate) queries: f64,
}

/// Values grouped by scene.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// In the order of the scenes' names.
    pub(crate) scenes: Vec<SceneSum>,
    /// Number of values in all.
    pub(crate) queries: f64,
}

impl Sample {
    /// None without values.
    pub(crate) fn of<'a>(values: impl IntoIterator<Item = (&'a Name, f64)>) -> Option<Self> {
        let mut scenes: BTreeMap<&Name, SceneSum> = BTreeMap::new();
        for (scene, value) in values {
            let sum = scenes.entry(scene).or_default();
            sum.total += value;
            sum.queries += 1.0;
        }
        let scenes: Vec<SceneSum> = scenes.into_values().collect();
        let queries = scenes.iter().map(|scene| scene.queries).sum();
        (!scenes.is_empty()).then_some(Self { scenes, queries })
    }

    pub(crate) fn mean(&self) -> f64 {
        self.scenes.iter().map(|scene| scene.total).sum::<f64>() / self.queries
    }

    /// Degrees of degrees_of_freedom of the standard error.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        degrees_of_freedom(self.queries, self.scenes.iter().map(|scene| scene.queries * scene.queries).sum())
    }

    pub(crate) fn estimate(&self, seed: u64) -> Estimate {
        let value = self.mean();
        let several = self.scenes.len() > 1;
        let residuals = Residuals::of(self, value);
        Estimate {
            value,
            standard_error: several.then(|| residuals.standard_error()),
            interval: several.then(|| residuals.interval(value, seed)),
            queries: self.queries as usize,
            scenes: self.scenes.len(),
        }
    }
}

/// The residuals of the scenes from the mean of all.
struct Residuals {
    scenes: Vec<Residual>,
    /// Over all scenes.
    sum: Residual,
}

/// Of one scene: r, the sum of its values minus n times the mean; n, the number of its values; and their products. Or
/// the sums of these over scenes.
#[derive(Debug, Clone, Copy, Default)]
struct Residual {
    r: f64,
    n: f64,
    rr: f64,
    rn: f64,
    nn: f64,
}

impl Residual {
    fn add(&mut self, other: &Self) {
        self.r += other.r;
        self.n += other.n;
        self.rr += other.rr;
        self.rn += other.rn;
        self.nn += other.nn;
    }

    /// The mean of the summed scenes minus the mean that the residuals were taken from.
    fn shift(&self) -> f64 {
        self.r / self.n
    }

    /// Sum of the squared residuals from the mean of the summed scenes themselves.
    fn spread(&self) -> f64 {
        let shift = self.shift();
        (self.rr - 2.0 * shift * self.rn + shift * shift * self.nn).max(0.0)
    }
}

impl Residuals {
    fn of(sample: &Sample, mean: f64) -> Self {
        // Equal values must have a spread of exactly zero, though their mean has a rounding error.
        let size: f64 =
            sample.scenes.iter().map(|scene| scene.total.abs() + mean.abs() * scene.queries).sum();
        let residual = |scene: &SceneSum| {
            let r = scene.total - mean * scene.queries;
            let r = if r.abs() <= ROUNDING * size { 0.0 } else { r };
            let n = scene.queries;
            Residual { r, n, rr: r * r, rn: r * n, nn: n * n }
        };
        let scenes: Vec<Residual> = sample.scenes.iter().map(residual).collect();
        let mut sum = Residual::default();
        scenes.iter().for_each(|scene| sum.add(scene));
        Self { scenes, sum }
    }

    fn standard_error(&self) -> f64 {
        let scenes = self.scenes.len() as f64;
        (scenes / (scenes - 1.0) * self.sum.rr).sqrt() / self.sum.n
    }

    fn interval(&self, mean: f64, seed: u64) -> [f64; 2] {
        let error = self.standard_error();
        if error == 0.0 {
            return [mean, mean];
        }
        let [low, high] = self.bootstrap_quantiles(seed).unwrap_or_else(|| {
            let t = student_quantile(1.0 - TAIL, degrees_of_freedom(self.sum.n, self.sum.nn));
            [-t, t]
        });
        // Quantiles of one sign would give an interval without the mean.
        [(mean - high * error).min(mean), (mean - low * error).max(mean)]
    }

    /// The 2.5 and 97.5 % quantiles of the resamples' t statistics; none if there are few scenes, or if too many
    /// resamples have no spread.
    fn bootstrap_quantiles(&self, seed: u64) -> Option<[f64; 2]> {
        let count = self.scenes.len();
        // Few scenes have few different resamples, some with hardly any spread: their t statistics are arbitrarily
        // large.
        if count < FEW_SCENES {
            return None;
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let correction = (count as f64 / (count as f64 - 1.0)).sqrt();
        let rounding = ROUNDING * self.sum.rr;
        let mut t_statistics = Vec::with_capacity(RESAMPLES);
        for _ in 0..RESAMPLES {
            let mut drawn = Residual::default();
            for _ in 0..count {
                drawn.add(&self.scenes[random.random_range(0..count)]);
            }
            let spread = drawn.spread();
            if spread > rounding {
                t_statistics.push(drawn.r / (correction * spread.sqrt()));
            }
        }
        let is_enough = t_statistics.len() as f64 >= (1.0 - MAX_DEGENERATE_SHARE) * RESAMPLES as f64;
        is_enough.then(|| {
            t_statistics.sort_unstable_by(f64::total_cmp);
            [quantile(&t_statistics, TAIL), quantile(&t_statistics, 1.0 - TAIL)]
        })
    }
}

/// The effective number of scenes (Kish, Survey Sampling 1965) minus one, at least one; from the sum of their numbers
/// of queries and the sum of the squares of these.
fn degrees_of_freedom(queries: f64, squared_queries: f64) -> f64 {
    (queries * queries / squared_queries - 1.0).max(1.0)
}

/// Quantile of Student's t distribution: a variable lies below it with probability `share`.
pub(crate) fn student_quantile(share: f64, degrees_of_freedom: f64) -> f64 {
    let student =
        StudentsT::new(0.0, 1.0, degrees_of_freedom).expect("scale and degrees_of_freedom are positive");
    student.inverse_cdf(share)
}

/// Quantile of ascending values, linear between the two nearest ranks.
fn quantile(ascending: &[f64], share: f64) -> f64 {
    let rank = share * (ascending.len() - 1) as f64;
    let (below, above) = (ascending[rank.floor() as usize], ascending[rank.ceil() as usize]);
    below + (above - below) * rank.fract()
}

#[cfg(test)]
mod tests {
    use l4d_data::{Category, Scale};

    use super::*;
    use crate::metrics::made_up;

    fn names(count: usize) -> Vec<Name> {
        (0..count).map(|index| Name::new(format!("scene{index}")).unwrap()).collect()
    }

    fn estimate(names: &[Name], values: &[(usize, f64)]) -> Option<Estimate> {
        Estimate::of(values.iter().map(|&(scene, value)| (&names[scene], value)), 0)
    }

    fn assert_close(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
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
    fn two_scenes_give_the_interval_worked_out_by_hand() {
        // A has two queries at 0, B one at 90: the residuals are -60 and 60. Two scenes are few, so the interval is
        // Student's, with one degree of degrees_of_freedom.
        let found = estimate(&names(2), &[(0, 0.0), (1, 90.0), (0, 0.0)]).unwrap();
        assert_eq!((found.value, found.queries, found.scenes), (30.0, 3, 2));
        let error = (2.0_f64 * (60.0 * 60.0 + 60.0 * 60.0)).sqrt() / 3.0;
        assert_close(found.standard_error.unwrap(), error);
        let [low, high] = found.interval.unwrap();
        assert!((high - 30.0 - 12.706_204_7 * error).abs() < 1e-4, "{found:?}");
        assert_close(high - 30.0, 30.0 - low);
        assert_eq!(found.within(0.0, 100.0).interval, Some([0.0, 100.0]));
        assert!(found.is_of_few_scenes() && !found.is_above_zero() && !found.is_below_zero());
    }

    #[test]
    fn no_values_one_scene_and_equal_values() {
        let names = names(8);
        assert_eq!(estimate(&names, &[]), None);
        let alone = estimate(&names, &[(0, 1.0), (0, 3.0)]).unwrap();
        assert_eq!((alone.value, alone.standard_error, alone.interval, alone.scenes), (2.0, None, None, 1));
        assert!(!alone.is_above_zero());
        // A third has no exact sum: that rounding must not become a spread.
        for value in [-4.0, 100.0 / 3.0, 0.1] {
            let equal: Vec<(usize, f64)> = (0..50).map(|index| (index * index % 8, value)).collect();
            let equal = estimate(&names, &equal).unwrap();
            assert_eq!(equal.standard_error, Some(0.0));
            assert_eq!(equal.interval, Some([equal.value, equal.value]));
            assert_close(equal.value, value);
        }
    }

    #[test]
    fn a_single_scene_that_differs_has_students_interval() {
        // A third of the resamples lack the one scene that differs, and so have no spread.
        let names = names(21);
        let values: Vec<(usize, f64)> =
            (0..21).map(|scene| (scene, if scene == 3 { 42.0 } else { 0.0 })).collect();
        let found = estimate(&names, &values).unwrap();
        assert_close(found.value, 2.0);
        assert_close(found.standard_error.unwrap(), 2.0);
        let [low, high] = found.interval.unwrap();
        assert!((high - 2.0 - 2.085_963_4 * 2.0).abs() < 1e-4 && low < 0.0, "{found:?}");
        assert_eq!(found.within(0.0, 100.0).interval.unwrap()[0], 0.0);
    }

    #[test]
    fn the_order_of_queries_does_not_matter_and_the_seed_does() {
        let names = names(9);
        let values: Vec<(usize, f64)> =
            (0..40).map(|index| (index * 4 % 9, (index * index % 11) as f64)).collect();
        let reversed: Vec<(usize, f64)> = values.iter().rev().copied().collect();
        assert_eq!(estimate(&names, &values), estimate(&names, &reversed));
        let seeded = |seed| Estimate::of(values.iter().map(|&(scene, value)| (&names[scene], value)), seed);
        assert_ne!(seeded(0), seeded(1));
        assert_eq!(seeded(0).unwrap().value, seeded(1).unwrap().value);
    }

    #[test]
    fn intervals_follow_the_skew_of_the_values() {
        // Most scenes are near 10, one is at 90: others that were not sampled would pull the mean up, not down.
        let names = names(21);
        let values: Vec<(usize, f64)> =
            (0..21).map(|scene| (scene, if scene == 0 { 90.0 } else { 8.0 + (scene % 5) as f64 })).collect();
        let found = estimate(&names, &values).unwrap();
        let [low, high] = found.interval.unwrap();
        assert!(high - found.value > 1.5 * (found.value - low), "{found:?}");
    }

    /// A query of a scene with one frame of this IoU; none: its target is never present.
    fn tally(id: &str, percent: Option<u64>) -> QueryTally {
        let counts = percent.map_or((0, 0, 0), |percent| (percent, 100, 100));
        made_up(id, Category::Action, Scale::Room, &[counts])
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
        assert_close(mean.value, 160.0 / 3.0);
        assert_eq!((mean.queries, mean.scenes), (3, 2));
        assert_eq!(mean.interval, Some([0.0, 100.0]));
        // Only a/001 (+20) and b/001 (-10) are on both sides.
        let gain = Estimate::of_gain(&before, &after, |ratios| ratios.miou, 0).unwrap();
        assert_close(gain.value, 5.0);
        assert_eq!((gain.queries, gain.scenes), (2, 2));
        assert_eq!(gain.interval, Some([-100.0, 100.0]));
    }
}
