//! The numbers of a round by hand, published worked examples, and a second implementation in Python.

use std::io::Write as _;
use std::process::{Command, Stdio};

use l4d_data::{Interval, Temporal};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use super::coefficients::{NO_PAIRS, NO_VARIATION, Undefined};
use super::*;
use crate::fixture::{meaning, objects, poll, poll_in, response, whole};
use crate::vote::Response;

const FIVE: [&str; 5] = ["ada", "ben", "cho", "dee", "eve"];

fn with_seed(seed: u64, queries: &[&str]) -> Agreement {
    let tabby = || meaning(&["tabby"], Temporal::Whole, Interval::WHOLE);
    let queries: Vec<_> =
        queries.iter().map(|letters| (tabby(), letters.chars().map(response).collect())).collect();
    let (mut round, key, given) = poll(&FIVE, &queries);
    round.settings.seed = seed;
    measure(&round, &key, &given)
}

fn measured(queries: &[&str]) -> Agreement {
    with_seed(7, queries)
}

#[track_caller]
fn near(value: Result<f64, Undefined>, expected: f64, tolerance: f64) {
    let value = value.unwrap();
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected}");
}

#[track_caller]
fn is(estimate: &Estimate, expected: f64) {
    near(estimate.value.ok_or("undefined"), expected, 1e-12);
}

#[test]
fn a_hundred_items_ninety_unanimous_and_ten_at_four_to_one() {
    let queries = [vec!["+++++"; 90], vec!["++++x"; 10]].concat();
    let overall = measured(&queries).overall;
    assert_eq!((overall.items, overall.complete, overall.answers), (100, 100, 500));
    is(&overall.right.raw, 0.96);
    is(&overall.right.alpha, -9.0 / 490.0);
    is(&overall.right.ac1, (0.96 - 0.0392) / (1.0 - 0.0392));
    is(&overall.ceiling, 0.98);
    assert_eq!(overall.histogram, [0, 0, 0, 0, 10, 90]);
    is(&overall.understood, 0.9);
    for estimate in [&overall.right.raw, &overall.right.ac1, &overall.ceiling, &overall.understood] {
        let ([low, high], value) = (estimate.interval.unwrap(), estimate.value.unwrap());
        assert!(low < value && value < high, "{estimate}");
    }
}

/// Two items, five answers each. Item 1: + + + x y, 3 of 10 pairs agree; item 2: all say none, 10 of 10.
#[test]
fn choice_asks_what_was_said_and_right_whether_it_is_right() {
    let overall = measured(&["+++xX", "00000"]).overall;
    is(&overall.choice.raw, (0.3 + 1.0) / 2.0);
    // Right: item 1 has 3 against 2, 4 of 10 pairs agree; item 2 is wrong five times.
    is(&overall.right.raw, (0.4 + 1.0) / 2.0);
    // Choice: labels tabby 3, ginger 1, both 1, none 5; Do = 1 - (6/4 + 20/4)/10, De = 1 - (6 + 20)/90.
    is(&overall.choice.alpha, 1.0 - (1.0 - 6.5 / 10.0) / (1.0 - 26.0 / 90.0));
    // pi 0.3, 0.1, 0.1, 0.5 and q = 4.
    let chance = (0.21 + 0.09 + 0.09 + 0.25) / 3.0;
    is(&overall.choice.ac1, (0.65 - chance) / (1.0 - chance));
    assert_eq!((overall.choice.labels, overall.right.labels), (4, 2));
    is(&overall.unanimous, 0.5);
    is(&overall.understood, 0.0);
    is(&overall.ceiling, 0.3);
}

#[test]
fn the_same_name_in_two_scenes_is_two_labels_and_none_is_one() {
    assert_eq!(measured(&["+++++", "+++++"]).overall.choice.labels, 2);
    assert_eq!(measured(&["00000", "00000"]).overall.choice.labels, 1);
    assert_eq!(measured(&["?????", "?????"]).overall.choice.labels, 1);
}

