//! `l4d check-queries` and `l4d stats` on the shipped benchmark, and on copies of one scene with one thing wrong.

use l4d_data::query::text_digest;
use serde_json::{Value, json};

use crate::support::{Dir, codes, root, shipped};

const SCENE: &str = "tabletop_mouse_cups";
const QUERIES: &str = "benchmark/queries/tabletop_mouse_cups.jsonl";
const CHECK: &str = "check-queries --profile tiny";

/// A folder with a benchmark of one shipped scene.
fn one_scene() -> Dir {
    let files = ["scenes/{}.json", "queries/{}.jsonl", "queries/{}.absent.jsonl", "truth/tiny/{}.json"];
    Dir::with_shipped("One", &[SCENE], &files)
}

/// Changes the first query whose line has this in it, and writes the digest that belongs to it.
fn edit_query(dir: &Dir, what: &str, edit: impl Fn(&mut Value)) {
    let mut queries = dir.lines(QUERIES);
    let place = dir.read(QUERIES).lines().position(|line| line.contains(what)).unwrap();
    let query = &mut queries[place];
    edit(query);
    query["text_digest"] = text_digest(query["text"].as_str().unwrap(), Some(&query["predicate"])).into();
    dir.write(QUERIES, queries.iter().map(|query| format!("{query}\n")).collect::<String>());
}

/// Checks a shipped set.
fn checked(bench: &str) -> Value {
    let document = Dir::new().json(format!("check-queries --bench {}/{bench}", root().display()));
    assert_eq!(document["findings"], json!([]));
    document
}

#[test]
fn the_public_list_says_nothing_of_what_queries_mean() {
    let dir = Dir::new();
    let bench = root().join("benchmark");
    dir.succeed(format!("check-queries --bench {} --public public.jsonl", bench.display()));
    assert_eq!(
        dir.read("public.jsonl"),
        shipped("benchmark/queries.public.jsonl"),
        "write it again with --public"
    );
    let lines = dir.lines("public.jsonl");
    assert_eq!(lines.len(), 289 + 77);
    for line in &lines {
        let keys: Vec<&str> = line.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, ["id", "text", "categories"]);
    }
}

