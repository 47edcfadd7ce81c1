//! Coefficients against published worked examples, and against a second implementation in Python.

use std::io::Write as _;
use std::process::{Command, Stdio};

use l4d_data::{Interval, Temporal};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::Response;
use crate::agreement::{Undefined, Unit, gwet_ac1, krippendorff_alpha, measure, raw, wilson};
use crate::fixture::{meaning, objects, poll_in, whole};

/// Of Krippendorff (2011), section C, and of Gwet's irrCAC, `cac.raw4raters`.
const FOUR_RATERS: [&str; 4] = [
    "1 2 3 3 2 1 4 1 2 * * *",
    "1 2 3 3 2 2 4 1 2 5 * 3",
    "* 3 3 3 2 3 4 2 2 5 1 *",
    "1 2 3 3 2 4 4 1 2 5 1 *",
];

/// One row per rater, one column per item, `*` where an answer is missing.
fn raters(rows: &[&str]) -> Vec<Unit> {
    let rows: Vec<Vec<&str>> = rows.iter().map(|row| row.split_whitespace().collect()).collect();
    let code = |label: &str| u32::from(label.as_bytes()[0]);
    let column = |item: usize| rows.iter().map(move |row| row[item]).filter(|label| *label != "*").map(code);
    (0..rows[0].len()).map(|item| Unit { cluster: 0, labels: column(item).collect() }).collect()
}

/// One row per item: how many raters chose each label.
fn counts<const LABELS: usize>(rows: &[[usize; LABELS]]) -> Vec<Unit> {
    let unit = |row: &[usize; LABELS]| {
        let labels = row.iter().zip(0..).flat_map(|(&count, label)| std::iter::repeat_n(label, count));
        Unit { cluster: 0, labels: labels.collect() }
    };
    rows.iter().map(unit).collect()
}