#[test]
fn what_has_no_value_or_no_interval_says_why() {
    let why = |estimate: Estimate| (estimate.value, estimate.undefined.unwrap());
    let right = |queries: &[&str]| measured(queries).overall.right;
    assert_eq!(why(right(&["+++++"; 3]).alpha), (None, NO_VARIATION.to_owned()));
    is(&right(&["+++++"; 3]).ac1, 1.0);
    assert_eq!(right(&["+++++"; 3]).raw.interval, Some([1.0, 1.0]));
    assert_eq!(why(measured(&["00000"]).overall.choice.ac1), (None, NO_VARIATION.to_owned()));
    assert_eq!(why(right(&["+....", "..x.."]).raw), (None, NO_PAIRS.to_owned()));
    let unanswered = measured(&["....s"]).overall;
    for estimate in [unanswered.right.ac1, unanswered.ceiling, unanswered.unanimous] {
        assert_eq!(
            (estimate.to_string().as_str(), why(estimate)),
            ("undefined", (None, NO_VOTES.to_owned()))
        );
    }
    assert_eq!(why(right(&["++++x"]).raw), (Some(0.6), "one scene has no spread".to_owned()));
    // Only one of ten scenes varies: a draw misses it with probability 0.9^10, a third of the time.
    let (value, reason) = why(right(&[vec!["+++++"; 9], vec!["++++x"]].concat()).alpha);
    assert!(value.is_some() && reason.ends_with("of 1000 draws"), "{value:?} {reason}");
}

#[test]
fn missing_answers_and_skips_leave_the_rest() {
    let agreement = measured(&["++s.+", "+++++"]);
    let overall = &agreement.overall;
    assert_eq!((overall.items, overall.complete, overall.answers), (2, 1, 8));
    assert_eq!(overall.histogram, [0, 0, 0, 0, 0, 1]);
    is(&overall.right.raw, 1.0);
    let counts = |annotator: &Annotator| (annotator.answered, annotator.skipped, annotator.right);
    let counts: Vec<_> = agreement.annotators.iter().map(counts).collect();
    assert_eq!(counts, [(2, 0, 2), (2, 0, 2), (1, 1, 1), (1, 0, 1), (2, 0, 2)]);
}

#[test]
fn categories_are_measured_apart() {
    let agreement = measured(&["+++++", "xxxxx", "+++++", "+++++", "++++x"]);
    let right: Vec<_> = agreement.categories.values().map(|group| group.ceiling.value.unwrap()).collect();
    assert_eq!(agreement.categories.keys().copied().collect::<Vec<_>>(), Category::ALL);
    assert_eq!(right, [0.9, 0.0, 1.0, 1.0]);
}

