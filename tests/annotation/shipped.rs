//! What the repository ships for annotation: the demo round and the guidelines fit the benchmark and the tool.

use std::collections::BTreeSet;

use l4d_data::{Benchmark, Name};
use l4d_votes::key::{Change, changes};
use l4d_votes::{Key, Round, RoundDir};

use crate::support::{Dir, root};

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
    let ignored = std::fs::read_to_string(root().join(".gitignore")).unwrap();
    assert!(ignored.contains("/annotation/rounds/demo/votes/"), "{ignored}");
}

#[test]
fn the_demo_round_is_what_its_documented_command_draws() {
    let readme = std::fs::read_to_string(root().join("annotation/README.md")).unwrap();
    let (_, command) = readme.split_once("    l4d open-round demo").unwrap();
    let command = command.split("\n\n").next().unwrap().replace("\\\n", " ");
    let mut arguments = vec!["open-round", "demo"];
    for (place, part) in command.split('"').enumerate() {
        // What is between quotes is one argument.
        if place % 2 == 1 { arguments.push(part) } else { arguments.extend(part.split_whitespace()) }
    }
    let dir = Dir::new();
    let bench = root().join("benchmark");
    dir.succeed(&[&arguments[..], &["--bench", bench.to_str().unwrap()]].concat());
    for file in ["round.toml", "items.jsonl", "key.jsonl"] {
        let file = format!("annotation/rounds/demo/{file}");
        assert_eq!(dir.read(&file), std::fs::read_to_string(root().join(&file)).unwrap(), "{file}");
    }
}

#[test]
fn the_guidelines_give_no_answer_away() {
    let guidelines = std::fs::read_to_string(root().join("annotation/GUIDELINES.md")).unwrap();
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
    let guidelines = std::fs::read_to_string(root().join("annotation/GUIDELINES.md")).unwrap();
    for (key, what) in l4d_annotate::keys::HELP.iter().flat_map(|(_, keys)| *keys) {
        let row = format!("| `{key}` | {what} |");
        assert!(guidelines.contains(&row), "annotation/GUIDELINES.md lacks {row}");
    }
}