#[track_caller]
fn near(value: Result<f64, Undefined>, expected: f64, tolerance: f64) {
    let value = value.unwrap();
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

/// Krippendorff, Computing Krippendorff's Alpha-Reliability (2011), sections A, B and C.
#[test]
fn alpha_of_krippendorffs_examples() {
    let binary = raters(&["0 1 0 0 0 0 0 0 1 0", "1 1 1 0 0 1 0 0 0 0"]);
    near(krippendorff_alpha(&binary), 0.095, 5e-4);
    near(krippendorff_alpha(&binary), 2.0 / 21.0, 1e-12);
    let nominal = raters(&["a a b b d c c c e d d a", "b a b b b c c c e d d d"]);
    near(krippendorff_alpha(&nominal), 0.692, 5e-4);
    let missing = raters(&FOUR_RATERS);
    near(krippendorff_alpha(&missing), 0.743, 5e-4);
    near(krippendorff_alpha(&missing), 113.0 / 152.0, 1e-12);
}

/// The example of three coders and 15 units that encyclopedias give: 0.691 for nominal data.
#[test]
fn alpha_of_three_coders() {
    let units = raters(&[
        "* * * * * 3 4 1 2 1 1 3 3 * 3",
        "1 * 2 1 3 3 4 3 * * * * * * *",
        "* * 2 1 3 4 4 * 2 1 1 3 3 * 4",
    ]);
    near(krippendorff_alpha(&units), 0.691, 5e-4);
    near(krippendorff_alpha(&units), 56.0 / 81.0, 1e-12);
}

/// Gwet's package irrCAC, its overview: `cac.raw4raters`, `cont3x3abstractors`, `distrib.6raters`.
#[test]
fn ac1_of_gwets_examples() {
    let missing = raters(&FOUR_RATERS);
    near(raw(&missing), 0.8181818, 1e-7);
    near(gwet_ac1(&missing, 5), 0.77544, 5e-6);
    near(krippendorff_alpha(&missing), 0.74342, 5e-6);

    let table = [[13, 0, 0], [0, 20, 7], [0, 4, 56]];
    let mut abstractors = Vec::new();
    for (first, row) in (0..).zip(table) {
        for (second, count) in (0..).zip(row) {
            abstractors.extend(std::iter::repeat_n(Unit { cluster: 0, labels: vec![first, second] }, count));
        }
    }
    near(raw(&abstractors), 0.89, 1e-12);
    near(gwet_ac1(&abstractors, 3), 0.8493305, 1e-7);
    near(krippendorff_alpha(&abstractors), 0.7972585, 1e-7);

    let psychiatrists = counts(&[
        [0, 0, 0, 6, 0],
        [0, 3, 0, 0, 3],
        [0, 1, 4, 0, 1],
        [0, 0, 0, 0, 6],
        [0, 3, 0, 3, 0],
        [2, 0, 4, 0, 0],
        [0, 0, 4, 0, 2],
        [2, 0, 3, 1, 0],
        [2, 0, 0, 4, 0],
        [0, 0, 0, 0, 6],
        [1, 0, 0, 5, 0],
        [1, 1, 0, 4, 0],
        [0, 3, 3, 0, 0],
        [1, 0, 0, 5, 0],
        [0, 2, 0, 3, 1],
    ]);
    near(raw(&psychiatrists), 0.5511111, 1e-7);
    near(gwet_ac1(&psychiatrists, 5), 0.4448007, 1e-7);
    near(krippendorff_alpha(&psychiatrists), 0.4204384, 1e-7);
}

/// Five people, 90 items on which all are right and 10 on which one is wrong. Alpha: 500 answers, 10 of them wrong;
/// Do = 0.04, De = 2 * 490 * 10 / (500 * 499), so 1 - 0.04 * 249500 / 9800 = -9/490. AC1: pe = 2 * 0.98 * 0.02.
#[test]
fn lopsided_answers_are_where_alpha_and_ac1_part() {
    let mut units = counts(&[[0, 5]; 90]);
    units.extend(counts(&[[1, 4]; 10]));
    near(raw(&units), 0.96, 1e-12);
    near(krippendorff_alpha(&units), -9.0 / 490.0, 1e-12);
    near(gwet_ac1(&units, 2), (0.96 - 0.0392) / (1.0 - 0.0392), 1e-12);
}

#[test]
fn what_cannot_be_measured_says_why() {
    let same = counts(&[[5, 0]; 7]);
    assert_eq!(raw(&same), Ok(1.0));
    assert_eq!(krippendorff_alpha(&same), Err(Undefined::NoVariation));
    assert_eq!(gwet_ac1(&same, 1), Err(Undefined::NoVariation));
    assert_eq!(gwet_ac1(&same, 2), Ok(1.0));
    let lonely = counts(&[[1, 0], [0, 1], [0, 0]]);
    for value in [raw(&lonely), krippendorff_alpha(&lonely), gwet_ac1(&lonely, 2)] {
        assert_eq!(value, Err(Undefined::NoPairs));
    }
    for value in [raw(&[]), krippendorff_alpha(&[]), gwet_ac1(&[], 2)] {
        assert_eq!(value, Err(Undefined::NoVotes));
    }
}

/// Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
#[test]
fn wilsons_interval_is_the_published_one() {
    for (count, of, low, high) in
        [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)]
    {
        let interval = wilson(count, of).unwrap();
        assert!(
            (interval[0] - low).abs() < 5e-5 && (interval[1] - high).abs() < 5e-5,
            "{count}/{of}: {interval:?}"
        );
    }
    assert_eq!(wilson(0, 0), None);
    assert_eq!(wilson(7, 7).unwrap()[1], 1.0);
}

