//! Whether two methods differ by more than the choice of scenes explains.
//!
//! Differences are taken query by query, then summed by scene. If neither method were better, every scene could as well
//! have come out the other way round: the test flips the signs of whole scenes and asks how often the mean is then as many
//! of its standard errors off zero as it was found to be. With up to [`MOST_EXACT`] scenes all ways to flip are counted and
//! nothing is drawn. With n scenes that differ no p value is below 2 / 2^n: five scenes never reach 0.05.
//!
//! Several pairs make several chances to be wrong: [`holm`] corrects for all of a table. The minimum detectable
//! difference says what a comparison could have found at all: a true difference of that size comes out with p below 0.05
//! four times in five.

use l4d_data::Name;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::cluster::{Estimate, Sample, TAIL, gains, student_quantile};
use crate::metrics::{QueryTally, Ratios};

/// With more scenes that differ, signs are drawn instead of counted.
pub const MOST_EXACT: usize = 21;
/// Draws of signs for more scenes than that.
pub const DRAWS: u32 = 1 << 17;
/// Below this p value a difference is called one.
pub const ALPHA: f64 = 2.0 * TAIL;
/// Probability of finding a difference of the size called detectable.
pub const POWER: f64 = 0.8;
/// Relative: ways to flip that differ by rounding alone are equal.
const ROUNDING: f64 = 1e-9;
/// Scenes whose signs are looked up together.
const CHUNK: usize = 10;

/// Two methods on the queries that both have a number for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Mean over queries of the first less the second, percentage points.
    pub difference: Estimate,
    /// How likely a difference at least as clear would be if none were better, from 0 to 1, two-sided, of this pair alone.
    pub p: f64,
    /// The least p that so many differing scenes can give.
    pub least_p: f64,
    /// The true difference that would be found four times in five, percentage points, at [`ALPHA`] without
    /// correction; none from so few scenes that no p value is below it, and where all scenes differ alike, since then
    /// nothing says how much they vary.
    pub detectable: Option<f64>,
}

impl Comparison {
    /// Compares a ratio of two methods; none if they share no query that has it.
    pub fn of<'a>(
        first: impl IntoIterator<Item = &'a QueryTally>,
        second: impl IntoIterator<Item = &'a QueryTally>,
        ratio: impl Fn(&Ratios) -> Option<f64>,
        seed: u64,
    ) -> Option<Self> {
        Self::of_differences(gains(second, first, ratio), seed)
            .map(|found| Self { difference: found.difference.within(-100.0, 100.0), ..found })
    }

    /// Compares by the differences of single queries, with their scenes; none without any.
    pub fn of_differences<'a>(
        differences: impl IntoIterator<Item = (&'a Name, f64)>,
        seed: u64,
    ) -> Option<Self> {
        let sample = Sample::of(differences)?;
        let difference = sample.estimate(seed);
        let flips = Flips::of(&sample);
        let degrees_of_freedom = sample.degrees_of_freedom();
        let reach =
            student_quantile(1.0 - TAIL, degrees_of_freedom) + student_quantile(POWER, degrees_of_freedom);
        Some(Self {
            difference,
            p: flips.p(seed),
            least_p: least_p(flips.scenes.len()),
            detectable: difference
                .standard_error
                .filter(|&error| error > 0.0 && least_p(sample.scenes.len()) < ALPHA)
                .map(|error| reach * error),
        })
    }
}

/// One pair of a table of methods.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Index of the first method.
    pub first: usize,
    /// Index of the second, always behind the first.
    pub second: usize,
    /// The pair alone.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// p, corrected for all pairs of the table (Holm).
    pub holm_p: f64,
}

impl Pair {
    /// Whether the difference remains one after correction.
    pub fn is_different(&self) -> bool {
        self.holm_p < ALPHA
    }
}