#[test]
fn the_file_is_the_same_every_time_and_null_where_undefined() {
    let queries = ["++++x", "+++xx", "+++++", "xxxxx", "+x+x0", "+0000", "??+++", "++++0", "++++?"];
    let file = |seed| serde_json::to_value(with_seed(seed, &queries)).unwrap();
    assert_eq!(file(1), file(1));
    let ceiling = |seed| file(seed)["overall"]["ceiling"].clone();
    assert!(ceiling(1) != ceiling(2) && ceiling(1)["value"] == ceiling(2)["value"]);
    let same = &file(1)["categories"]["interaction"]["right"]["ac1"];
    assert!(same["value"].is_number() && same.get("undefined").is_none(), "{same}");
    let alone = serde_json::to_string(&measured(&["+++++"]).overall.right.alpha).unwrap();
    assert_eq!(alone, r#"{"value":null,"interval":null,"undefined":"no variation"}"#);
}

/// Of Krippendorff (2011), section C, and of Gwet's irrCAC, `cac.raw4raters`.
const FOUR_RATERS: [&str; 4] = [
    "1 2 3 3 2 1 4 1 2 * * *",
    "1 2 3 3 2 2 4 1 2 5 * 3",
    "* 3 3 3 2 3 4 2 2 5 1 *",
    "1 2 3 3 2 4 4 1 2 5 1 *",
];

/// One row per rater, one column per item, `*` where an answer is missing.
fn raters(rows: &[&str]) -> Vec<Vec<u32>> {
    let rows: Vec<Vec<&str>> = rows.iter().map(|row| row.split_whitespace().collect()).collect();
    let code = |label: &str| u32::from(label.as_bytes()[0]);
    let column = |item: usize| rows.iter().map(move |row| row[item]).filter(|label| *label != "*").map(code);
    (0..rows[0].len()).map(|item| column(item).collect()).collect()
}

/// One row per item: how many raters chose each label.
fn counts<const LABELS: usize>(rows: &[[usize; LABELS]]) -> Vec<Vec<u32>> {
    let item = |row: &[usize; LABELS]| {
        row.iter().zip(0..).flat_map(|(&count, label)| std::iter::repeat_n(label, count)).collect()
    };
    rows.iter().map(item).collect()
}

/// Raw agreement, alpha, and AC1 with so many labels.
fn all_of(items: &[Vec<u32>], labels: usize) -> [Result<f64, Undefined>; 3] {
    let items: Vec<&[u32]> = items.iter().map(Vec::as_slice).collect();
    [raw(&items), alpha(&items), ac1(&items, labels)]
}

/// Krippendorff, Computing Krippendorff's Alpha-Reliability (2011), sections A, B and C, and the example of three coders
/// and 15 units that encyclopedias give.
#[test]
fn alpha_of_krippendorffs_examples() {
    let three_coders =
        ["* * * * * 3 4 1 2 1 1 3 3 * 3", "1 * 2 1 3 3 4 3 * * * * * * *", "* * 2 1 3 4 4 * 2 1 1 3 3 * 4"];
    for (rows, published, exact) in [
        (&["0 1 0 0 0 0 0 0 1 0", "1 1 1 0 0 1 0 0 0 0"][..], 0.095, 2.0 / 21.0),
        (&["a a b b d c c c e d d a", "b a b b b c c c e d d d"], 0.692, 155.0 / 224.0),
        (&FOUR_RATERS, 0.743, 113.0 / 152.0),
        (&three_coders, 0.691, 56.0 / 81.0),
    ] {
        let [_, alpha, _] = all_of(&raters(rows), 5);
        near(alpha, published, 5e-4);
        near(alpha, exact, 1e-12);
    }
}

/// Gwet's package irrCAC, its overview: `cac.raw4raters`, `cont3x3abstractors`, `distrib.6raters`.
#[test]
fn ac1_of_gwets_examples() {
    let table = [[13, 0, 0], [0, 20, 7], [0, 4, 56]];
    let mut abstractors = Vec::new();
    for (first, row) in (0..).zip(table) {
        for (second, count) in (0..).zip(row) {
            abstractors.extend(std::iter::repeat_n(vec![first, second], count));
        }
    }
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
    for (items, labels, expected) in [
        (raters(&FOUR_RATERS), 5, [0.8181818, 0.74342, 0.77544]),
        (abstractors, 3, [0.89, 0.7972585, 0.8493305]),
        (psychiatrists, 5, [0.5511111, 0.4204384, 0.4448007]),
    ] {
        for (value, expected) in all_of(&items, labels).into_iter().zip(expected) {
            near(value, expected, 5e-6);
        }
    }
}

#[test]
fn what_cannot_be_measured_says_why() {
    let same = counts(&[[5, 0]; 7]);
    assert_eq!(all_of(&same, 1), [Ok(1.0), Err(NO_VARIATION), Err(NO_VARIATION)]);
    assert_eq!(all_of(&same, 2), [Ok(1.0), Err(NO_VARIATION), Ok(1.0)]);
    assert_eq!(all_of(&counts(&[[1, 0], [0, 1], [0, 0]]), 2), [Err(NO_PAIRS); 3]);
    assert_eq!(all_of(&[], 2), [Err(NO_VOTES); 3]);
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
        let items: Vec<Vec<u32>> =
            units.iter().map(|unit| unit.iter().flatten().copied().collect()).collect();
        let ours = all_of(&items, *labels);
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
    let (round, key, given) = poll_in(21, &FIVE, &queries);
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
    // Scenes differ, so the normal interval over single answers would be too narrow.
    let value = ceiling.value.unwrap();
    let alone = 2.0 * 1.96 * (value * (1.0 - value) / 1050.0).sqrt();
    assert!(high - low > 1.5 * alone, "[{low}, {high}] against a width of {alone}");
}
