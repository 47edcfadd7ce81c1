//! The shipped set: every word of its scenes is known, and how many of its sentences are read. Nothing is chosen by it.

use std::path::{Path, PathBuf};

use l4d_data::tracks::Tracks;
use l4d_data::{Query, Temporal};
use l4d_english::{Words, canonical, missing, read, vocabulary};
use l4d_query::eval::{answer_times, answer_whole};
use l4d_query::prove::Vocabulary;
use l4d_query::{Predicate, World};

fn benchmark() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark")
}

fn scenes() -> Vec<Tracks> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(benchmark().join("scenes")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()).collect()
}

#[test]
fn every_noun_verb_and_property_of_the_test_scenes_has_words() {
    let all: Vec<String> = scenes().iter().flat_map(missing).collect();
    assert_eq!(all, [""; 0]);
}

#[test]
fn every_word_that_may_be_said_is_reviewed() {
    let reviewed = Vocabulary::read(&benchmark().join("vocabulary.txt")).unwrap().unwrap();
    let unknown: Vec<String> = vocabulary().iter().flat_map(|word| reviewed.unknown(word)).collect();
    assert_eq!(unknown, [""; 0], "add them to benchmark/vocabulary.txt");
}

/// Counts alone: what other people's sentences are to the reader. The bound keeps the reader from getting worse.
#[test]
fn sentences_of_other_people() {
    let (mut all, mut understood, mut exact, mut same) = (0, 0, 0, 0);
    for tracks in scenes() {
        let (words, world) = (Words::of(&tracks), World::new(&tracks));
        let path = benchmark().join("queries").join(format!("{}.jsonl", tracks.scene));
        for line in std::fs::read_to_string(path).unwrap().lines() {
            let query: Query = serde_json::from_str(line).unwrap();
            let meant = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
            all += 1;
            let Ok((predicate, temporal)) = read(&query.text, &words) else { continue };
            understood += 1;
            exact += usize::from(temporal == query.temporal && predicate == canonical(&meant));
            let answer = |predicate: &Predicate, temporal: Temporal| match temporal {
                Temporal::Whole => format!("{:?}", answer_whole(&world, predicate)),
                Temporal::While => format!("{:?}", answer_times(&world, predicate)),
            };
            same += usize::from(
                temporal == query.temporal && answer(&predicate, temporal) == answer(&meant, query.temporal),
            );
        }
    }
    println!(
        "{all} sentences, {understood} read, {exact} as exactly their predicate, {same} with the same answer"
    );
    assert_eq!(all, 289);
    assert!(understood >= 140 && exact >= 110, "{understood} read, {exact} exactly");
}