/// `python3` runs the second implementation; the test fails where there is none.
fn python(question: &Value) -> Value {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/agreement.py");
    let mut child = Command::new("python3")
        .args(["-I", script])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 is needed to check the statistics a second time");
    child.stdin.take().unwrap().write_all(question.to_string().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn python_computes_the_same_numbers() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut cases = Vec::new();
    for case in 0..200 {
        let (items, raters, labels) =
            (random.random_range(1..20), random.random_range(1..7), random.random_range(1..6_u32));
        // From nearly constant to nearly uniform, from complete to mostly missing.
        let (lopsided, missing) = (f64::from(case % 5) / 4.2, f64::from(case % 7) / 8.0);
        let answer = |random: &mut ChaCha8Rng| {
            let label = if random.random_bool(lopsided) { 0 } else { random.random_range(0..labels) };
            (!random.random_bool(missing)).then_some(label)
        };
        let units: Vec<Vec<Option<u32>>> =
            (0..items).map(|_| (0..raters).map(|_| answer(&mut random)).collect()).collect();
        cases.push((units, labels as usize));
    }
    let question: Vec<Value> =
        cases.iter().map(|(units, labels)| json!({ "units": units, "labels": labels })).collect();
    let said = python(&json!({ "cases": question, "bootstrap": null }));
    let mut defined = [0; 3];
    for ((units, labels), said) in cases.iter().zip(said["cases"].as_array().unwrap()) {
        let unit =
            |unit: &Vec<Option<u32>>| Unit { cluster: 0, labels: unit.iter().flatten().copied().collect() };
        let units: Vec<Unit> = units.iter().map(unit).collect();
        let ours = [raw(&units), krippendorff_alpha(&units), gwet_ac1(&units, *labels)];
        for (which, (ours, name)) in ours.into_iter().zip(["raw", "alpha", "ac1"]).enumerate() {
            match said[name].as_f64() {
                Some(theirs) => near(ours, theirs, 1e-12),
                None => assert!(ours.is_err(), "{name} of {units:?} is {ours:?}"),
            }
            defined[which] += usize::from(ours.is_ok());
        }
    }
    assert!(
        defined.iter().all(|&count| (100..200).contains(&count)),
        "{defined:?} of 200 cases have a value"
    );
}

/// 210 queries over 21 scenes, some of which are harder, and a bootstrap with other draws.
#[test]
fn python_draws_the_same_intervals() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut said = |scene: usize| {
        let ease = if scene % 10 == 3 { 0.8 } else { 0.97 };
        let is_right = random.random_bool(ease);
        let choice = objects(if is_right { &["cat_a"] } else { &["cat_b"] });
        Response { answer: Some(whole(choice)), ..Response::default() }
    };
    let cat = meaning(&["cat_a"], Temporal::Whole, Interval::WHOLE);
    let queries: Vec<_> =
        (0..210).map(|index| (cat.clone(), (0..5).map(|_| said(index % 21)).collect::<Vec<_>>())).collect();
    let (round, key, given) = poll_in(21, &["ada", "ben", "cho", "dee", "eve"], &queries);
    let ceiling = measure(&round, &key, &given).overall.ceiling;
    let right = whole(objects(&["cat_a"]));
    let units: Vec<_> = round
        .items
        .iter()
        .map(|item| {
            let rights = given.iter().filter(|given| given.answer(&item.id) == Some(&right)).count();
            json!([item.scene, rights, given.len()])
        })
        .collect();
    let said = python(&json!({ "cases": [], "bootstrap": { "units": units, "draws": 4000 } }));
    let [low, high] = ceiling.interval.unwrap();
    for (ours, theirs) in [low, high].into_iter().zip(said["bootstrap"].as_array().unwrap()) {
        let theirs = theirs.as_f64().unwrap();
        assert!(
            (ours - theirs).abs() < 0.15 * (high - low),
            "{ours} is far from {theirs} in [{low}, {high}]"
        );
    }
    // Scenes differ, so an interval over single answers would be too narrow.
    let alone = wilson((ceiling.value.unwrap() * 1050.0).round() as usize, 1050).unwrap();
    assert!(high - low > 1.5 * (alone[1] - alone[0]), "[{low}, {high}] against {alone:?}");
}
