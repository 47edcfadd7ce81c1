//! Releases of private tests: two folders, and no answer in the one that is handed out.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::composition::Composition;
use l4d_data::digest::sha256_file;
use l4d_data::query::text_digest;
use l4d_data::truth::Truth;
use l4d_data::{Category, Profile, json, sums};
use l4d_frames::Display;
use l4d_frames::drawn::encode_colour;
use l4d_testing::{Dataset, copy_folder, query};
use serde_json::{Value, json};

use super::unpack_below;
use crate::support::{Dir, Run};

const MAKE: &str = "release --date 2026-11-22 --url https://example.org/private";
const RELEASE: &str = "release/made-up-0.1.0";
const SEED: u64 = 8_123_456_789_012_345;
const HELD_OUT: &str = "cam02";

/// The scene `yard` as a private test, drawn from a seed that no one may learn; two queries, a composite, a sentence
/// that nothing satisfies, and one that people rejected.
fn private() -> (Dir, Dataset) {
    let mut dataset = Dataset::new();
    (dataset.scene.seed, dataset.tracks.seed) = (SEED, SEED);
    dataset.save();
    let scene = dataset.dir();
    std::fs::write(scene.usd(), "usd of the ball_red").unwrap();
    let mut listed = sums::read(&scene.checksums()).unwrap();
    for file in ["scene.usdc", "tracks.json"] {
        listed.insert(file.to_owned(), sha256_file(&scene.root().join(file)).unwrap());
    }
    std::fs::write(scene.checksums(), sums::to_text(&listed)).unwrap();
    let bench = dataset.bench();
    let composition = Composition::of(dataset.scene.name.clone(), dataset.scene.scale, SEED);
    json::write(&bench.composition("yard"), &composition).unwrap();
    let asked = |number: &str, text: &str, referent: &str, predicate: Value| {
        let mut query = query(&format!("yard/{number}"), text, &[referent], [0, 96]);
        query.text_digest = text_digest(text, Some(&predicate));
        query.predicate = Some(predicate);
        query
    };
    let rolls = json!({ "and": [{ "category": "ball" }, { "does": "roll" }] });
    let blue = json!({ "and": [{ "category": "box" }, { "is": { "colour": "blue" } }] });
    let both = json!({ "and": [rolls.clone(), { "is": { "colour": "red" } }] });
    let mut composite = asked("501", "The red thing that rolls", "ball_red", both);
    composite.categories = vec![Category::Attribute, Category::Action];
    let mut absent = asked("901", "The cat that sleeps", "ball_red", json!({ "category": "cat" }));
    absent.referents.clear();
    let queries = [
        asked("001", "The thing that rolls", "ball_red", rolls),
        asked("002", "The blue thing", "box_blue", blue),
    ];
    json::write_lines(&bench.queries("yard"), &queries).unwrap();
    json::write_lines(&bench.composites("yard"), &[composite]).unwrap();
    json::write_lines(&bench.absents("yard"), &[absent]).unwrap();
    let dir = Dir::new();
    for (from, to) in [(dataset.data(), "data/tiny"), (bench.root().to_owned(), "benchmark")] {
        std::fs::create_dir_all(dir.path(to)).unwrap();
        copy_folder(&from, &dir.path(to));
    }
    dir.edit("benchmark/panoptic-l4d.toml", "scenes", "split = \"private\"\nscenes");
    (dir, dataset)
}

fn released() -> (Dir, Dataset, Run) {
    let (dir, dataset) = private();
    let run = dir.succeed(format!("{MAKE} --profile tiny"));
    (dir, dataset, run)
}

/// All strings in a document, keys too.
fn words(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::String(text) => drop(found.insert(text.clone())),
        Value::Array(items) => items.iter().for_each(|item| words(item, found)),
        Value::Object(fields) => fields.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            words(value, found);
        }),
        _ => {}
    }
}

