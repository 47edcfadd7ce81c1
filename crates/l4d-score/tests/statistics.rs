//! What intervals, p values and detectable differences promise, on studies whose truth is known, and the numbers
//! themselves against those of statsmodels and SciPy (`statistics/reference.py`).
//!
//! Scenes differ in how hard they are and in how many queries they have; values are like IoUs: some are zero, because the
//! wrong thing or nothing was marked, and the rest lie below 100.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::path::Path;
use std::process::Command;

use l4d_data::Name;
use l4d_score::compare::{ALPHA, holm};
use l4d_score::{Comparison, Estimate};
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Beta, Distribution as _, StandardNormal};
use serde::Deserialize;

const REFERENCE: &str = include_str!("statistics/reference.json");

/// Queries of a scene, from few to many.
const SIZES: [usize; 21] = [4, 5, 6, 7, 8, 8, 9, 10, 11, 12, 13, 14, 14, 15, 16, 17, 19, 20, 22, 24, 27];
/// Of the difficulty of scenes, in log odds.
const BETWEEN_SCENES: f64 = 0.8;
/// Of a query that is a hit.
const SHAPE: f64 = 1.5;

/// Share of zeros in a scene of middling difficulty.
const ZEROS: f64 = 0.4;

fn names() -> Vec<Name> {
    (0..SIZES.len()).map(|index| Name::new(format!("scene{index:02}")).unwrap()).collect()
}

/// How easy a scene makes hits, and how good it makes them.
fn chances(effect: f64) -> (f64, f64) {
    let odds = (1.0 - ZEROS) / ZEROS * effect.exp();
    (odds / (1.0 + odds), 4.0 * (0.3 * effect).exp())
}

fn effect(random: &mut ChaCha8Rng) -> f64 {
    let normal: f64 = StandardNormal.sample(random);
    BETWEEN_SCENES * normal
}

fn value(effect: f64, random: &mut ChaCha8Rng) -> f64 {
    let (hit, shape) = chances(effect);
    let quality = Beta::new(shape, SHAPE).unwrap().sample(random);
    if random.random_range(0.0..1.0) < hit { 100.0 * quality } else { 0.0 }
}

/// The mean over all scenes that there could be, by numerical integration over their difficulty.
fn true_mean() -> f64 {
    let steps = -4000..=4000;
    let weigh = |step: i32| {
        let normal = f64::from(step) * 0.002;
        let (hit, shape) = chances(BETWEEN_SCENES * normal);
        let density = (-0.5 * normal * normal).exp();
        [density, density * 100.0 * hit * shape / (shape + SHAPE)]
    };
    let [mass, sum] = steps.map(weigh).fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
    sum / mass
}

/// Numbers of queries of the scenes of one study.
fn sizes(scenes: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let mut sizes = SIZES;
    sizes.shuffle(random);
    sizes[..scenes].to_vec()
}

/// How often the interval holds the true mean.
fn coverage(scenes: usize, studies: u64) -> f64 {
    let (names, mean) = (names(), true_mean());
    let mut random = ChaCha8Rng::seed_from_u64(20);
    let mut holds = 0;
    for study in 0..studies {
        let mut values = Vec::new();
        for (scene, size) in names.iter().zip(sizes(scenes, &mut random)) {
            let effect = effect(&mut random);
            values.extend((0..size).map(|_| (scene, value(effect, &mut random))));
        }
        let found = Estimate::of(values, study).unwrap().within(0.0, 100.0);
        let [low, high] = found.interval.unwrap();
        holds += u32::from(low <= mean && mean <= high);
    }
    f64::from(holds) / studies as f64
}

/// Two methods whose hits and quality are equally likely, in a scene of one difficulty, with the first so far ahead.
fn compare(scenes: usize, ahead: f64, study: u64, random: &mut ChaCha8Rng) -> Comparison {
    let names = names();
    let mut differences = Vec::new();
    for (scene, size) in names.iter().zip(sizes(scenes, random)) {
        let effect = effect(random);
        for _ in 0..size {
            let difference = value(effect, random) - value(effect, random);
            differences.push((scene, difference + ahead));
        }
    }
    Comparison::of_differences(differences, study).unwrap()
}

fn comparisons(scenes: usize, ahead: f64, studies: u64) -> Vec<Comparison> {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    (0..studies).map(|study| compare(scenes, ahead, study, &mut random)).collect()
}

/// How far p values are from uniform ones.
#[derive(Debug)]
struct Uniformity {
    /// Share below [`ALPHA`].
    rejected: f64,
    /// How large that share is of uniform ones: p has as many values as there are ways to flip, over two.
    expected: f64,
    /// How far `rejected` may be off `expected`, 99 times in 100.
    most_off: f64,
    /// Of Kolmogorov and Smirnov, looked at where p can be.
    distance: f64,
    /// What it stays below 99 times in 100.
    most_distance: f64,
}

