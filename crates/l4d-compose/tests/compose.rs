//! Queries of made-up scenes: proved on disk, the same every time, without shortcuts, refused where there are too few.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

#[path = "compose/made_up.rs"]
mod made_up;

use std::collections::BTreeSet;
use std::path::Path;

use l4d_compose::{Composed, LEAST_QUERIES, QueriesRequest, Refused, enumerate, queries, write};
use l4d_data::benchmark::{Manifest, SetSplit};
use l4d_data::query::Source;
use l4d_data::store::write_atomic;
use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, Category, Name, Profile, Report, json};
use l4d_english::Words;
use l4d_query::Predicate;
use l4d_query::probes::BOUND_POINTS;
use l4d_query::prove::{Kind, Prover, words};

/// Two groups with look-alikes.
const GROUPS: [(&str, usize); 2] = [("cup", 4), ("duck", 3)];

fn scenes(count: u64) -> Vec<Tracks> {
    (0..count).map(|seed| made_up::scene(&format!("scene_{seed:03}"), &GROUPS, seed)).collect()
}

fn composed(tracks: &Tracks, avoid: &BTreeSet<String>) -> Result<Composed, Refused> {
    composed_from(tracks, 7, avoid)
}

fn composed_from(tracks: &Tracks, seed: u64, avoid: &BTreeSet<String>) -> Result<Composed, Refused> {
    let known = Words::of(tracks);
    let say = |predicate: &Predicate, temporal| l4d_english::forms(predicate, temporal, &known);
    queries(tracks, &QueriesRequest { seed, avoid, truth: None }, &say)
}

/// A benchmark folder of the scenes that have enough queries.
fn bench(root: &Path, scenes: &[Tracks]) -> Benchmark {
    let mut manifest = Manifest {
        name: "Made up".to_owned(),
        version: "0.1.0".to_owned(),
        licence: "CC0-1.0".to_owned(),
        split: SetSplit::Train,
        variant: 0,
        seed: 0,
        scenes: Vec::new(),
    };
    let dir = l4d_data::layout::BenchDir::new(root);
    for tracks in scenes {
        let Ok(composed) = composed(tracks, &BTreeSet::new()) else { continue };
        json::write_compact(&dir.tracks(&tracks.scene), tracks).unwrap();
        write(&dir, &tracks.scene, &composed).unwrap();
        manifest.scenes.push(tracks.scene.clone());
    }
    write_atomic(&dir.manifest(), manifest.to_toml("Made up.").unwrap().as_bytes()).unwrap();
    Benchmark::open(root).unwrap()
}

#[test]
fn what_is_written_is_proved_and_no_shortcut_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let bench = bench(folder.path(), &scenes(16));
    let scenes: &[Name] = &bench.manifest.scenes;
    assert!(scenes.len() >= 15, "{} scenes of 16", scenes.len());
    let mut report = Report::default();
    let summary = l4d_query::check_set(&bench, Profile::Small, scenes, &mut report);
    assert_eq!(report.into_sorted(), []);
    for probe in &summary.probes {
        println!("{} {} {:?}", probe.name, probe.difference, probe.categories);
    }
    for probe in summary.probes.iter().filter(|probe| probe.bounded && probe.queries > 0) {
        assert!(probe.difference <= BOUND_POINTS, "{probe:?}");
        let worst = probe.categories.values().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(worst <= BOUND_POINTS, "{} {:?}", probe.name, probe.categories);
    }
    let counts: Vec<usize> =
        Category::ALL.iter().map(|category| summary.queries[category.as_str()]).collect();
    let total: usize = counts.iter().sum();
    assert!(total >= LEAST_QUERIES * scenes.len());
    assert!(counts.iter().all(|count| 10 * count >= total), "{counts:?}");
}

#[test]
fn all_that_is_enumerated_is_accepted_whatever_it_will_be_called() {
    let tracks = &scenes(1)[0];
    let prover = Prover::new(tracks, None, None);
    let found = enumerate(&prover);
    let known = Words::of(tracks);
    let mut kinds = BTreeSet::new();
    for candidate in found.iter().step_by(5) {
        let id = format!("{}/001", tracks.scene).parse().unwrap();
        let Some(text) =
            l4d_english::forms(&candidate.predicate, candidate.temporal, &known).into_iter().next()
        else {
            continue;
        };
        let query = candidate.query(id, &text).unwrap();
        let mut report = Report::default();
        prover.check(candidate.kind, Path::new("q"), &query, &mut report);
        assert_eq!(report.into_sorted(), [], "{}", candidate.predicate);
        kinds.insert(format!("{:?} {:?}", candidate.kind, candidate.temporal));
    }
    assert_eq!(kinds.len(), 4, "{kinds:?}");
    for category in Category::ALL {
        let single = |kind, categories: Vec<Category>| kind == Kind::Single && categories == [category];
        assert!(found.iter().any(|one| single(one.kind, one.categories())), "{category:?}");
    }
}

#[test]
fn a_scene_alone_decides_and_every_object_is_asked_for() {
    let scenes = scenes(4);
    let avoid = BTreeSet::new();
    for tracks in &scenes {
        let first = composed(tracks, &avoid).unwrap();
        assert_eq!(composed(tracks, &avoid).unwrap(), first);
        let other = composed_from(tracks, 8, &avoid).unwrap();
        assert_ne!(other, first, "another seed draws another set");
        let meant: BTreeSet<&Name> = first.singles.iter().flat_map(|query| &query.referents).collect();
        assert!(meant.len() >= 6, "{meant:?} of seven objects are asked for");
        assert!((2..=4).contains(&first.composites.len()) && (1..=2).contains(&first.absents.len()));
        let all = first.singles.iter().chain(&first.composites).chain(&first.absents);
        let mut texts: Vec<&str> = all.clone().map(|query| query.text.as_str()).collect();
        assert!(all.clone().all(|query| query.provenance.source == Source::Composed));
        let count = texts.len();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), count);
    }
}

#[test]
fn sentences_that_are_taken_are_not_used() {
    let tracks = &scenes(1)[0];
    let said = |composed: &Composed| -> BTreeSet<String> {
        composed.singles.iter().map(|query| words(&query.text).join(" ")).collect()
    };
    let first = said(&composed(tracks, &BTreeSet::new()).unwrap());
    let second = said(&composed(tracks, &first).unwrap());
    assert!(first.is_disjoint(&second));
}

#[test]
fn a_scene_without_look_alikes_is_refused_with_what_is_short() {
    let tracks = made_up::scene("lonely", &[("cup", 1), ("duck", 1), ("jug", 1)], 3);
    let refused = composed(&tracks, &BTreeSet::new()).unwrap_err();
    assert!(matches!(&refused, Refused::TooFew { found: 0, .. }), "{refused}");
    let message = refused.to_string();
    assert!(
        message.contains("`cup_0` has no look-alike") && message.contains("category action"),
        "{message}"
    );
}

#[test]
fn tracks_that_contradict_their_events_are_refused() {
    let mut tracks = scenes(1).remove(0);
    let event = tracks.events.iter_mut().find(|event| event.object.is_some()).unwrap();
    event.verb = "carry".to_owned();
    let pair = tracks.pairs.iter_mut().find(|pair| {
        Some(&pair.a) == event.object.as_ref() && pair.b == event.subject
            || pair.a == event.subject && Some(&pair.b) == event.object.as_ref()
    });
    pair.unwrap().distance_m = vec![0.3];
    let refused = composed(&tracks, &BTreeSet::new()).unwrap_err();
    assert!(matches!(&refused, Refused::Unproved { code: "L4D220", .. }), "{refused}");
}
