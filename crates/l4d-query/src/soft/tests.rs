//! The two readings against each other, and what a degree may and may not do.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, Name, Profile, Report, Temporal};

use super::read::Soft;
use super::{Belief, BelievedEvent, Degrees, Meant, Noise, Thing, rank};
use crate::ast::Predicate;
use crate::eval::{clause_times, truth};
use crate::fixture::{cup, event, moving, pair, standing, tracks};
use crate::prove::SceneSet;
use crate::reading::Truth as _;
use crate::times::Times;
use crate::world::World;

fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

/// Three cups of which a hand lifts one, then another; the third is on a box.
fn scene() -> Tracks {
    let path: Vec<[f64; 3]> = (0..97).map(|frame| [f64::from(frame) / 96.0, 0.5, 0.0]).collect();
    let instances = [
        standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
        standing(2, "b", "cup", [1., 0., 0.], [0.12; 3]),
        moving(3, "c", "cup", &path, [0.15; 3]),
        standing(1001, "box_1", "box", [1., 0., -0.1], [0.2, 0.2, 0.1]),
        standing(1002, "left_hand", "hand", [0., 0.5, 0.], [0.1; 3]),
    ];
    let events = [
        event("left_hand", "lift", Some("a"), [10, 30]),
        event("left_hand", "lift", Some("b"), [50, 70]),
        event("c", "slide", None, [0, 96]),
    ];
    tracks(&instances, &events.join(","), &pair("b", "box_1", &[0.0]))
}

fn first(belief: &Belief<'_>, clauses: &str) -> String {
    rank(belief, &cup(clauses), Temporal::Whole)[0].name.to_string()
}

const CLAUSES: [&str; 12] = [
    r#"{"attribute":{"key":"colour","value":"grey"}}"#,
    r#"{"does":{"verb":"slide"}}"#,
    r#"{"undergoes":{"verb":"lift","by":{"category":"hand"}}}"#,
    r#"{"first":{"undergoes":{"verb":"lift","by":{"name":"left_hand"}}}}"#,
    r#"{"last":{"undergoes":{"verb":"lift","by":{"such":[{"category":"hand"},{"does":{"verb":"lift"}}]}}}}"#,
    r#"{"relation":{"kind":"on","of":[{"name":"box_1"}]}}"#,
    r#"{"not":{"relation":{"kind":"beside","of":[{"category":"hand"}]}}}"#,
    r#"{"relation":{"kind":"between","of":[{"name":"box_1"},{"name":"left_hand"}]}}"#,
    r#"{"at_start":{"relation":{"kind":"closest_to","of":[{"name":"left_hand"}]}}}"#,
    r#"{"at_end":{"relation":{"kind":"in_front_of","of":[{"name":"box_1"}]}}}"#,
    r#"{"superlative":"largest"}"#,
    r#"{"then":[{"undergoes":{"verb":"lift","by":{"category":"hand"}}},{"does":{"verb":"slide"}}]}"#,
];

/// At every frame, of every object and for every clause of every query.
#[test]
fn with_perfect_tracks_both_readings_agree() {
    for set in ["../../benchmark", "../../benchmark/dev"] {
        let bench = Benchmark::open(Path::new(env!("CARGO_MANIFEST_DIR")).join(set)).unwrap();
        let mut asked = 0;
        for scene in bench.select(&[]).unwrap() {
            let set = SceneSet::read(&bench, Profile::Small, &scene, &mut Report::default()).unwrap();
            let belief = Belief::certain(&set.tracks).unwrap();
            let (hard, soft) = (World::new(&set.tracks), Soft::new(&belief));
            for query in set.queries.iter().chain(&set.composites).chain(&set.absents) {
                let predicate = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
                for object in hard.objects().filter(|object| object.category == predicate.noun()) {
                    for clause in &predicate.0 {
                        let expected = clause_times(&hard, clause, object);
                        let degrees = truth(&soft, clause, object, predicate.noun());
                        assert_eq!(degrees.likely(), expected, "{}: {clause} of {}", query.id, object.name);
                    }
                }
                asked += 1;
            }
        }
        assert!(asked >= 200, "{asked} queries");
    }
}

#[test]
fn what_is_known_for_sure_decides() {
    let tracks = scene();
    let belief = Belief::certain(&tracks).unwrap();
    assert_eq!(first(&belief, CLAUSES[1]), "c");
    assert_eq!(first(&belief, CLAUSES[3]), "a");
    assert_eq!(first(&belief, CLAUSES[4]), "b");
    assert_eq!(first(&belief, CLAUSES[5]), "b");
    assert_eq!(first(&belief, CLAUSES[10]), "c");
    let lifted = rank(&belief, &cup(CLAUSES[3]), Temporal::Whole);
    assert!(lifted[0].confidence > 0.6, "{lifted:?}");
    let nobody = r#"{"undergoes":{"verb":"push","by":{"category":"hand"}}}"#;
    let absent = rank(&belief, &cup(nobody), Temporal::Whole);
    assert!(absent.len() == 3 && absent[0].confidence < 0.35, "{absent:?}");
}

