//! The whole round through the files: 400 prompts, five annotators, 1000 bootstrap draws.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use l4d_data::{Interval, Temporal};
use l4d_votes::agreement::{self, DRAWS};
use l4d_votes::verdict::{Outcome, judge};
use l4d_votes::{Ballot, Choice, Event, ItemId, RoundDir, Seen, sheet};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::json;

use crate::coefficients::python;
use crate::support::{self, Asked, meaning, name, objects, whole};

const ANNOTATORS: [&str; 5] = ["ada", "ben", "cho", "dee", "eve"];
const CATEGORIES: [&str; 4] = ["attribute", "action", "spatial", "interaction"];

/// Votes of `ANNOTATORS` on `count` prompts over 21 scenes; some scenes are harder than others.
fn voted(count: usize) -> (tempfile::TempDir, RoundDir) {
    let folder = support::folder();
    let dir = RoundDir::new(folder.path().join("r1"));
    let asked: Vec<Asked> = (0..count)
        .map(|index| Asked {
            scene: format!("scene_{:02}", index % 21),
            text: format!("The cat that does number {index}"),
            category: CATEGORIES[index / 21 % 4],
            meaning: meaning(&["cat_a"], Temporal::Whole, Interval::WHOLE),
        })
        .collect();
    support::write(&dir, &ANNOTATORS, "unanimous:5", "any", &asked);
    let (round, _) = support::open(&dir);
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for annotator in ANNOTATORS {
        let (mut ballot, _) = Ballot::open(&dir, &round, &name(annotator)).unwrap();
        for item in round.order(&name(annotator)) {
            let scene = round.item(&item).unwrap().scene.to_string();
            let ease = if scene.ends_with('3') { 0.8 } else { 0.97 };
            let choice = match random.random_range(0..10) {
                _ if random.random_bool(ease) => objects(&["cat_a"]),
                0 => Choice::None,
                1 => Choice::Ambiguous { reason: "two of them".to_owned() },
                _ => objects(&["cat_b"]),
            };
            let seen =
                Seen { views: [name("cam00"), name("cam03")].into(), frames: (0..97).step_by(2).collect() };
            ballot.record(&item, Event::Choose(whole(choice)), seen, Duration::from_millis(8000)).unwrap();
        }
        ballot.seal().unwrap();
    }
    (folder, dir)
}

#[test]
fn a_round_of_400_prompts_is_judged_within_a_second() {
    let (_folder, dir) = voted(400);
    let start = Instant::now();
    let (round, key) = support::open(&dir);
    let (sheets, notices) = sheet::read_all(&dir, &round).unwrap();
    let read = start.elapsed();
    let current: BTreeMap<ItemId, String> =
        round.items.iter().map(|item| (item.id.clone(), item.digest.clone())).collect();
    let verdicts = judge(&round, &key, &sheets, &current);
    let judged = start.elapsed();
    let agreement = agreement::measure(&round, &key, &sheets);
    let all = start.elapsed();
    println!(
        "read {read:?}, judged {:?}, measured with {DRAWS} draws {:?}; all {all:?}",
        judged - read,
        all - judged
    );

    assert_eq!((notices.len(), verdicts.items.len(), agreement.overall.answers), (0, 400, 2000));
    assert_eq!(verdicts.count(Outcome::Valid), agreement.overall.understood.count);
    if cfg!(not(debug_assertions)) {
        assert!(all < Duration::from_secs(1), "{all:?}");
    }
}

#[test]
fn python_draws_the_same_intervals() {
    let (_folder, dir) = voted(210);
    let (round, key) = support::open(&dir);
    let (sheets, _) = sheet::read_all(&dir, &round).unwrap();
    let ceiling = agreement::measure(&round, &key, &sheets).overall.ceiling;
    let right = whole(objects(&["cat_a"]));
    let units: Vec<_> = round
        .items
        .iter()
        .map(|item| {
            let rights = sheets.iter().filter(|sheet| sheet.answer(&item.id) == Some(&right)).count();
            json!([item.scene, rights, sheets.len()])
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
    let alone = agreement::wilson((ceiling.value.unwrap() * 1050.0).round() as usize, 1050).unwrap();
    assert!(high - low > 1.5 * (alone[1] - alone[0]), "[{low}, {high}] against {alone:?}");
}
