//! `l4d check-queries` and `l4d stats` on the shipped benchmark, and on copies of one scene with one thing wrong.

use l4d_data::query::text_digest;
use serde_json::{Value, json};

use crate::support::{Dir, root};

const SCENE: &str = "tabletop_mouse_cups";

/// A folder with a benchmark of one shipped scene.
fn one_scene() -> Dir {
    let dir = Dir::new();
    let shipped = root().join("benchmark");
    let copy = |relative: &str| {
        dir.write(relative, std::fs::read(shipped.parent().unwrap().join(relative)).unwrap());
    };
    for file in ["scenes/{}.json", "queries/{}.jsonl", "queries/{}.absent.jsonl", "truth/tiny/{}.json"] {
        copy(&format!("benchmark/{}", file.replace("{}", SCENE)));
    }
    copy("benchmark/vocabulary.txt");
    let manifest =
        format!("name = \"One\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = [\"{SCENE}\"]\n");
    dir.write("benchmark/panoptic-l4d.toml", manifest);
    dir
}

fn check(dir: &Dir) -> Value {
    dir.json(&["check-queries", "--profile", "tiny"])
}

fn codes(document: &Value) -> Vec<&str> {
    let findings = document["findings"].as_array().unwrap().iter();
    findings.map(|finding| finding["code"].as_str().unwrap()).collect()
}

fn queries_file() -> String {
    format!("benchmark/queries/{SCENE}.jsonl")
}

/// Changes a query in place and writes the digest that belongs to it.
fn edit_query(dir: &Dir, number: &str, edit: impl Fn(&mut Value)) {
    let file = queries_file();
    let lines: Vec<String> = dir
        .read(&file)
        .lines()
        .map(|line| {
            let mut query: Value = serde_json::from_str(line).unwrap();
            if query["id"] == format!("{SCENE}/{number}") {
                edit(&mut query);
                query["text_digest"] =
                    text_digest(query["text"].as_str().unwrap(), Some(&query["predicate"])).into();
            }
            query.to_string()
        })
        .collect();
    dir.write(&file, lines.join("\n"));
}

/// The number of the first query whose text form has this in it.
fn number_of(dir: &Dir, what: &str) -> String {
    let text = dir.read(&queries_file());
    let line = text.lines().find(|line| line.contains(what)).unwrap();
    let query: Value = serde_json::from_str(line).unwrap();
    query["id"].as_str().unwrap().rsplit('/').next().unwrap().to_owned()
}

#[test]
fn the_shipped_set_is_sound() {
    let dir = Dir::new();
    let bench = root().join("benchmark");
    let document = dir.json(&["check-queries", "--bench", bench.to_str().unwrap()]);
    assert_eq!(document["findings"], json!([]));
    assert_eq!(document["scenes"], 21);
    assert_eq!(document["scales"], json!({"outdoor": 8, "room": 6, "tabletop": 7}));
    assert_eq!(document["instances"], 108);
    let counts = json!({"attribute": 100, "action": 61, "spatial": 72, "interaction": 56});
    assert_eq!(document["queries"], counts);
    let composites = document["composites"].as_object().unwrap();
    assert_eq!(composites.len(), 5);
    assert!(composites.values().all(|count| count.as_u64().unwrap() >= 10), "{composites:?}");
    for probe in document["probes"].as_array().unwrap() {
        let difference = probe["difference"].as_f64().unwrap();
        assert!(probe["bounded"] == false || difference <= 10.0, "{probe}");
    }
}

#[test]
fn the_shipped_dev_set_is_sound_and_owes_no_totals() {
    let dir = Dir::new();
    let bench = root().join("benchmark/dev");
    let document = dir.json(&["check-queries", "--bench", bench.to_str().unwrap()]);
    assert_eq!(document["findings"], json!([]));
    assert_eq!(document["scales"], json!({"outdoor": 2, "room": 2, "tabletop": 2}));
    let queries = document["queries"].as_object().unwrap();
    assert!(queries.values().all(|count| count.as_u64().unwrap() >= 15), "{queries:?}");
}

#[test]
fn a_sound_scene_has_no_finding_and_says_so() {
    let dir = one_scene();
    assert_eq!(check(&dir)["findings"], json!([]));
    let run = dir.succeed(&["check-queries", "--profile", "tiny"]);
    for part in ["objects", "composites", "nearest landmark", "(no bound)"] {
        assert!(run.stdout.contains(part), "{part} is missing in\n{}", run.stdout);
    }
}

