use std::path::PathBuf;

use l4d_data::query::Source;
use l4d_data::scene::Scene;
use l4d_data::tracks::{TrackedCamera, TrackedInstance, Tracks};
use l4d_data::truth::{self, InstanceTruth, Truth, frame_key};
use l4d_data::{Benchmark, Camera, Rle, Scale};
use serde_json::{Value, json};

use super::*;

/// A box of 10 cm at x metres.
fn instance(id: u32, name: &str, category: &str, colour: &str, x: f64) -> Value {
    json!({
        "id": id, "name": name, "role": if id > 1000 { "landmark" } else { "object" }, "category": category,
        "attributes": if colour.is_empty() { json!({}) } else { json!({ "colour": colour }) }, "front": null,
        "track": { "centre": [[x, 0.0, 0.05]], "axes": [[1, 0, 0, 0, 1, 0, 0, 0, 1]], "extents": [[0.1, 0.1, 0.1]] },
    })
}

/// One of five views, of which the middle one is held out.
fn camera(index: usize) -> Value {
    let pose = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
    json!({
        "name": format!("cam{index}"), "split": if index == 2 { "test" } else { "train" },
        "profiles": ["tiny", "small"], "focal_over_width": 1.0, "world_from_camera": [pose],
    })
}

/// A hand lifts the first of three cups, later the third one rolls; a bowl stands by.
pub(crate) fn kitchen() -> SceneSet {
    let tracks: Tracks = serde_json::from_value(json!({
        "schema": "l4d/tracks/1", "scene": "kitchen", "scale": "tabletop", "variant": 0, "seed": 0, "fps": 24,
        "frame_count": 97, "exposure": 1, "description": "", "pair_reach_m": 0.05, "pairs": [], "cameras": (0..5).map(camera).collect::<Vec<_>>(),
        "instances": [
            instance(1, "cup_lifted", "cup", "white", 0.25), instance(2, "cup_still", "cup", "white", -0.28),
            instance(3, "cup_rolling", "cup", "blue", 2.0), instance(4, "bowl", "bowl", "white", 3.0),
            instance(1001, "tray", "tray", "", 0.0), instance(1002, "hand", "hand", "", 0.5),
        ],
        "events": [
            { "subject": "cup_rolling", "verb": "roll", "object": null, "frames": [60, 90] },
            { "subject": "hand", "verb": "lift", "object": "cup_lifted", "frames": [20, 50] },
        ],
    }))
    .unwrap();
    let predicate = json!([{ "category": "cup" }, { "attribute": { "key": "colour", "value": "blue" } }]);
    let blue: Query = serde_json::from_value(json!({
        "id": "kitchen/001", "text": "The blue cup", "categories": ["attribute"], "referents": ["cup_rolling"],
        "temporal": "whole", "frames": [[0, 96]], "predicate": predicate,
        "text_digest": text_digest("The blue cup", Some(&predicate)), "provenance": { "source": "author" },
        "status": "candidate",
    }))
    .unwrap();
    SceneSet {
        scene: Name::new("kitchen").unwrap(),
        tracks,
        truth: None,
        queries: vec![blue],
        composites: Vec::new(),
        absents: Vec::new(),
        paths: ["tracks", "queries", "composites", "absents"].map(PathBuf::from),
    }
}

/// The rendering of a scene, as far as questions and gates ask about it.
pub(crate) fn rendering(tracks: &Tracks, profile: Profile) -> Scene {
    let camera = |found: &TrackedCamera| Camera {
        world_from_camera: found.world_from_camera.clone(),
        ..l4d_testing::camera(&found.name, found.split)
    };
    let cameras = tracks.views(profile).map(camera).collect();
    let instances = tracks.instances.iter().map(TrackedInstance::instance).collect();
    Scene {
        scale: tracks.scale,
        variant: tracks.variant,
        seed: tracks.seed,
        profile,
        stride: profile.stride(),
        width: profile.width(),
        height: profile.height(),
        ..l4d_testing::scene(&tracks.scene, cameras, instances)
    }
}

