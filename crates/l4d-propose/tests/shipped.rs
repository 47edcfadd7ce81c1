//! The shipped queries, proposed as a model that understands everything would propose them: all of them pass, since a
//! check that refuses what is sound is as wrong as one that takes what is not.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

use l4d_data::query::Provenance;
use l4d_data::scene::{Generator, SCHEMA, Scene};
use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::{Benchmark, Camera, Profile, Query, Report, Role, Status};
use l4d_propose::queries::{Exam, Outcome, Proposal};
use l4d_query::prove::{SceneSet, Vocabulary};
use serde_json::json;

const PROFILE: Profile = Profile::Small;

/// The rendering of a scene as far as gates ask about it: which views there are.
fn rendering(tracks: &Tracks) -> Scene {
    let camera = |camera: &l4d_data::tracks::TrackedCamera| Camera {
        name: camera.name.clone(),
        split: camera.split,
        fx: 1.0,
        fy: 1.0,
        cx: 0.0,
        cy: 0.0,
        world_from_camera: camera.world_from_camera.clone(),
    };
    Scene {
        schema: SCHEMA.to_owned(),
        name: tracks.scene.clone(),
        scale: tracks.scale,
        variant: tracks.variant,
        seed: tracks.seed,
        profile: PROFILE,
        stride: PROFILE.stride(),
        width: PROFILE.width(),
        height: PROFILE.height(),
        exposure: tracks.exposure,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: tracks.views(PROFILE).map(camera).collect(),
        instances: tracks.instances.iter().map(TrackedInstance::instance).collect(),
        events: tracks.events.clone(),
        digests: Default::default(),
    }
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

/// Runs over all shipped queries as if none of a scene's single queries existed yet.
fn for_each_query(mut check: impl FnMut(&mut Exam<'_>, &Query, &Tracks)) {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark");
    let bench = Benchmark::open(root).unwrap();
    let vocabulary = Vocabulary::read(&bench.dir.vocabulary()).unwrap();
    let mut count = 0;
    for name in &bench.manifest.scenes {
        let mut set = SceneSet::read(&bench, PROFILE, name, &mut Report::default()).unwrap();
        let queries = std::mem::take(&mut set.queries);
        let scene = rendering(&set.tracks);
        let mut exam = Exam::new(&set, &scene, vocabulary.as_ref());
        count += queries.len();
        queries.iter().for_each(|query| check(&mut exam, query, &set.tracks));
    }
    assert!(count >= 250, "only {count} queries were tried");
}

fn model() -> Provenance {
    Provenance { source: "model".to_owned(), note: String::new() }
}

#[test]
fn every_shipped_query_would_be_a_candidate() {
    for_each_query(|exam, query, tracks| match exam.judge(&proposed(query, tracks), model()) {
        Outcome::Candidate(candidate) => {
            let same = Query { id: query.id.clone(), provenance: query.provenance.clone(), ..candidate };
            assert_eq!(same, Query { status: Status::Candidate, ..query.clone() });
        }
        other => panic!("{} \"{}\": {other:?}", query.id, query.text),
    });
}

#[test]
fn no_look_alike_passes_for_the_referent() {
    for_each_query(|exam, query, tracks| {
        let truthful = proposed(query, tracks);
        let category = &tracks.instance(&query.referents[0]).unwrap().category;
        for (index, other) in tracks.instances.iter().enumerate() {
            let is_look_alike = other.category == *category && other.name != query.referents[0];
            if other.role == Role::Object && is_look_alike {
                let lie = Proposal { referents: vec![index as u32 + 1], ..truthful.clone() };
                let outcome = exam.judge(&lie, model());
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
