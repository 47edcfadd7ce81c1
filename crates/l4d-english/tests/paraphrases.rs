//! Other wordings of the queries of the dev set, written without regard to the grammar: how many the reader understands.
//!
//! Wordings 1 and 2 are there to develop with. Wording 3 is held out: it is counted here and never printed.
#![expect(clippy::unwrap_used, reason = "a test that cannot read the dev set has failed")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::tracks::Tracks;
use l4d_data::{Query, Temporal};
use l4d_english::{Reading, Words, canonical, understand};
use l4d_query::eval::{answer_times, answer_whole};
use l4d_query::{Predicate, World};
use serde::Deserialize;

/// The wording that nothing is developed with.
const HELD_OUT: u32 = 3;
/// Percent with the same answer, at least.
const FLOOR: [(&str, usize); 2] = [("seen", 97), ("held out", 76)];

#[derive(Deserialize)]
struct Paraphrase {
    of: String,
    wording: u32,
    text: String,
}

#[derive(Debug, Default, Clone, Copy)]
struct Count {
    all: usize,
    read: usize,
    exact: usize,
    same: usize,
    /// Read with another answer at a confidence above one half.
    sure_and_wrong: usize,
    /// Some reading has the same answer.
    among: usize,
    /// The first reading that describes one thing has the same answer.
    single: usize,
}

fn dev() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark/dev")
}

fn lines(path: &Path) -> Vec<String> {
    std::fs::read_to_string(path).unwrap_or_default().lines().map(str::to_owned).collect()
}

fn answer(world: &World<'_>, predicate: &Predicate, temporal: Temporal) -> String {
    match temporal {
        Temporal::Whole => format!("{:?}", answer_whole(world, predicate)),
        Temporal::While => format!("{:?}", answer_times(world, predicate)),
    }
}

fn has_one(world: &World<'_>, reading: &Reading) -> bool {
    match reading.temporal {
        Temporal::Whole => answer_whole(world, &reading.predicate).len() == 1,
        Temporal::While => answer_times(world, &reading.predicate).len() == 1,
    }
}

#[test]
fn paraphrases() {
    let is_verbose = std::env::var_os("L4D_SHOW_PARAPHRASES").is_some();
    let mut counts: BTreeMap<(&str, String), Count> = BTreeMap::new();
    for tracks in scenes() {
        let (words, world) = (Words::of(&tracks), World::new(&tracks));
        let scene = &tracks.scene;
        let mut queries: BTreeMap<String, Query> = BTreeMap::new();
        for file in [format!("{scene}.jsonl"), format!("{scene}.composite.jsonl")] {
            for line in lines(&dev().join("queries").join(file)) {
                let query: Query = serde_json::from_str(&line).unwrap();
                queries.insert(query.id.to_string(), query);
            }
        }
        for line in lines(&dev().join("queries").join(format!("{scene}.paraphrase.jsonl"))) {
            let paraphrase: Paraphrase = serde_json::from_str(&line).unwrap();
            let Some(query) = queries.get(&paraphrase.of) else { continue };
            let meant = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
            let set = if paraphrase.wording == HELD_OUT { "held out" } else { "seen" };
            let readings = understand(&paraphrase.text, &words).unwrap_or_default();
            let found = readings.first();
            let is_exact = |reading: &Reading| {
                reading.temporal == query.temporal && reading.predicate == canonical(&meant)
            };
            let is_same = |reading: &Reading| {
                reading.temporal == query.temporal
                    && answer(&world, &reading.predicate, reading.temporal)
                        == answer(&world, &meant, query.temporal)
            };
            let (exact, same) = (found.is_some_and(is_exact), found.is_some_and(is_same));
            let category = query
                .categories
                .iter()
                .map(|category| format!("{category:?}").to_lowercase())
                .collect::<Vec<_>>()
                .join("+");
            for name in [category, "all".to_owned()] {
                let count = counts.entry((set, name)).or_default();
                count.all += 1;
                count.read += usize::from(found.is_some());
                count.exact += usize::from(exact);
                count.same += usize::from(same);
                count.sure_and_wrong +=
                    usize::from(!same && found.is_some_and(|reading| reading.confidence > 0.5));
                count.among += usize::from(readings.iter().any(is_same));
                // Who knows the scene may take the first reading that has one answer.
                let single = readings.iter().find(|reading| has_one(&world, reading)).or(found);
                count.single += usize::from(single.is_some_and(is_same));
            }
            if is_verbose && set == "seen" && !same {
                println!(
                    "{} {}\n    meant {} {:?}",
                    query.id,
                    paraphrase.text,
                    canonical(&meant),
                    query.temporal
                );
                match found {
                    Some(reading) => println!(
                        "    read  {} {:?} ({:.2}) skipped {:?}",
                        reading.predicate, reading.temporal, reading.confidence, reading.skipped
                    ),
                    None => println!("    {}", understand(&paraphrase.text, &words).unwrap_err()),
                }
            }
        }
    }
    println!(
        "wordings    category                 all  read exact  same   same %  wrong above 0.5  among  first with one"
    );
    for ((set, name), count) in &counts {
        let percent = 100.0 * count.same as f64 / count.all as f64;
        println!(
            "{set:<11} {name:<24} {:>3} {:>5} {:>5} {:>5} {percent:>8.1} {:>16} {:>6} {:>15}",
            count.all, count.read, count.exact, count.same, count.sure_and_wrong, count.among, count.single
        );
    }
    for (set, floor) in FLOOR {
        let count = counts[&(set, "all".to_owned())];
        assert!(count.same * 100 >= floor * count.all, "{set}: {} of {}", count.same, count.all);
    }
}

/// What the composer says is understood as exactly what it meant, composites and absent referents too.
#[test]
fn what_is_said_is_understood_exactly() {
    let mut wrong = Vec::new();
    for scene in scenes() {
        let words = Words::of(&scene);
        for kind in ["", ".composite", ".absent"] {
            for line in lines(&dev().join("queries").join(format!("{}{kind}.jsonl", scene.scene))) {
                let query: Query = serde_json::from_str(&line).unwrap();
                let meant = canonical(&Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap());
                let reading = understand(&query.text, &words).unwrap().swap_remove(0);
                if (reading.temporal, &reading.predicate) != (query.temporal, &meant) {
                    wrong.push(format!("{}: {}\n    {}", query.id, query.text, reading.predicate));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn scenes() -> Vec<Tracks> {
    let folder = std::fs::read_dir(dev().join("scenes")).unwrap();
    let mut paths: Vec<PathBuf> = folder.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()).collect()
}