/// A truth in which the held-out view shows `pixels` pixels of `cup_lifted` in the frames given, and nothing else.
fn truth(profile: Profile, pixels: u32, seen: impl Fn(u32) -> bool) -> Truth {
    let frames: Vec<u32> = profile.frames().collect();
    let name = Name::new("cup_lifted").unwrap();
    let masks = frames
        .iter()
        .filter(|frame| seen(**frame))
        .map(|frame| (frame_key(*frame), Rle::empty(profile.width() * profile.height())))
        .collect();
    let counts: Vec<u32> = frames.iter().map(|frame| if seen(*frame) { pixels } else { 0 }).collect();
    let visible = (0..5).map(|index| {
        (Name::new(format!("cam{index}")).unwrap(), BTreeMap::from([(name.clone(), counts.clone())]))
    });
    let visible = visible.collect();
    Truth {
        unannotated: Vec::new(),
        schema: truth::SCHEMA.to_owned(),
        scene: Name::new("kitchen").unwrap(),
        scale: Scale::Tabletop,
        variant: 0,
        profile,
        width: profile.width(),
        height: profile.height(),
        test_view: Name::new("cam2").unwrap(),
        frames,
        instances: vec![InstanceTruth { name, id: 1, role: Role::Object, category: "cup".to_owned(), masks }],
        visible,
    }
}

const LIFTED: &str = r#"[{"category":"cup"},{"undergoes":{"verb":"lift","by":{"category":"hand"}}}]"#;

fn proposal(category: &str, text: &str, referents: &[u32], frames: &[[u32; 2]], predicate: &str) -> Proposal {
    let temporal = if frames.is_empty() { "whole" } else { "while" };
    let item = json!({
        "category": category, "text": text, "referents": referents, "temporal": temporal, "frames": frames,
        "predicate": predicate,
    });
    Proposal::read(&item).unwrap()
}

fn model() -> Provenance {
    Provenance { source: Source::Model, note: String::new() }
}

fn judge(set: &SceneSet, proposal: &Proposal) -> Outcome {
    let vocabulary: Vocabulary =
        "the cup that hand lifts while it is lifted by a wobbles white rolls bowl nearest to tray blue left of behind as"
            .split(' ')
            .collect();
    Screening::new(set, &rendering(&set.tracks, Profile::Tiny), Some(&vocabulary)).judge(proposal, model())
}

/// Codes of the reasons of a proposal about the kitchen that must fail.
fn codes(proposal: &Proposal) -> Vec<&'static str> {
    match judge(&kitchen(), proposal) {
        Outcome::Failed(reasons) => reasons.iter().map(|reason| reason.code).collect(),
        taken => panic!("was taken: {taken:?}"),
    }
}

#[test]
fn a_proved_proposal_is_a_candidate() {
    let whole = proposal("interaction", "The cup that the hand lifts", &[1], &[], LIFTED);
    let Outcome::Candidate(query) = judge(&kitchen(), &whole) else { panic!("was not taken") };
    assert_eq!(query.id.to_string(), "kitchen/002");
    assert_eq!((query.frames.as_slice(), query.status), ([Interval::WHOLE].as_slice(), Status::Candidate));
    assert_eq!(query.referents, [Name::new("cup_lifted").unwrap()]);
    assert_eq!(query.text_digest, text_digest(&query.text, query.predicate.as_ref()));
}

#[test]
fn the_proof_gives_the_edges_of_an_interval() {
    // Claimed and proved share 25 of 33 frames, then 9 of 43: too few.
    let gated = |frames| proposal("interaction", "The cup while the hand lifts it", &[1], &[frames], LIFTED);
    let Outcome::Candidate(query) = judge(&kitchen(), &gated([18, 44])) else { panic!("was not taken") };
    assert_eq!(query.frames, [Interval::new(20, 50).unwrap()]);
    assert_eq!(codes(&gated([42, 62])), ["L4D566"]);
}

