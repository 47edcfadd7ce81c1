use l4d_data::Benchmark;
use serde_json::{Value, json};

use super::*;
use crate::scenarios::spec::tests::bakery;

fn known() -> Known {
    let verbs = ["lift", "carry", "roll", "sit", "walk"].map(str::to_owned);
    Known { scenes: BTreeSet::from(["room_gym".to_owned()]), verbs: verbs.into() }
}

fn codes(item: &Value) -> Vec<&'static str> {
    let reasons = problems(&Draft::read(item).unwrap(), &known());
    assert!(reasons.iter().all(|reason| !reason.message.is_empty() && !reason.hint.is_empty()));
    reasons.iter().map(|reason| reason.code).collect()
}

/// Codes after a change of the bakery.
fn with(edits: &[(&str, Value)]) -> Vec<&'static str> {
    let mut item = bakery();
    for (pointer, value) in edits {
        match item.pointer_mut(pointer) {
            Some(place) => *place = value.clone(),
            None => panic!("{pointer}"),
        }
    }
    codes(&item)
}

fn loaves(features: &[[&str; 2]]) -> Value {
    let names = ["loaf_carried", "loaf_on_board", "loaf_rolling", "loaf_sliced", "loaf_burnt", "loaf_sold"];
    let member = |(name, [crust, shape]): (&str, &[&str; 2])| json!({ "name": name, "features": { "crust": crust, "shape": shape } });
    names.into_iter().zip(features).map(member).collect()
}

#[test]
fn the_example_of_the_instructions_keeps_every_rule() {
    assert_eq!(codes(&bakery()), Vec::<&str>::new());
}

#[test]
fn names_explain_themselves() {
    let scenes = [
        "room_gym",
        "bakery",
        "tabletop_bakery",
        "room_Bakery",
        "room_bakery_2",
        "../room_bakery",
        "room_scene",
    ];
    each_breaks("L4D572", &scenes.map(|name| ("/name", json!(name))));
    let things = ["loaf", "loaf_a", "loaf_1", "object_left_alone", "loaf carried", "a/../b"];
    each_breaks("L4D572", &things.map(|name| ("/groups/0/members/1/name", json!(name))));
    each_breaks("L4D572", &[("/landmarks/0/name", json!("loaf_rolling"))]);
}

#[test]
fn look_alikes_share_features() {
    let group = |features: &[[&str; 2]]| with(&[("/groups/0/members", loaves(features))]);
    // a and b are dark, a and c are round: crossed. The fourth makes the array complete.
    let (a, b, c, d) = (["dark", "round"], ["dark", "long"], ["pale", "round"], ["pale", "long"]);
    assert_eq!(group(&[a, b, c, d]), Vec::<&str>::new());
    assert_eq!(group(&[a, b, ["pale", "square"]]), ["L4D573"], "every loaf has its own shape");
    assert_eq!(
        group(&[a, b, ["dark", "round"]]),
        ["L4D573", "L4D575"],
        "all are dark, and the query means a twin"
    );
    assert_eq!(
        group(&[["dark", "round"], ["dark", "round"], ["pale", "long"]]),
        ["L4D575"],
        "twins need not cross"
    );
    assert_eq!(group(&[a, b, c, d, a, b]), ["L4D573", "L4D573", "L4D575"], "six are too many");
    // Without the third the queries and events lose their loaf.
    assert!(group(&[a, b]).contains(&"L4D573"), "no group of three");
    let same_split = [["dark", "round"], ["dark", "round"], ["pale", "long"], ["pale", "long"]];
    assert_eq!(group(&same_split), ["L4D575"]);
    let mut lacking = loaves(&[a, b, c]);
    lacking[1]["features"] = json!({ "crust": "dark" });
    assert_eq!(with(&[("/groups/0/members", lacking)]), ["L4D573"]);
    assert_eq!(with(&[("/landmarks/0/category", json!("loaf"))]), ["L4D573"]);
    assert_eq!(with(&[("/groups/0/category", json!("Loaf of bread 1"))]), ["L4D573"]);
}