#[test]
fn each_wrong_query_has_its_finding() {
    type Edit = fn(&mut Value);
    let cases: [(&str, &str, Edit); 12] = [
        ("L4D202", "\"slide\"", |query| query["referents"] = json!(["hand_left"])),
        ("L4D203", "\"slide\"", |query| query["predicate"][1] = json!({"does": {"verb": "teleport"}})),
        ("L4D203", "farthest_from", |query| {
            query["predicate"][1] = json!({"relation": {"kind": "left_of", "of": [{"name": "lamp"}]}});
        }),
        ("L4D203", "farthest_from", |query| {
            query["predicate"][1] = json!({"relation": {"kind": "beside", "of": [{"name": "cup_on_book"}]}});
        }),
        ("L4D204", "\"tea\"", |query| query["predicate"][1]["attribute"]["value"] = "coffee".into()),
        ("L4D206", "\"while\"", |query| query["frames"][0][0] = 0.into()),
        ("L4D206", "\"while\"", |query| query["frames"] = json!([[20, 31]])),
        ("L4D207", "\"tea\"", |query| query["categories"] = json!(["spatial"])),
        ("L4D212", "\"tea\"", |query| {
            query["predicate"][1] = json!({"attribute": {"key": "colour", "value": "blue"}});
        }),
        ("L4D214", "\"tea\"", |query| query["text"] = "The cup that holds tee, not coffee".into()),
        ("L4D215", "\"tea\"", |query| query["text"] = "The cup while it holds tea".into()),
        ("L4D216", "\"tea\"", |query| query["text"] = "The cup to the left of the book".into()),
    ];
    for (code, what, edit) in cases {
        let dir = one_scene();
        let number = number_of(&dir, what);
        edit_query(&dir, &number, edit);
        let document = check(&dir);
        assert!(codes(&document).contains(&code), "{code}: {}", document["findings"]);
        assert_eq!(dir.run(&["check-queries", "--profile", "tiny"]).code, 1, "{code}");
    }
}

#[test]
fn wrong_files_and_scenes_have_their_findings() {
    type Spoil = fn(&Dir);
    let cases: [(&str, Spoil); 6] = [
        // The same id twice, and the same sentence under another id.
        ("L4D201", |dir| {
            let text = dir.read(&queries_file());
            let first = text.lines().next().unwrap().to_owned();
            dir.write(&queries_file(), format!("{text}{first}\n"));
        }),
        ("L4D209", |dir| {
            let text = dir.read(&queries_file());
            let kept: Vec<&str> = text.lines().filter(|line| !line.contains("\"cup_on_book\"]")).collect();
            dir.write(&queries_file(), kept.join("\n"));
        }),
        // An event that nothing animates: the cup on the book never moves.
        ("L4D223", |dir| {
            add_event(
                dir,
                json!({"subject": "cup_on_book", "verb": "jiggle", "object": null, "frames": [10, 40]}),
            );
        }),
        ("L4D220", |dir| {
            add_event(
                dir,
                json!({"subject": "hand_left", "verb": "hold", "object": "cup_by_keyboard", "frames": [0, 30]}),
            );
        }),
        // Shorter than any profile can be sure to see.
        ("L4D201", |dir| {
            add_event(
                dir,
                json!({"subject": "hand_left", "verb": "wave", "object": null, "frames": [10, 20]}),
            );
        }),
        ("L4D210", |dir| {
            let file = format!("benchmark/truth/tiny/{SCENE}.json");
            let mut truth: Value = serde_json::from_str(&dir.read(&file)).unwrap();
            for instance in truth["instances"].as_array_mut().unwrap() {
                if instance["name"] == "cup_on_book" {
                    instance["masks"] = json!({});
                }
            }
            dir.write(&file, truth.to_string());
        }),
    ];
    for (code, spoil) in cases {
        let dir = one_scene();
        spoil(&dir);
        let document = check(&dir);
        assert!(codes(&document).contains(&code), "{code}: {}", document["findings"]);
    }
}

fn add_event(dir: &Dir, event: Value) {
    let file = format!("benchmark/scenes/{SCENE}.json");
    let mut tracks: Value = serde_json::from_str(&dir.read(&file)).unwrap();
    tracks["events"].as_array_mut().unwrap().push(event);
    dir.write(&file, tracks.to_string());
}

#[test]
fn stats_write_tables_and_figures_of_the_same_bytes_each_time() {
    let dir = one_scene();
    let document = dir.json(&["stats", "--profile", "tiny", "-o", "stats"]);
    let files =
        ["datasets.csv", "scenes.csv", "queries.csv", "words.csv", "figures/words.svg", "figures/motion.png"];
    let read = || files.map(|file| std::fs::read(dir.path(format!("stats/{file}"))).unwrap());
    let first = read();
    let run = dir.succeed(&["stats", "--profile", "tiny", "-o", "stats"]);
    assert_eq!(read(), first);
    assert!(run.stdout.contains("ambiguous") && run.stdout.contains("box diagonal"), "{}", run.stdout);
    let queries = document["queries"].as_array().unwrap();
    assert_eq!(document["datasets"].as_array().unwrap().last().unwrap()["prompts"], queries.len());
    assert_eq!(dir.read("stats/queries.csv").lines().count(), queries.len() + 1);
    // Every referent of this scene is in plain sight.
    assert!(queries.iter().all(|query| query["pixels"].as_f64().unwrap() > 10.0));
}
