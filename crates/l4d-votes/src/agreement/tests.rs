use l4d_data::{Interval, Temporal};

use super::*;
use crate::fixture::{meaning, objects, poll, whole};
use crate::key::Meaning;
use crate::vote::Response;

const FIVE: [&str; 5] = ["ada", "ben", "cho", "dee", "eve"];

fn tabby() -> Meaning {
    meaning(&["tabby"], Temporal::Whole, Interval::WHOLE)
}

/// One letter per answer: `+` right, `x` and `y` other objects, `0` none, `?` ambiguous, `s` skipped, `.` missing.
fn answers(letters: &str) -> Vec<Response> {
    let response = |letter: char| {
        let choice = match letter {
            '+' => objects(&["tabby"]),
            'x' => objects(&["ginger"]),
            'y' => objects(&["ginger", "tabby"]),
            '0' => Choice::None,
            '?' => Choice::Ambiguous { reason: format!("{letters} of them") },
            's' => return Response { skipped: true, ..Response::default() },
            _ => return Response::default(),
        };
        Response { answer: Some(whole(choice)), ..Response::default() }
    };
    letters.chars().map(response).collect()
}

fn measured(queries: &[&str]) -> Agreement {
    let queries: Vec<_> = queries.iter().map(|letters| (tabby(), answers(letters))).collect();
    let (round, key, given) = poll(&FIVE, &queries);
    measure(&round, &key, &given)
}

#[track_caller]
fn near(value: Option<f64>, expected: f64) {
    assert!(value.is_some_and(|value| (value - expected).abs() < 1e-12), "{value:?} is not {expected}");
}

#[test]
fn a_hundred_items_ninety_unanimous_and_ten_at_four_to_one() {
    let queries = [vec!["+++++"; 90], vec!["++++x"; 10]].concat();
    let overall = measured(&queries).overall;
    assert_eq!((overall.items, overall.complete, overall.answers), (100, 100, 500));
    near(overall.right.raw.value, 0.96);
    near(overall.right.alpha.value, -9.0 / 490.0);
    near(overall.right.ac1.value, (0.96 - 0.0392) / (1.0 - 0.0392));
    near(overall.ceiling.value, 0.98);
    assert_eq!(overall.histogram, [0, 0, 0, 0, 10, 90]);
    assert_eq!((overall.understood.count, overall.understood.of), (90, 100));
    // 0.9 of 100: (0.9 + z^2/200 -+ z sqrt(0.09/100 + z^2/40000)) / (1 + z^2/100).
    let [low, high] = overall.understood.interval.unwrap();
    assert!((low - 0.8256).abs() < 1e-4 && (high - 0.9448).abs() < 1e-4, "[{low}, {high}]");
    for estimate in [&overall.right.raw, &overall.right.ac1, &overall.ceiling] {
        let ([low, high], value) = (estimate.interval.unwrap(), estimate.value.unwrap());
        assert!(low < value && value < high, "{estimate}");
    }
}

/// Two items, five answers each. Item 1: + + + x y, 3 of 10 pairs agree; item 2: all say none, 10 of 10.
#[test]
fn choice_asks_what_was_said_and_right_whether_it_is_right() {
    let overall = measured(&["+++xy", "00000"]).overall;
    near(overall.choice.raw.value, (0.3 + 1.0) / 2.0);
    // Right: item 1 has 3 against 2, 4 of 10 pairs agree; item 2 is wrong five times.
    near(overall.right.raw.value, (0.4 + 1.0) / 2.0);
    // Choice: labels tabby 3, ginger 1, both 1, none 5; Do = 1 - (6/4 + 20/4)/10, De = 1 - (6 + 20)/90.
    near(overall.choice.alpha.value, 1.0 - (1.0 - 6.5 / 10.0) / (1.0 - 26.0 / 90.0));
    // pi 0.3, 0.1, 0.1, 0.5 and q = 4.
    let chance = (0.21 + 0.09 + 0.09 + 0.25) / 3.0;
    near(overall.choice.ac1.value, (0.65 - chance) / (1.0 - chance));
    assert_eq!((overall.choice.labels, overall.right.labels), (4, 2));
    assert_eq!((overall.unanimous.count, overall.understood.count), (1, 0));
    near(overall.ceiling.value, 0.3);
}