fn doubtful(tracks: &Tracks) -> (Vec<Thing>, Vec<BelievedEvent>) {
    let belief = Belief::certain(tracks).unwrap();
    let mut things: Vec<Thing> = belief.things().cloned().collect();
    for thing in &mut things {
        thing.kinds.values_mut().for_each(|odds| *odds = 0.6);
    }
    let mut events = belief.events().to_vec();
    for event in &mut events {
        event.degree = Degrees::when(|frame| 0.7 * event.degree.at(frame));
    }
    (things, events)
}

#[test]
fn more_evidence_never_ranks_lower() {
    let tracks = scene();
    let (things, events) = doubtful(&tracks);
    let score = |things: &[Thing], events: &[BelievedEvent], clause: &str, who: &str| {
        let noise = Noise::perceived(tracks.scale);
        let belief = Belief::new(&tracks, things.to_vec(), events.to_vec(), noise).unwrap();
        let ranked = rank(&belief, &cup(clause), Temporal::Whole);
        ranked.iter().find(|one| one.name == name(who)).unwrap().score
    };
    let before = |clause: &str, who: &str| score(&things, &events, clause, who);
    for at in 0..things.len() {
        let mut surer = things.clone();
        surer[at].kinds.values_mut().for_each(|odds| *odds = 0.9);
        let who = surer[at].name.to_string();
        if surer[at].kinds.contains_key("cup") {
            let now = score(&surer, &events, CLAUSES[0], &who);
            assert!(now > before(CLAUSES[0], &who), "{who}");
        }
    }
    let mut surer = events.clone();
    surer[0].degree = Times::ALWAYS.into();
    let clause = CLAUSES[2];
    assert!(score(&things, &surer, clause, "a") >= before(clause, "a"));
    assert!(score(&things, &surer, clause, "b") <= before(clause, "b"));
}

#[test]
fn noise_makes_unsure() {
    let tracks = scene();
    let lead = |position_m: f64| {
        let certain = Belief::certain(&tracks).unwrap();
        let (things, events) = (certain.things().cloned().collect(), certain.events().to_vec());
        let noise = Noise { position_m, ..Noise::NONE };
        let belief = Belief::new(&tracks, things, events, noise).unwrap();
        let ranked = rank(&belief, &cup(CLAUSES[5]), Temporal::Whole);
        let second = ranked.iter().filter(|one| one.name != name("b")).map(|one| one.score);
        ranked.iter().find(|one| one.name == name("b")).unwrap().score - second.fold(0.0, f64::max)
    };
    let leads = [0.03, 0.3, 1.0, 3.0].map(lead);
    assert!(leads.is_sorted_by(|a, b| a > b) && leads[3] >= 0.0, "{leads:?}");
}