#[test]
fn what_fails_has_its_codes() {
    let lifted = |text: &str, referents: &[u32], frames: &[[u32; 2]]| {
        proposal("interaction", text, referents, frames, LIFTED)
    };
    let about = |referents: &[u32]| lifted("The cup that the hand lifts", referents, &[]);
    let says = |text: &str| lifted(text, &[1], &[]);
    let attribute = |text: &str, referent: u32, noun: &str, value: &str| {
        let predicate =
            json!([{ "category": noun }, { "attribute": { "key": "colour", "value": value } }]).to_string();
        proposal("attribute", text, &[referent], &[], &predicate)
    };
    let nearest = r#"[{"category":"cup"},{"relation":{"kind":"closest_to","of":[{"name":"tray"}]}}]"#;
    let wobble = r#"[{"category":"cup"},{"does":{"verb":"wobble"}}]"#;
    let cases: &[(&[&str], Proposal)] = &[
        (&["L4D563"], about(&[77])),
        (&["L4D563"], about(&[0])),
        // A landmark.
        (&["L4D563"], about(&[5])),
        (&["L4D563"], about(&[])),
        // One of two is unknown; a query means one object.
        (&["L4D563"], about(&[1, 99])),
        (&["L4D202"], about(&[1, 2])),
        (&["L4D214"], says("The cupp that the hand lifts")),
        (&["L4D216"], says("The cup to the left of the bowl")),
        // The predicate has no such relation.
        (&["L4D216"], says("The cup behind the bowl")),
        (&["L4D565"], says("Cup")),
        (&["L4D565"], says(&"The cup ".repeat(11))),
        // A whole sentence has no gate, a gated one has; kitchen/001 says the last one.
        (&["L4D215"], says("The cup while it is lifted")),
        (&["L4D215"], lifted("The cup that the hand lifts", &[1], &[[20, 50]])),
        (&["L4D213"], says("The  Blue cup")),
        (&["L4D564", "L4D205"], attribute("The white bowl", 4, "bowl", "white")),
        (&["L4D204"], about(&[2])),
        (&["L4D204"], attribute("The white cup", 1, "cup", "white")),
        (&["L4D203"], attribute("The white cup", 1, "cup", "mauve")),
        (&["L4D203"], proposal("action", "The cup that wobbles", &[1], &[], wobble)),
        (&["L4D207"], proposal("action", "The cup that the hand lifts", &[1], &[], LIFTED)),
        // 0.15 m against 0.18 m: a factor of 1.2 is above 1.15, and below it with thresholds 10 % tighter.
        (&["L4D211"], proposal("spatial", "The cup nearest to the tray", &[1], &[], nearest)),
        (&["L4D212"], attribute("The cup that is blue", 3, "cup", "blue")),
        (&["L4D206"], lifted("The cup while the hand lifts it", &[2], &[[20, 50]])),
        (&["L4D206"], proposal("action", "The cup while it wobbles", &[2], &[[10, 21]], "")),
        (&["L4D206"], proposal("action", "The cup while it wobbles", &[2], &[[90, 120]], "")),
        (&["L4D216"], proposal("action", "The cup left of the tray", &[2], &[], "")),
    ];
    for (expected, proposal) in cases {
        assert_eq!(codes(proposal), *expected, "{}", proposal.text);
    }
}

#[test]
fn without_a_predicate_a_person_goes_on() {
    for said in ["", "wobble(x)", r#"[{"category":"cup"}]"#, r#"[{"category":"cup"},{"is":"nice"}]"#] {
        let wobbles = proposal("action", "The cup that wobbles", &[2], &[], said);
        let Outcome::NeedsPredicate(query, reasons) = judge(&kitchen(), &wobbles) else { panic!("{said}") };
        assert_eq!((query.predicate, query.categories), (None, vec![Category::Action]));
        let codes: Vec<&str> = reasons.iter().map(|reason| reason.code).collect();
        assert_eq!(codes, if said.is_empty() { vec![] } else { vec!["L4D567"] });
    }
    let gated = |frames| proposal("action", "The cup while it wobbles", &[2], &[frames], "");
    let Outcome::NeedsPredicate(query, _) = judge(&kitchen(), &gated([10, 22])) else {
        panic!("13 frames will do")
    };
    assert_eq!(query.frames, [Interval::new(10, 22).unwrap()]);
}

#[test]
fn what_cannot_be_seen_is_not_asked_for() {
    let lifted = proposal("interaction", "The cup that the hand lifts", &[1], &[], LIFTED);
    let gated = proposal("interaction", "The cup while the hand lifts it", &[1], &[[20, 50]], LIFTED);
    let wobbles = proposal("action", "The cup that wobbles", &[1], &[], "");
    let of = |truth: Truth, proposal: &Proposal| match judge(
        &SceneSet { truth: Some(truth), ..kitchen() },
        proposal,
    ) {
        Outcome::Failed(reasons) => reasons.iter().map(|reason| reason.code).collect(),
        _ => Vec::new(),
    };
    let always = |_| true;
    assert_eq!(of(truth(Profile::Tiny, 5, always), &lifted), Vec::<&str>::new(), "tiny has no gates");
    assert_eq!(of(truth(Profile::Tiny, 5, |_| false), &lifted), ["L4D210"]);
    assert_eq!(of(truth(Profile::Tiny, 5, |_| false), &wobbles), ["L4D210"]);
    assert_eq!(of(truth(Profile::Tiny, 5, |frame| frame > 60), &gated), ["L4D210"]);
    assert_eq!(of(truth(Profile::Small, 149, always), &lifted), ["L4D115"]);
    // Four training views are fewer than the six that the gates ask for.
    assert_eq!(of(truth(Profile::Small, 150, always), &lifted), ["L4D116"]);
}