/// Compares each of several methods with each behind it, in that order. Left out are pairs without a common query and
/// those whose common queries are all of one scene: it says nothing of others, so that there is nothing to test.
pub fn all_pairs(
    methods: &[&[QueryTally]],
    ratio: impl Fn(&Ratios) -> Option<f64> + Sync,
    seed: u64,
) -> Vec<Pair> {
    let pairs: Vec<(usize, usize)> = (0..methods.len())
        .flat_map(|first| (first + 1..methods.len()).map(move |second| (first, second)))
        .collect();
    let compared: Vec<(usize, usize, Comparison)> = pairs
        .into_par_iter()
        .filter_map(|(first, second)| {
            let found = Comparison::of(methods[first], methods[second], &ratio, seed)?;
            (found.difference.scenes > 1).then_some((first, second, found))
        })
        .collect();
    let corrected = holm(&compared.iter().map(|(.., comparison)| comparison.p).collect::<Vec<_>>());
    compared
        .into_iter()
        .zip(corrected)
        .map(|((first, second, comparison), holm_p)| Pair { first, second, comparison, holm_p })
        .collect()
}

/// Corrects p values for their number (Holm, Scandinavian Journal of Statistics 1979): the chance that any of those
/// below [`ALPHA`] is there by accident stays below it. In the order given.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut ascending: Vec<usize> = (0..p_values.len()).collect();
    ascending.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![0.0; p_values.len()];
    let mut largest: f64 = 0.0;
    for (rank, &index) in ascending.iter().enumerate() {
        largest = largest.max((p_values.len() - rank) as f64 * p_values[index]).min(1.0);
        corrected[index] = largest;
    }
    corrected
}

/// The least p value that so many scenes that differ can give.
fn least_p(differing: usize) -> f64 {
    if differing > MOST_EXACT {
        return 1.0 / (f64::from(DRAWS) + 1.0);
    }
    (2.0 * 0.5_f64.powi(differing as i32)).min(1.0)
}

/// What flipping the sign of a scene changes. Queries that do not differ count in the mean and in its standard error,
/// whatever the signs.
struct Flips {
    /// Sum of differences, and that times the number of queries, of each scene that differs.
    scenes: Vec<Signed>,
    found: Signed,
    /// Sum of squared sums; no flip changes it.
    squares: f64,
    /// Queries of all scenes.
    queries: f64,
    /// Sum of squared numbers of queries.
    squared_queries: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Signed {
    total: f64,
    weighted: f64,
}

impl Signed {
    fn plus(self, other: Self) -> Self {
        Self { total: self.total + other.total, weighted: self.weighted + other.weighted }
    }

    fn times(self, sign: f64) -> Self {
        Self { total: sign * self.total, weighted: sign * self.weighted }
    }
}

impl Flips {
    fn of(sample: &Sample) -> Self {
        let scenes: Vec<Signed> = sample
            .scenes
            .iter()
            .filter(|scene| scene.total != 0.0)
            .map(|scene| Signed { total: scene.total, weighted: scene.total * scene.queries })
            .collect();
        Self {
            found: scenes.iter().copied().fold(Signed::default(), Signed::plus),
            squares: scenes.iter().map(|scene| scene.total * scene.total).sum(),
            queries: sample.queries,
            squared_queries: sample.scenes.iter().map(|scene| scene.queries * scene.queries).sum(),
            scenes,
        }
    }

    fn p(&self, seed: u64) -> f64 {
        let Some((last, free)) = self.scenes.split_last() else { return 1.0 };
        let bar = Bar::of(self);
        if self.scenes.len() > MOST_EXACT {
            return self.drawn_p(&bar, seed);
        }
        // Flipping all scenes changes nothing, so that the sign of one of them can stay.
        let (low, high) = free.split_at(free.len().min(CHUNK));
        let (low, high) = (all_signs(low), all_signs(high));
        let as_clear = |high: &Signed| -> u32 {
            let fixed = last.plus(*high);
            low.iter().map(|&low| u32::from(bar.is_reached(fixed.plus(low)))).sum()
        };
        f64::from(high.iter().map(as_clear).sum::<u32>()) / (low.len() * high.len()) as f64
    }

    fn drawn_p(&self, bar: &Bar, seed: u64) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let tables: Vec<Vec<Signed>> = self.scenes.chunks(CHUNK).map(all_signs).collect();
        let mut drawn = || {
            let parts = tables.iter().map(|table| table[random.random_range(0..table.len())]);
            parts.fold(Signed::default(), Signed::plus)
        };
        let as_clear: u32 = (0..DRAWS).map(|_| u32::from(bar.is_reached(drawn()))).sum();
        // What was found is one of the ways to flip.
        f64::from(as_clear + 1) / f64::from(DRAWS + 1)
    }