impl Uniformity {
    fn of(p: &[f64], scenes: usize) -> Self {
        let (count, ways) = (p.len() as f64, f64::from(1_u32 << (scenes - 1)));
        let share = |is: &dyn Fn(f64) -> bool| p.iter().filter(|p| is(**p)).count() as f64 / count;
        let mut ascending = p.to_vec();
        ascending.sort_by(f64::total_cmp);
        let distance = (1..=ways as u32).map(|way| {
            let at = f64::from(way) / ways;
            (ascending.partition_point(|p| *p <= at) as f64 / count - at).abs()
        });
        let expected = ((ALPHA * ways).ceil() - 1.0) / ways;
        Self {
            rejected: share(&|p| p < ALPHA),
            expected,
            most_off: 2.576 * (expected * (1.0 - expected) / count).sqrt(),
            distance: distance.fold(0.0, f64::max),
            most_distance: 1.628 / count.sqrt(),
        }
    }

    fn is_plausible(&self) -> bool {
        (self.rejected - self.expected).abs() <= self.most_off && self.distance < self.most_distance
    }
}

#[derive(Deserialize)]
struct Study {
    scenes: Vec<usize>,
    values: Vec<Vec<f64>>,
    estimates: Vec<Reference>,
    pairs: Vec<ReferencePair>,
}

#[derive(Deserialize)]
struct Reference {
    value: f64,
    standard_error: f64,
    /// Between what the lower end lies: the same twice where nothing is drawn.
    low: [f64; 2],
    high: [f64; 2],
}

#[derive(Deserialize)]
struct ReferencePair {
    first: usize,
    second: usize,
    difference: Reference,
    p: f64,
    holm_p: f64,
    detectable: f64,
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}

fn assert_estimate(found: Estimate, expected: &Reference) {
    assert_near(found.value, expected.value, 1e-8);
    let error = found.standard_error.unwrap();
    assert_near(error, expected.standard_error, 1e-8);
    let rounding = 1e-6 * error;
    for (end, [least, most]) in found.interval.unwrap().into_iter().zip([expected.low, expected.high]) {
        assert!((least - rounding..=most + rounding).contains(&end), "{end} is not in {least} to {most}");
    }
}

#[test]
fn numbers_are_those_of_statsmodels_and_scipy() {
    let names = names();
    let studies: Vec<Study> = serde_json::from_str(REFERENCE).unwrap();
    let is_drawn = |study: &Study| study.estimates[0].low[0] < study.estimates[0].low[1];
    assert_eq!(
        [true, false].map(|drawn| studies.iter().filter(|study| is_drawn(study) == drawn).count()),
        [2, 4]
    );
    for study in studies {
        let of_scenes = |values: Vec<f64>| study.scenes.iter().map(|scene| &names[*scene]).zip(values);
        for (values, expected) in study.values.iter().zip(&study.estimates) {
            assert_estimate(Estimate::of(of_scenes(values.clone()), 0).unwrap(), expected);
        }
        let mut p_values = Vec::new();
        for pair in &study.pairs {
            let [first, second] = [pair.first, pair.second].map(|method| &study.values[method]);
            let differences = first.iter().zip(second).map(|(first, second)| first - second).collect();
            let found = Comparison::of_differences(of_scenes(differences), 0).unwrap();
            assert_estimate(found.difference, &pair.difference);
            assert_near(found.p, pair.p, 1e-8);
            // From five scenes or fewer no p value is below 0.05, whatever the difference.
            assert_eq!(found.detectable.is_some(), found.difference.scenes > 5);
            if let Some(detectable) = found.detectable {
                assert_near(detectable, pair.detectable, 1e-6 * pair.detectable);
            }
            p_values.push(found.p);
        }
        for (found, pair) in holm(&p_values).into_iter().zip(&study.pairs) {
            assert_near(found, pair.holm_p, 1e-8);
        }
    }
}

/// The committed reference is what the script writes.
#[test]
#[ignore = "needs Python with numpy, scipy and statsmodels in L4D_REFERENCE_PYTHON"]
fn the_reference_is_reproducible() {
    let python = std::env::var_os("L4D_REFERENCE_PYTHON").unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/statistics/reference.py");
    let output = Command::new(python).arg(script).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), REFERENCE);
}

#[test]
fn intervals_hold_the_true_mean_as_often_as_they_say() {
    let found = coverage(21, 1000);
    assert!((0.92..=0.97).contains(&found), "{found}");
}

#[test]
fn p_values_of_the_same_method_twice_are_uniform_on_the_values_that_they_can_have() {
    for scenes in [3, 5, 6, 8, 12] {
        let found = comparisons(scenes, 0.0, 3000);
        let p: Vec<f64> = found.iter().map(|found| found.p).collect();
        let uniformity = Uniformity::of(&p, scenes);
        assert!(uniformity.is_plausible(), "{scenes} scenes: {uniformity:?}");
        // Too few scenes to tell anything apart: then nothing ever is.
        assert!(scenes > 5 || (uniformity.expected, uniformity.rejected) == (0.0, 0.0), "{uniformity:?}");
    }
}

#[test]
fn what_is_called_detectable_is_found_four_times_in_five() {
    let detectable: Vec<f64> =
        comparisons(21, 0.0, 800).iter().map(|found| found.detectable.unwrap()).collect();
    let mean = detectable.iter().sum::<f64>() / detectable.len() as f64;
    let found = comparisons(21, mean, 800);
    let power = found.iter().filter(|found| found.p < ALPHA).count() as f64 / found.len() as f64;
    assert!((0.75..=0.85).contains(&power), "{power}");
}