#[test]
fn what_was_taken_counts_against_the_next() {
    let set = kitchen();
    let scene = rendering(&set.tracks, Profile::Tiny);
    let mut screening = Screening::new(&set, &scene, None);
    let mut judge = |text: &str, predicate: &str| {
        screening.judge(&proposal("interaction", text, &[1], &[], predicate), model())
    };
    let is_candidate = |outcome: &Outcome| matches!(outcome, Outcome::Candidate(_));
    let failed_with = |outcome: Outcome, code: &str| match outcome {
        Outcome::Failed(reasons) => reasons.iter().any(|reason| reason.code == code),
        _ => false,
    };
    assert!(failed_with(
        judge(
            "The cup that nobody lifts",
            r#"[{"category":"cup"},{"not":{"does":{"verb":"lift","to":{"name":"tray"}}}}]"#
        ),
        "L4D204"
    ));
    assert!(is_candidate(&judge("The cup that the hand lifts", LIFTED)));
    assert!(failed_with(judge("The cup the hand lifts up", LIFTED), "L4D212"));
    assert!(failed_with(judge("The cup that the hand lifts", ""), "L4D213"));
    match judge("The cup that is picked up", "") {
        Outcome::NeedsPredicate(query, _) => assert_eq!(query.id.to_string(), "kitchen/003"),
        other => panic!("{other:?}"),
    }
}

/// Runs over all shipped queries as if none of a scene's single queries existed yet: a check that refuses what is sound
/// is as wrong as one that takes what is not.
fn for_each_query(mut check: impl FnMut(&mut Screening<'_>, &Query, &Tracks)) {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark");
    let bench = Benchmark::open(root).unwrap();
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary()).unwrap();
    let mut count = 0;
    for name in &bench.manifest.scenes {
        let mut set = SceneSet::read(&bench, Profile::Small, name, &mut Report::default()).unwrap();
        let queries = std::mem::take(&mut set.queries);
        let scene = rendering(&set.tracks, Profile::Small);
        let mut screening = Screening::new(&set, &scene, vocabulary.as_ref());
        count += queries.len();
        queries.iter().for_each(|query| check(&mut screening, query, &set.tracks));
    }
    assert!(count >= 250, "only {count} queries were tried");
}

/// What a model would say that sees the clip four times a second: edges of intervals are off by up to 3 frames.
fn proposed(query: &Query, tracks: &Tracks) -> Proposal {
    let number = tracks.instances.iter().position(|found| found.name == query.referents[0]).unwrap() + 1;
    let frames = query.frames.iter().map(|interval| [(interval.first() + 3).min(96), interval.last()]);
    let item = json!({
        "category": query.categories[0],
        "text": format!("{}.", query.text),
        "referents": [number],
        "temporal": query.temporal,
        "frames": frames.collect::<Vec<_>>(),
        "predicate": query.predicate.as_ref().unwrap().to_string(),
    });
    Proposal::read(&item).unwrap()
}

#[test]
fn every_shipped_query_would_be_a_candidate() {
    for_each_query(|screening, query, tracks| match screening.judge(&proposed(query, tracks), model()) {
        Outcome::Candidate(candidate) => {
            let same = Query { id: query.id.clone(), provenance: query.provenance.clone(), ..candidate };
            assert_eq!(same, Query { status: Status::Candidate, ..query.clone() });
        }
        other => panic!("{} \"{}\": {other:?}", query.id, query.text),
    });
}

#[test]
fn no_look_alike_passes_for_the_referent() {
    for_each_query(|screening, query, tracks| {
        let truthful = proposed(query, tracks);
        let category = &tracks.instance(&query.referents[0]).unwrap().category;
        for (index, other) in tracks.instances.iter().enumerate() {
            let is_look_alike = other.category == *category && other.name != query.referents[0];
            if other.role == Role::Object && is_look_alike {
                let lie = Proposal { referents: vec![index as u32 + 1], ..truthful.clone() };
                let outcome = screening.judge(&lie, model());
                assert!(
                    matches!(outcome, Outcome::Failed(_)),
                    "{} for {}: {outcome:?}",
                    query.id,
                    other.name
                );
            }
        }
    });
}