#[test]
fn features_that_go_together_do_not_cross() {
    // Four of two kinds, told apart by a third feature that each value shares: no twins, but two equal splits.
    let mut members = loaves(&[["dark", "round"], ["dark", "round"], ["pale", "long"], ["pale", "long"]]);
    for (index, size) in ["small", "large", "small", "large"].into_iter().enumerate() {
        members[index]["features"]["size"] = json!(size);
    }
    assert_eq!(with(&[("/groups/0/members", members.clone())]), Vec::<&str>::new(), "size crosses both");
    for index in 0..4 {
        members[index]["features"]["size"] = json!(["small", "small", "large", "large"][index]);
    }
    assert_eq!(
        with(&[("/groups/0/members", members)]),
        ["L4D575"],
        "now they are twins, and the query means one"
    );
}

/// Asserts that each change alone breaks one rule of this code.
fn each_breaks(code: &str, cases: &[(&str, Value)]) {
    for (pointer, value) in cases {
        assert_eq!(with(&[(pointer, value.clone())]), [code], "{pointer} {value}");
    }
}

#[test]
fn events_are_possible() {
    each_breaks(
        "L4D574",
        &[
            ("/events/0/verb", json!("teleport")),
            ("/events/0/subject", json!("nobody")),
            ("/events/0/object", json!("loaf_of_yesterday")),
            ("/events/0/object", json!("baker_hand")),
            ("/events/2/frames", json!([40, 51])),
            ("/events/2/frames", json!([80, 97])),
            ("/events/2/loop_hz", json!(3.5)),
            ("/events/2/loop_hz", json!(-1)),
        ],
    );
    let least = [("/events/2/loop_hz", json!(3.0)), ("/events/2/frames", json!([40, 52]))];
    assert_eq!(with(&least), Vec::<&str>::new());
    let whole = [("/events/0/frames", json!([0, 96])), ("/events/2/frames", json!([0, 96]))];
    assert_eq!(with(&whole), ["L4D574"], "no time");
    let mut twice = bakery();
    let event = twice["events"][2].clone();
    twice["events"].as_array_mut().unwrap().push(event);
    assert_eq!(codes(&twice), ["L4D574"]);
    twice["events"][3]["verb"] = json!("sit");
    assert_eq!(codes(&twice), ["L4D574"], "rolls and sits at once");
    twice["events"][3]["frames"] = json!([76, 96]);
    assert_eq!(codes(&twice), Vec::<&str>::new());
}

#[test]
fn sketches_are_worth_asking() {
    each_breaks(
        "L4D575",
        &[
            ("/queries/0/category", json!("spatial")),
            ("/queries/0/referent", json!("shelf")),
            ("/queries/0/text", json!("Loaf")),
            ("/queries/0/text", json!("The loaf to the left of the shelf")),
            ("/queries/0/text", json!("The loaf that rolls")),
            ("/queries/3/text", json!("The loaf that a hand carries")),
        ],
    );
    let only_hands =
        with(&[("/events/2/subject", json!("baker_hand")), ("/events/2/object", json!("shelf"))]);
    assert_eq!(only_hands, ["L4D575"], "an action, but no loaf acts");
}

#[test]
fn texts_are_bounded() {
    let long = json!("y".repeat(601));
    each_breaks(
        "L4D571",
        &[("/story", json!("")), ("/story", long), ("/environment/light", json!("sun\u{1b}[2J"))],
    );
}

#[test]
fn the_benchmark_lends_its_names_and_verbs() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark");
    let known = Known::of(&Benchmark::open(root).unwrap());
    assert!(known.scenes.contains("room_living_cats"));
    assert!(known.verbs.contains("hold"), "of the lexicon");
    assert!(known.verbs.contains("wave"), "of a scene");
}