    /// Sum of the squared residuals of the scenes from their mean, as in [`Estimate::standard_error`].
    fn spread(&self, flipped: Signed) -> f64 {
        let mean = flipped.total / self.queries;
        self.squares + mean * (mean * self.squared_queries - 2.0 * flipped.weighted)
    }
}

/// What a way to flip must reach to be as clear as what was found. Compared are squares: (sum / spread) of the flipped with
/// that of the found, each side multiplied by the other's spread, which may be zero. With the spread written out that is
/// a polynomial in the two sums of the flipped, so that a million ways to flip cost milliseconds.
struct Bar {
    of_square: f64,
    of_product: f64,
    constant: f64,
}

impl Bar {
    fn of(flips: &Flips) -> Self {
        let found = flips.found.total * flips.found.total;
        Self {
            of_square: flips.spread(flips.found)
                - found * flips.squared_queries / (flips.queries * flips.queries),
            of_product: 2.0 * found / flips.queries,
            constant: (ROUNDING - 1.0) * found * flips.squares,
        }
    }

    fn is_reached(&self, flipped: Signed) -> bool {
        let Signed { total, weighted } = flipped;
        total * (self.of_square * total + self.of_product * weighted) + self.constant >= 0.0
    }
}

/// The sums of some scenes under all signs.
fn all_signs(scenes: &[Signed]) -> Vec<Signed> {
    let mut sums = vec![Signed::default()];
    for scene in scenes {
        sums = [1.0, -1.0]
            .into_iter()
            .flat_map(|sign| sums.iter().map(move |sum| sum.plus(scene.times(sign))))
            .collect();
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(count: usize) -> Vec<Name> {
        (0..count).map(|index| Name::new(format!("scene{index:03}")).unwrap()).collect()
    }

    fn compare(differences: &[(usize, f64)]) -> Comparison {
        let names = names(200);
        let differences = differences.iter().map(|&(scene, value)| (&names[scene], value));
        Comparison::of_differences(differences, 0).unwrap()
    }

    /// Scenes of one query each.
    fn single(differences: &[f64]) -> Comparison {
        compare(&differences.iter().copied().enumerate().collect::<Vec<_>>())
    }

    #[test]
    fn p_values_by_hand() {
        // All four scenes on one side: of 16 ways to flip only all and none are as clear.
        assert_eq!(single(&[1.0, 2.0, 3.0, 4.0]).p, 2.0 / 16.0);
        // One against three: as clear are all flips whose sum is 1+2+4-3 = 4 or more, or -4 or less: of the signs of
        // (1,2,3,4) sums of 10 (+), 8, 6, 4, 4 and their mirrors.
        assert_eq!(single(&[1.0, 2.0, -3.0, 4.0]).p, 10.0 / 16.0);
        // Scenes without a difference say nothing.
        assert_eq!(single(&[1.0, 2.0, 3.0, 4.0, 0.0, 0.0]).p, 2.0 / 16.0);
        assert_eq!(single(&[0.0, 0.0, 0.0]).p, 1.0);
        assert_eq!(single(&[5.0]).p, 1.0);
        // The same difference everywhere has no standard error, and nothing is clearer.
        let same = single(&[3.0; 6]);
        assert_eq!((same.p, same.least_p), (2.0 / 64.0, 2.0 / 64.0));
        assert_eq!(single(&[3.0; 5]).least_p, 2.0 / 32.0);
    }

    #[test]
    fn all_signs_are_counted_as_a_plain_loop_does() {
        // Unequal scenes, more than one chunk of them.
        let sizes = [1_u32, 5, 2, 9, 1, 3, 3, 7, 2, 4, 6, 1, 2];
        let differences: Vec<(usize, f64)> = sizes
            .iter()
            .enumerate()
            .flat_map(|(scene, &size)| {
                (0..size).map(move |query| (scene, ((scene * 7 + query as usize * 5) % 11) as f64 - 3.5))
            })
            .collect();
        let total = |scene| -> f64 {
            differences.iter().filter(|(of, _)| *of == scene).map(|(_, value)| value).sum()
        };
        let totals: Vec<f64> = (0..sizes.len()).map(total).collect();
        let queries: f64 = sizes.iter().map(|&size| f64::from(size)).sum();
        let clearness = |signs: usize| {
            let sign = |scene: usize| if signs >> scene & 1 == 0 { 1.0 } else { -1.0 };
            let mean =
                totals.iter().enumerate().map(|(scene, total)| sign(scene) * total).sum::<f64>() / queries;
            let residual =
                |(scene, total): (usize, &f64)| sign(scene) * total - mean * f64::from(sizes[scene]);
            let spread: f64 = totals.iter().enumerate().map(|part| residual(part).powi(2)).sum();
            mean.abs() / spread.sqrt()
        };
        let ways = 1 << sizes.len();
        let as_clear = (0..ways).filter(|&signs| clearness(signs) >= clearness(0) * (1.0 - 1e-9)).count();
        let found = compare(&differences);
        assert_eq!(found.p, as_clear as f64 / ways as f64);
        assert!(found.p > 0.01 && found.p < 0.99, "{}", found.p);
    }

    #[test]
    fn every_p_is_as_likely_as_it_says() {
        // If no method is better, each way to flip a study is as likely: all of them together have to give every p
        // twice, one for each side, from the least to one.
        let sizes = [1_u32, 4, 2, 7, 1, 3, 5, 2];
        let totals = [3.1, -20.3, 8.7, 40.9, 6.2, -11.4, 0.9, 17.3];
        let of_flip = |signs: usize| {
            let signed = |scene: usize| if signs >> scene & 1 == 0 { totals[scene] } else { -totals[scene] };
            let queries = |scene: usize| {
                let share = signed(scene) / f64::from(sizes[scene]);
                (0..sizes[scene]).map(move |_| (scene, share))
            };
            compare(&(0..sizes.len()).flat_map(queries).collect::<Vec<_>>()).p
        };
        let ways = 1 << sizes.len();
        let mut found: Vec<f64> = (0..ways).map(of_flip).collect();
        found.sort_by(f64::total_cmp);
        let expected = (0..ways).map(|rank| (rank / 2 + 1) as f64 * 2.0 / ways as f64);
        assert!(found.into_iter().eq(expected));
    }

    #[test]
    fn drawn_signs_come_near_counted_ones() {
        // Tiny scenes more push the number over what is counted, and change nearly nothing.
        let mut differences: Vec<f64> = (0..20).map(|scene| f64::from(scene * 13 % 20) - 6.0).collect();
        let counted = single(&differences);
        differences.extend([1e-9; 4]);
        let drawn = single(&differences);
        assert!(counted.p > 0.005 && (drawn.p / counted.p - 1.0).abs() < 0.1, "{} {}", counted.p, drawn.p);
        assert_eq!(drawn.least_p, 1.0 / 131_073.0);
    }

    #[test]
    fn corrections_are_those_of_the_paper() {
        assert_eq!(holm(&[]), Vec::<f64>::new());
        assert_eq!(holm(&[0.02]), [0.02]);
        let found = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (found, expected) in found.iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
        }
        assert_eq!(holm(&[0.6, 0.5, 0.0]), [1.0, 1.0, 0.0]);
    }

    #[test]
    fn what_can_be_detected_follows_from_the_standard_error() {
        let found = single(&[1.0, 2.0, -3.0, 4.0, 2.0, 0.0]);
        // Student's quantiles with five degrees of degrees_of_freedom.
        let reach = 2.570_581_8 + 0.919_543_8;
        let error = found.difference.standard_error.unwrap();
        assert!((found.detectable.unwrap() / error - reach).abs() < 1e-5, "{found:?}");
        // Of five scenes no p value is below 0.05, so nothing is detectable.
        assert_eq!(single(&[1.0, 2.0, -3.0, 4.0, 2.0]).detectable, None);
        assert_eq!(single(&[1.0]).detectable, None);
        // A method and itself: no difference varies, which does not mean that any would have been seen.
        assert_eq!(single(&[0.0; 9]).detectable, None);
    }
}