#[test]
fn the_same_name_in_two_scenes_is_two_labels_and_none_is_one() {
    assert_eq!(measured(&["+++++", "+++++"]).overall.choice.labels, 2);
    assert_eq!(measured(&["00000", "00000"]).overall.choice.labels, 1);
    assert_eq!(measured(&["?????", "?????"]).overall.choice.labels, 1);
}

#[test]
fn what_is_undefined_says_so() {
    let overall = measured(&["+++++", "+++++", "+++++"]).overall;
    assert_eq!(overall.right.alpha.to_string(), "undefined (no variation)");
    near(overall.right.ac1.value, 1.0);
    assert_eq!(overall.right.raw.interval, Some([1.0, 1.0]));
    assert_eq!(measured(&["00000"]).overall.choice.ac1.to_string(), "undefined (no variation)");
    assert_eq!(
        measured(&["+....", "..x.."]).overall.right.raw.to_string(),
        "undefined (no item has two votes)"
    );
    let unanswered = measured(&["....s"]).overall;
    assert_eq!(unanswered.right.ac1.to_string(), "undefined (no votes)");
    assert_eq!(unanswered.ceiling.to_string(), "undefined (no votes)");
    assert_eq!((unanswered.unanimous.rate(), unanswered.unanimous.interval), (None, None));
}

#[test]
fn an_interval_needs_scenes_to_draw_from() {
    let one = measured(&["++++x"]).overall.right.raw;
    assert_eq!((one.value, one.interval), (Some(0.6), None));
    assert!(one.to_string().contains("one scene"), "{one}");
    // Only one of ten scenes varies: a draw misses it with probability 0.9^10, a third of the time.
    let rare = measured(&[vec!["+++++"; 9], vec!["++++x"]].concat()).overall.right.alpha;
    assert!(rare.value.is_some() && rare.interval.is_none(), "{rare}");
    assert!(rare.to_string().contains("of 1000 draws"), "{rare}");
}

#[test]
fn missing_answers_and_skips_leave_the_rest() {
    let agreement = measured(&["++s.+", "+++++"]);
    let overall = &agreement.overall;
    assert_eq!((overall.items, overall.complete, overall.answers), (2, 1, 8));
    assert_eq!(overall.histogram, [0, 0, 0, 0, 0, 1]);
    near(overall.right.raw.value, 1.0);
    let counts: Vec<_> = agreement
        .annotators
        .iter()
        .map(|annotator| (annotator.answered, annotator.skipped, annotator.right))
        .collect();
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
    let text = |seed: u64| {
        let queries = ["++++x", "+++xx", "+++++", "xxxxx", "+x+x0", "+0000", "??+++", "++++0", "++++?"];
        let queries: Vec<_> = queries.iter().map(|letters| (tabby(), answers(letters))).collect();
        let (mut round, key, given) = poll(&FIVE, &queries);
        round.settings.seed = seed;
        serde_json::to_value(measure(&round, &key, &given)).unwrap()
    };
    assert_eq!(text(1), text(1));
    assert_ne!(text(1)["overall"]["ceiling"], text(2)["overall"]["ceiling"]);
    assert_eq!(text(1)["overall"]["ceiling"]["value"], text(2)["overall"]["ceiling"]["value"]);
    let same = &text(1)["categories"]["interaction"]["right"]["ac1"];
    assert!(same["value"].is_number() && same.get("undefined").is_none(), "{same}");
    let alone = serde_json::to_value(measured(&["+++++"]).overall.right.alpha).unwrap();
    assert_eq!(alone.to_string(), r#"{"value":null,"interval":null,"undefined":"no variation"}"#);
}