#[test]
fn the_shipped_set_is_sound() {
    let document = checked("benchmark");
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
fn the_shipped_dev_set_is_sound_leaks_nothing_and_has_no_shortcut() {
    let document = checked(&format!("benchmark/dev --against {}/benchmark", root().display()));
    assert_eq!(document["scales"], json!({"outdoor": 4, "room": 4, "tabletop": 4}));
    let queries = document["queries"].as_object().unwrap();
    assert!(queries.values().all(|count| count.as_u64().unwrap() >= 20), "{queries:?}");
    for probe in document["probes"].as_array().unwrap().iter().filter(|probe| probe["bounded"] == true) {
        let differences = probe["categories"].as_object().unwrap().values();
        assert!(differences.clone().all(|points| points.as_f64().unwrap() <= 10.0), "{probe}");
    }
    // Frozen: another draw would be another set.
    let sums = shipped("benchmark/dev/SHA256SUMS");
    for (digest, file) in sums.lines().map(|line| l4d_data::sums::parse_line(line).unwrap()) {
        let bytes = std::fs::read(root().join("benchmark/dev").join(file)).unwrap();
        assert_eq!(l4d_data::digest::sha256_hex(&bytes), digest, "{file}");
    }
}

#[test]
fn a_sound_scene_has_no_finding_and_says_so() {
    let dir = one_scene();
    assert_eq!(dir.json(CHECK)["findings"], json!([]));
    let parts = ["objects", "composites", "nearest landmark", "(no bound)"];
    dir.run(CHECK).says(0, &parts);
}

/// Those that no test of `l4d-query` finds alone.
#[test]
fn wrong_queries_and_files_have_their_findings() {
    type Edit = fn(&mut Value);
    let cases: [(&str, &str, Edit); 5] = [
        ("L4D203", "\"slide\"", |query| query["predicate"][1] = json!({"does": {"verb": "teleport"}})),
        ("L4D206", "\"while\"", |query| query["frames"] = json!([[20, 31]])),
        ("L4D214", "\"tea\"", |query| query["text"] = "The cup that holds tee, not coffee".into()),
        ("L4D215", "\"tea\"", |query| query["text"] = "The cup while it holds tea".into()),
        ("L4D216", "\"tea\"", |query| query["text"] = "The cup to the left of the book".into()),
    ];
    let expect = |dir: &Dir, code: &str| {
        let run = dir.run(format!("{CHECK} --json"));
        assert!(run.code == 1 && codes(&run.value()).contains(&code), "{code}: {run}");
    };
    for (code, what, edit) in cases {
        let dir = one_scene();
        edit_query(&dir, what, edit);
        expect(&dir, code);
    }
    // The same id twice, and the same sentence under another id.
    let dir = one_scene();
    let text = dir.read(QUERIES);
    dir.write(QUERIES, format!("{text}{}\n", text.lines().next().unwrap()));
    expect(&dir, "L4D201");
    let dir = one_scene();
    dir.change(&format!("benchmark/truth/tiny/{SCENE}.json"), |truth| {
        let instances = truth["instances"].as_array_mut().unwrap();
        let cup = instances.iter_mut().find(|instance| instance["name"] == "cup_on_book").unwrap();
        cup["masks"] = json!({});
    });
    expect(&dir, "L4D210");
}

#[test]
fn a_set_that_repeats_another_says_so_and_must_not_if_it_claims_to_be_new() {
    let dir = one_scene();
    let check = format!("{CHECK} --against {}", root().join("benchmark").display());
    let document = dir.json(&check);
    let overlap = &document["overlap"];
    let shared = &overlap["shared"]["queries"];
    assert!(shared["queries"].as_u64().unwrap() >= 10);
    assert_eq!((&shared["sentences"], &shared["predicates"]), (&shared["queries"], &shared["queries"]));
    assert_eq!(overlap["memory"]["all"]["right"].as_f64(), overlap["memory"]["all"]["queries"].as_f64());
    assert_eq!(overlap["places"]["mean_distance_m"], 0.0);
    assert_eq!(document["findings"], json!([]));
    dir.run(&check).says(0, &["memory of the other", "+ points", "0.000 m from it"]);
    dir.write("benchmark/panoptic-l4d.toml", dir.read("benchmark/panoptic-l4d.toml") + "split = \"dev\"\n");
    let run = dir.run(format!("{check} --json"));
    assert!(run.code == 1 && codes(&run.value()) == ["L4D231"], "{run}");
}

#[test]
fn stats_write_tables_and_figures_of_the_same_bytes_each_time() {
    let dir = one_scene();
    let document = dir.json("stats --profile tiny -o stats");
    let files =
        ["datasets.csv", "scenes.csv", "queries.csv", "words.csv", "figures/words.svg", "figures/motion.png"];
    let read = || files.map(|file| dir.bytes(&format!("stats/{file}")));
    let first = read();
    let run = dir.succeed("stats --profile tiny -o stats");
    assert_eq!(read(), first);
    run.says(0, &["ambiguous", "box diagonal"]);
    let queries = document["queries"].as_array().unwrap();
    assert_eq!(document["datasets"].as_array().unwrap().last().unwrap()["prompts"], queries.len());
    assert_eq!(dir.read("stats/queries.csv").lines().count(), queries.len() + 1);
    // Every referent of this scene is in plain sight.
    assert!(queries.iter().all(|query| query["pixels"].as_f64().unwrap() > 10.0));
}

#[test]
fn what_cannot_be_composed_is_refused_before_anything_is_drawn() {
    let dir = Dir::new();
    dir.write("short", "secret");
    dir.write("zeros", [0; 16]);
    dir.write("secret", (0..32).collect::<Vec<u8>>());
    let recipe = |scene: &str, seed: u64| {
        format!(r#"{{"schema":"l4d/composition/1","scene":"{scene}","scale":"room","seed":{seed},"draw":0}}"#)
    };
    dir.write("room_1001.json", recipe("room_1001", 1001));
    dir.write("room_0501.json", recipe("room_0501", 501));
    dir.write(
        "empty.json",
        r#"{"schema":"l4d/scenario/1","name":"room_a","scale":"room","groups":[],"events":[]}"#,
    );
    dir.write("other.json", r#"{"schema":"l4d/scene/1"}"#);
    for (arguments, reasons) in [
        ("--seed 999", vec!["seed 999 belongs to the development set", "1000"]),
        ("--split dev --seed 990 --count 20", vec!["seeds from 1000 on belong to training"]),
        ("--split private", vec!["needs a secret", "--secret"]),
        ("--split private --secret short", vec!["short", "at least 16"]),
        ("--split private --secret zeros", vec!["zeros", "not random"]),
        ("--secret secret", vec!["--split private"]),
        ("--split private --secret secret --spec room_1001.json", vec!["split train, not private"]),
        ("--spec room_0501.json", vec!["split dev, not train"]),
        ("--seed 9007199254740993", vec!["2^53"]),
        ("--seed 18446744073709551615", vec!["2^53"]),
        ("--spec empty.json", vec!["empty.json", "events"]),
        ("--spec other.json", vec!["other.json", "schema"]),
        ("--avoid nowhere", vec!["nowhere"]),
    ] {
        dir.refuses(format!("compose --out set {arguments}"), &reasons);
    }
    dir.run("compose --out set --spec room_1001.json --count 3").says(2, &["--count", "--spec"]);
    assert!(!dir.path("set").exists());
}

/// A copy of the development set, which is a composed one.
fn dev_set() -> Dir {
    let dir = Dir::new();
    let sums = shipped("benchmark/dev/SHA256SUMS");
    let files = sums.lines().map(|line| &line[66..]).chain(["SHA256SUMS", "panoptic-l4d.toml"]);
    for file in files {
        dir.write(&format!("set/{file}"), shipped(&format!("benchmark/dev/{file}")));
    }
    dir
}

/// Scenes that the development set has; no Blender is needed to compose what is there.
const STANDING: &str = "compose --out set --split dev --scale room --seed 506 --count 3 --python nowhere";

#[test]
fn a_composed_set_that_was_changed_is_reported_and_never_digested_anew() {
    let dir = dev_set();
    let said = dir.succeed(STANDING);
    said.says(0, &["nothing was composed: all 3 scenes were there"]);
    assert_eq!(dir.json(STANDING)["composed"], 0);
    // A manifest of its own stays as its owner wrote it.
    let own = dir.read("set/panoptic-l4d.toml").replace("1.0.0", "3.2.1").replace("L4D composed", "of mine");
    dir.write("set/panoptic-l4d.toml", &own);
    dir.succeed(STANDING);
    assert_eq!(dir.read("set/panoptic-l4d.toml"), own);
    let sums = dir.read("set/SHA256SUMS");
    for file in ["queries/room_0506.jsonl", "scenes/room_0507.json", "recipes/room_0508.json"] {
        let path = format!("set/{file}");
        let text = dir.read(&path);
        dir.write(&path, text.clone() + "\n");
        dir.refuses(STANDING, &["not as it was composed", file, "--force"]);
        dir.write(&path, text);
    }
    // A scene that this run does not compose: --force cannot mend it either.
    dir.edit("set/queries/tabletop_0511.jsonl", "{", "{ ");
    for more in ["", " --force"] {
        dir.refuses(format!("{STANDING}{more}"), &["tabletop_0511.jsonl", "compose their scenes again"]);
    }
    assert_eq!(dir.read("set/SHA256SUMS"), sums);
}

#[test]
fn a_complete_scene_that_a_killed_run_left_is_in_the_manifest_after_the_next() {
    let dir = dev_set();
    let whole = dir.read("set/panoptic-l4d.toml");
    dir.edit("set/panoptic-l4d.toml", "\"room_0507\", ", "");
    dir.succeed(STANDING);
    assert_eq!(dir.read("set/panoptic-l4d.toml"), whole);
}

#[test]
fn a_private_set_has_one_secret() {
    let dir = dev_set();
    dir.write("secret", (0..32).collect::<Vec<u8>>());
    dir.write("other", (1..33).collect::<Vec<u8>>());
    dir.edit("set/panoptic-l4d.toml", "\"dev\"", "\"private\"");
    let private = "compose --out set --split private --python nowhere --secret";
    dir.refuses(format!("{private} secret"), &["scenes of a secret of which nothing is known"]);
    // A new set keeps the digest before it has a scene.
    let fresh = private.replace("--out set", "--out fresh");
    dir.refuses(format!("{fresh} secret"), &[]);
    let kept = dir.read("fresh/secret.sha256");
    assert_eq!(kept.trim().len(), 64);
    dir.refuses(format!("{fresh} other"), &["a private set of another secret"]);
    dir.refuses("compose --out fresh --python nowhere", &["a private set", "another --out"]);
    assert_eq!(dir.read("fresh/secret.sha256"), kept);
}