#[test]
fn nothing_known_is_still_a_guess_and_a_number() {
    let tracks = scene();
    let wild = Noise { position_m: 1e6, size: 1e6, angle_deg: 1e6, frames: 1e6 };
    for noise in [Noise::NONE, wild] {
        let belief = Belief::new(&tracks, Vec::new(), Vec::new(), noise).unwrap();
        let (things, events) = doubtful(&tracks);
        let doubted = Belief::new(&tracks, things, events, noise).unwrap();
        for clause in CLAUSES {
            for temporal in [Temporal::Whole, Temporal::While] {
                for (belief, count) in [(&belief, 3), (&doubted, 3)] {
                    let ranked = rank(belief, &cup(clause), temporal);
                    assert_eq!(ranked.len(), count, "{clause}");
                    for one in ranked {
                        let numbers = [one.score, one.confidence];
                        let all = numbers.iter().chain(one.when.values()).chain(&one.clauses);
                        assert!(all.clone().all(|value| (0.0..=1.0).contains(value)), "{clause}: {one:?}");
                        assert!(one.score > 0.0 && one.when.likely().any(), "{clause}: {one:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn what_is_no_number_is_refused_by_name() {
    let good = scene();
    let refuse = |tracks: &Tracks, things: Vec<Thing>, noise: Noise| {
        Belief::new(tracks, things, Vec::new(), noise).unwrap_err().to_string()
    };
    for poison in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut bad = good.clone();
        bad.instances[1].track.centre[0][2] = poison;
        assert!(refuse(&bad, Vec::new(), Noise::NONE).contains("`b`"));
        let mut bad = good.clone();
        bad.pairs[0].distance_m[0] = poison;
        assert!(refuse(&bad, Vec::new(), Noise::NONE).contains("pair"));
        let noise = Noise { position_m: poison, ..Noise::NONE };
        assert!(refuse(&good, Vec::new(), noise).contains("noise"));
        let (mut things, _) = doubtful(&good);
        things[0].kinds.insert("cup".into(), poison);
        assert!(refuse(&good, things, Noise::NONE).contains("`a`"));
        assert!(Degrees::new(&[poison]).is_err());
    }
    let mut bad = good.clone();
    bad.instances[0].track.extents.clear();
    assert!(refuse(&bad, Vec::new(), Noise::NONE).contains("`a`"));
    assert!(Degrees::new(&[0.5; 3]).is_err() && Degrees::new(&[1.5]).is_err());
    let (mut things, _) = doubtful(&good);
    things[0].name = name("nobody");
    assert!(refuse(&good, things, Noise::NONE).contains("nobody"));
}

#[test]
fn names_are_looked_up_or_read() {
    let tracks = scene();
    let certain = Belief::certain(&tracks).unwrap();
    let (things, events): (Vec<Thing>, _) = (certain.things().cloned().collect(), certain.events().to_vec());
    let belief = Belief::new(&tracks, things.clone(), events.clone(), Noise::NONE).unwrap();
    let on = |landmark: &str| format!(r#"{{"relation":{{"kind":"on","of":[{{"name":"{landmark}"}}]}}}}"#);
    let clear = |belief: &Belief<'_>, landmark: &str| {
        let ranked = rank(belief, &cup(&on(landmark)), Temporal::Whole);
        (ranked[0].name.to_string(), ranked[0].clauses[0])
    };
    // Names of another scene: `box_7` is the box, `crate` is nothing that is seen unless it is described.
    assert_eq!(clear(&belief, "box_7"), ("b".into(), 1.0));
    assert_eq!(clear(&belief, "big_box"), ("b".into(), 1.0));
    assert_eq!(clear(&belief, "crate").1, 0.0);
    let such = serde_json::from_str(r#"[{"category":"box"}]"#).unwrap();
    let named = belief.with_names(BTreeMap::from([(name("crate"), Meant::Such(such))]));
    assert_eq!(clear(&named, "crate"), ("b".into(), 1.0));
}

#[test]
fn a_person_is_a_woman_where_nobody_is_called_a_person() {
    let instances = ["woman", "man", "cup"].iter().zip(1..).map(|(kind, id)| {
        standing(id, &format!("t{id}"), kind, [f64::from(id), 0., 0.], [0.5, 0.5, 1.0 + f64::from(id)])
    });
    let tracks = tracks(&instances.collect::<Vec<_>>(), "", "");
    let mut belief = Belief::certain(&tracks).unwrap();
    let tallest = |belief: &Belief<'_>, noun: &str| -> Vec<String> {
        let text = format!(r#"[{{"category":"{noun}"}},{{"superlative":"tallest"}}]"#);
        let predicate = Predicate::from_json(&serde_json::from_str(&text).unwrap()).unwrap();
        rank(belief, &predicate, Temporal::Whole).iter().map(|one| one.name.to_string()).collect()
    };
    assert_eq!(tallest(&belief, "person"), ["t2", "t1"]);
    assert_eq!(tallest(&belief, "woman"), ["t1"]);
    belief.things.get_mut("t1").unwrap().kinds = BTreeMap::from([("person".into(), 1.0)]);
    assert_eq!(tallest(&belief, "person"), ["t1"]);
    // "woman" is no noun of this perceiver: whom it calls a person may be one.
    assert_eq!(tallest(&belief, "woman"), ["t1"]);
}

#[test]
fn boxes_tell_who_lifts_what_and_when() {
    // A hand goes down to the cup, raises it and takes it along; the other cup stays.
    let height = |frame: u32| (f64::from(frame.clamp(30, 60)) - 30.0) / 100.0;
    let cup_path: Vec<[f64; 3]> = (0..97).map(|frame| [0.0, 0.0, height(frame)]).collect();
    let hand_path: Vec<[f64; 3]> = cup_path.iter().map(|at| [0.11, 0.0, at[2]]).collect();
    let instances = [
        moving(1, "a", "cup", &cup_path, [0.1; 3]),
        standing(2, "b", "cup", [1., 0., 0.], [0.1; 3]),
        moving(1001, "hand", "hand", &hand_path, [0.1; 3]),
    ];
    let mut tracks = tracks(&instances, "", "");
    tracks.pair_reach_m = 0.0;
    let lifted = cup(CLAUSES[2]);
    let things = Belief::certain(&tracks).unwrap().things().cloned().collect();
    let events = super::derive::events(&tracks, &lifted);
    let belief = Belief::new(&tracks, things, events, Noise::NONE).unwrap();
    let ranked = rank(&belief, &lifted, Temporal::While);
    assert_eq!(ranked[0].name, name("a"));
    let when = ranked[0].when.likely();
    let (first, last) = (when.first().unwrap(), when.last().unwrap());
    assert!((26..=34).contains(&first) && (56..=64).contains(&last), "{first} to {last}");
    assert!(super::derive::events(&tracks, &cup(CLAUSES[0])).is_empty());
}
