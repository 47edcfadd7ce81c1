//! What the repository ships for annotation: the demo round and the guidelines fit the benchmark and the tool.

use std::collections::BTreeSet;

use l4d_data::{Benchmark, Name};
use l4d_votes::key::{Change, changes};
use l4d_votes::{Key, Round, RoundDir};

use crate::support::{Dir, root, shipped};

#[test]
fn the_shipped_demo_round_fits_the_shipped_benchmark() {
    let bench = Benchmark::open(root().join("benchmark")).unwrap();
    let folder = RoundDir::new(root().join("annotation/rounds/demo"));
    let round = Round::open(&folder).unwrap();
    let key = Key::read(&folder, &round).unwrap();
    assert!(round.simulated, "no one has voted in it, and trying it is no panel");
    assert!((20..=30).contains(&round.items.len()), "{} items", round.items.len());
    let scenes: BTreeSet<&Name> = round.items.iter().map(|item| &item.scene).collect();
    assert!(scenes.len() >= 3, "{scenes:?}");
    for (item, change) in changes(&round, &key, &bench).unwrap() {
        assert_eq!(change, Change::No, "{item}: open the round anew");
    }
    // Trying it writes votes there, which are not shipped.
    let ignored = shipped(".gitignore");
    assert!(ignored.contains("/annotation/rounds/demo/votes/"), "{ignored}");
}

#[test]
fn the_demo_round_is_what_its_documented_command_draws() {
    let readme = shipped("annotation/README.md");
    let (_, command) = readme.split_once("    l4d open-round demo").unwrap();
    let arguments = command.split("\n\n").next().unwrap().replace("\\\n", " ").replace('"', "'");
    let dir = Dir::new();
    dir.succeed(format!("open-round demo {arguments} --bench {}/benchmark", root().display()));
    for file in ["round.toml", "items.jsonl", "key.jsonl"] {
        let file = format!("annotation/rounds/demo/{file}");
        assert_eq!(dir.read(&file), shipped(&file), "{file}");
    }
}

#[test]
fn the_guidelines_give_no_answer_away() {
    let guidelines = shipped("annotation/GUIDELINES.md");
    let examples: Vec<String> = guidelines
        .lines()
        .filter_map(|line| line.strip_prefix('*')?.split_once("*: "))
        .map(|(prompt, _)| prompt.to_lowercase())
        .collect();
    assert_eq!(examples.len(), 4, "{examples:?}");
    let bench = Benchmark::open(root().join("benchmark")).unwrap();
    for scene in &bench.manifest.scenes {
        let asked = [bench.queries(scene), bench.composites(scene), bench.absents(scene)]
            .map(Result::unwrap)
            .concat();
        for query in asked {
            assert!(!examples.contains(&query.text.to_lowercase()), "{} is asked: {}", query.id, query.text);
        }
    }
    let pictures: Vec<&str> =
        guidelines.lines().filter_map(|line| line.split_once("](../")?.1.strip_suffix(')')).collect();
    assert_eq!(pictures.len(), 5);
    for picture in pictures {
        assert!(root().join(picture).is_file(), "{picture}");
    }
}

#[test]
fn the_guidelines_list_every_key() {
    let guidelines = shipped("annotation/GUIDELINES.md");
    for (key, what) in l4d_annotate::keys::HELP.iter().flat_map(|(_, keys)| *keys) {
        let row = format!("| `{key}` | {what} |");
        assert!(guidelines.contains(&row), "annotation/GUIDELINES.md lacks {row}");
    }
}