#[test]
fn participants_get_no_answer() {
    let (dir, dataset, run) = released();
    run.says(0, &[&format!("{RELEASE}/participants is for participants")]);
    let handed_out = dir.tree(&format!("{RELEASE}/participants"));

    let mut secrets = BTreeSet::from(["predicate", "referents", "recipe"].map(str::to_owned));
    secrets.insert(SEED.to_string());
    let files = ["yard.jsonl", "yard.composite.jsonl", "yard.absent.jsonl"];
    for query in files.iter().flat_map(|file| dir.lines(&format!("benchmark/queries/{file}"))) {
        words(&query["referents"], &mut secrets);
        secrets.insert(json::canonical(&query["predicate"]));
        secrets.extend(["predicate", "text_digest"].map(|field| query[field].to_string()));
        secrets.insert(query["text_digest"].as_str().unwrap().to_owned());
    }
    let truth = Truth::read(&dir.path("benchmark/truth/tiny/yard.json")).unwrap();
    for instance in &truth.instances {
        secrets.insert(format!("\"{}\"", instance.name));
        secrets.extend(
            instance
                .masks
                .values()
                .map(|counts| format!("\"{}\"", serde_json::to_value(counts).unwrap().as_str().unwrap())),
        );
    }
    assert!(secrets.len() > 25, "{secrets:?}");
    assert!(!handed_out.keys().any(|file| file.ends_with(".tar")));
    for (file, bytes) in &handed_out {
        let hit =
            secrets.iter().find(|secret| bytes.windows(secret.len()).any(|part| part == secret.as_bytes()));
        assert!(hit.is_none(), "{file} holds {hit:?}");
    }

    // The pictures are the colours of the training views, and nothing else is one.
    let mut expected: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    for camera in dataset.scene.cameras.iter().filter(|camera| camera.name.as_str() != HELD_OUT) {
        for frame in Profile::Tiny.frames() {
            let colours = Display::new(1.0).picture(&dataset.frame(&camera.name, frame));
            let file = format!("data/yard/frames/{}/{frame:04}.png", camera.name);
            expected.insert(file, encode_colour(&colours));
        }
    }
    let others = ["README.md", "SHA256SUMS", "data/yard/capture.json", "method.json", "sentences/yard.jsonl"];
    let named: BTreeSet<&str> = expected.keys().map(String::as_str).chain(others).collect();
    assert_eq!(handed_out.keys().map(String::as_str).collect::<BTreeSet<_>>(), named);
    expected.iter().for_each(|(file, bytes)| assert!(handed_out[file] == *bytes, "{file}"));

    let asked = dir.lines(&format!("{RELEASE}/participants/sentences/yard.jsonl"));
    let ids: Vec<&str> = asked.iter().map(|asked| asked["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["yard/001", "yard/002", "yard/501"]);
    assert_eq!(asked[1], json!({ "id": "yard/002", "text": "The blue thing" }));
}

#[test]
fn what_is_kept_is_whole_and_scores_what_comes_back() {
    let (dir, _, _) = released();
    dir.succeed(format!("release --check {RELEASE}"));
    assert!(dir.read(&format!("{RELEASE}/organiser/README.md")).contains("split: private"));
    assert!(dir.read(&format!("{RELEASE}/participants/README.md")).contains("split: test"));
    dir.succeed(format!("{MAKE} --profile tiny")).says(0, &["nothing was written"]);
    unpack_below(&dir, &format!("{RELEASE}/organiser"));
    assert_eq!(dir.tree("elsewhere/benchmark"), dir.tree("benchmark"));

    // Masks in the form of a participant: the card that was handed out, and here the right pixels.
    let card = dir.value(&format!("{RELEASE}/participants/method.json"));
    dir.succeed("baseline oracle --bench elsewhere/benchmark --profile tiny");
    dir.rename("results/oracle", "results/my-method");
    dir.write("results/my-method/method.json", card.to_string());
    dir.succeed("check-results results/my-method --bench elsewhere/benchmark --profile tiny");
    let scored = dir.json("score results --bench elsewhere/benchmark --profile tiny");
    assert_eq!(scored["methods"][0]["miou"], 100.0, "{scored}");

    let sums = format!("{RELEASE}/participants/SHA256SUMS");
    dir.write(&sums, dir.read(&sums).replace("sentences/", "sentence/"));
    let found = dir.run(format!("release --check {RELEASE} --json"));
    found.says(1, &["L4D612", "L4D613"]);
}

#[test]
fn a_board_that_is_published_names_no_answer() {
    let (dir, _) = private();
    dir.succeed("baseline oracle --profile tiny");
    dir.succeed("score results --profile tiny");
    dir.refuses("leaderboard --profile tiny --html", &["private", "--with-answers"]);
    dir.succeed("leaderboard --profile tiny --with-answers --html");
    assert!(dir.path("leaderboard/index.html").exists() && dir.path("leaderboard/board.json").exists());
    dir.succeed("leaderboard --profile tiny").says(0, &["the set is private"]);
    for (file, bytes) in dir.tree("leaderboard") {
        assert!(!["index.html", "board.json", "taken.csv"].contains(&file.as_str()), "{file}");
        let text = String::from_utf8_lossy(&bytes);
        let named = ["ball_red", "box_blue", "referents"].into_iter().find(|word| text.contains(word));
        assert!(named.is_none() || file == ".l4d-written", "{file} names {named:?}");
    }
}

#[test]
fn participants_train_on_what_they_get() {
    let (dir, _, _) = released();
    let data = format!("{RELEASE}/participants/data");
    let few = "--gaussians 300 --coarse 5 --unfold 1 --fine 5";
    let trained = dir.json(format!("train-splats yard --profile real --data {data} {few}"));
    assert_eq!(
        (&trained["track"], &trained["report"]["test"]),
        (&json!("colour"), &Value::Null),
        "{trained}"
    );
    dir.succeed(format!("render-splats yard --profile real --data {data} --frames 0,48"));
}

#[test]
fn the_verbs_go_on_with_what_was_downloaded() {
    let (dir, _, _) = released();
    let handed_out = dir.run(format!("download {RELEASE}/participants"));
    handed_out.says(2, &["lists no release.json", "organiser/"]);
    dir.succeed(format!("download {RELEASE} --bench there/benchmark --data there/data --work there/work"));
    // Digests, checksums, tracks and truth of the scene hold for the frames that were made from the shards.
    let at = "--profile tiny --bench there/benchmark --data there/data";
    let checked = |at: &str| dir.run(format!("check-scenes {at} --json")).value();
    let (built, downloaded) = (checked("--profile tiny"), checked(at));
    assert_eq!(downloaded["findings"].as_array().unwrap().len(), built["findings"].as_array().unwrap().len());
    assert_eq!(downloaded["scenes"], built["scenes"]);
    dir.succeed("baseline oracle --profile tiny --bench there/benchmark");
    dir.succeed("score results --profile tiny --bench there/benchmark");
}

#[test]
fn what_participants_get_is_a_capture() {
    let (dir, _, _) = released();
    let data = format!("{RELEASE}/participants/data");
    dir.succeed(format!("export yard --profile real --data {data} --format nerfstudio --out exported"));
    let exported = dir.tree("exported");
    let of_camera =
        |name: &str| exported.keys().filter(|file| file.ends_with(&format!("{name}.png"))).count();
    assert_eq!((of_camera("cam01"), of_camera(HELD_OUT)), (9, 0));
    assert!(dir.read("exported/l4d-export.json").contains(HELD_OUT), "its place is missing");
}

#[test]
fn without_pictures_there_is_no_private_release() {
    let (dir, _) = private();
    let refused = |more: &str| {
        dir.run(format!("{MAKE} {more}")).says(1, &["L4D606", "hint:"]);
        assert!(!dir.path("release").exists(), "nothing may be written");
    };
    refused("");
    refused("--profile small");
}
