//! What each part of a belief is worth: how often the first of the ranked is what is meant, by category.
//!
//! `cargo test -p l4d-query --test worth -- --nocapture` prints the table of the development scenes.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, Profile, Query, Report, Temporal};
use l4d_query::prove::SceneSet;
use l4d_query::soft::{Belief, BelievedEvent, Meant, Noise, Thing, derive, rank};
use l4d_query::{Predicate, Times};

fn sets(folder: &str) -> Vec<SceneSet> {
    let bench = Benchmark::open(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap();
    let scenes = bench.select(&[]).unwrap();
    let read = |scene| SceneSet::read(&bench, Profile::Small, scene, &mut Report::default()).unwrap();
    scenes.iter().map(read).collect()
}

fn predicate(query: &Query) -> Predicate {
    Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap()
}

#[test]
fn the_first_of_the_ranked_is_what_is_meant() {
    for folder in ["../../benchmark", "../../benchmark/dev"] {
        for set in sets(folder) {
            let belief = Belief::certain(&set.tracks).unwrap();
            for query in set.queries.iter().chain(&set.composites) {
                let ranked = rank(&belief, &predicate(query), query.temporal);
                assert_eq!([&ranked[0].name], query.referents.iter().collect::<Vec<_>>()[..], "{}", query.id);
                let second = ranked.get(1).map_or(0.0, |one| one.score);
                assert!(ranked[0].score > second, "{}: {} and {second}", query.id, ranked[0].score);
                let frames = query.frames.iter().map(|&interval| Times::of(interval));
                let frames = l4d_query::times::any_of(frames);
                assert_eq!(ranked[0].when.likely(), frames, "{}", query.id);
                assert!(query.temporal == Temporal::While || frames.all());
            }
        }
    }
}

/// What is known of a scene beside kinds and boxes.
#[derive(Clone, Copy, PartialEq)]
struct Known {
    attributes: bool,
    events: Events,
}

/// From where it is known what happens.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Events {
    Unknown,
    Derived,
    Declared,
}

fn belief<'a>(tracks: &'a Tracks, predicate: &Predicate, known: Known) -> Belief<'a> {
    let certain = Belief::certain(tracks).unwrap();
    let mut things: Vec<Thing> = certain.things().cloned().collect();
    if !known.attributes {
        things.iter_mut().for_each(|thing| thing.attributes.clear());
    }
    let events: Vec<BelievedEvent> = match known.events {
        Events::Unknown => Vec::new(),
        Events::Derived => derive::events(tracks, predicate),
        Events::Declared => certain.events().to_vec(),
    };
    let names = tracks.instances.iter().map(|one| (one.name.clone(), Meant::Thing(one.name.clone())));
    Belief::new(tracks, things, events, Noise::NONE).unwrap().with_names(names.collect())
}

#[test]
fn every_part_of_a_belief_is_worth_something() {
    let sets = sets("../../benchmark/dev");
    let parts = [(true, Events::Declared), (false, Events::Unknown), (true, Events::Unknown)];
    let parts = parts.into_iter().chain([(false, Events::Declared), (true, Events::Derived)]);
    let mut shares = Vec::new();
    for (attributes, events) in parts {
        let mut tally: BTreeMap<String, [f64; 2]> = BTreeMap::new();
        for set in &sets {
            for query in set.queries.iter().chain(&set.composites) {
                let predicate = predicate(query);
                let belief = belief(&set.tracks, &predicate, Known { attributes, events });
                let ranked = rank(&belief, &predicate, query.temporal);
                let best = ranked.iter().filter(|one| one.score >= ranked[0].score - 1e-12);
                let best: Vec<_> = best.collect();
                // Of several that fit equally well one is guessed.
                let is_among = best.iter().any(|one| query.referents.contains(&one.name));
                let share = if is_among { 1.0 / best.len() as f64 } else { 0.0 };
                let names: Vec<&str> = query.categories.iter().map(|category| category.as_str()).collect();
                let keys = [names.join("+"), if names.len() > 1 { "composites" } else { "all" }.to_owned()];
                for key in keys {
                    let counts = tally.entry(key).or_default();
                    *counts = [counts[0] + share, counts[1] + 1.0];
                }
            }
        }
        let share = |[found, asked]: &[f64; 2]| 100.0 * found / asked;
        println!("attributes {attributes}, events {events:?}");
        for (key, counts) in &tally {
            println!("  {key:<24}{:>6.1} of {:>3}", share(counts), counts[1]);
        }
        shares.push(share(&tally["all"]));
    }
    assert_eq!(shares[0], 100.0);
    let [_, bare, attributes, events, derived] = shares[..] else { panic!("five beliefs") };
    assert!(bare < attributes && bare < events && attributes < 100.0 && events < 100.0, "{shares:?}");
    assert!(derived > attributes + 5.0, "{shares:?}");
}
