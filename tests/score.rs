//! `l4d baseline` and `l4d score`, from files to files.

use std::path::PathBuf;
use std::process::Command;

use l4d_data::{Benchmark, Profile, Report};
use l4d_masks::{Mask, png};
use l4d_score::averages::Breakdown;
use l4d_score::score::tallies_of_counts;
use l4d_score::{Exam, Options, QuerySet, Summary};
use serde_json::Value;

use crate::support::{Dir, Noise, QUERIES, Run, SCENES, blender_python};

const TINY: [&str; 2] = ["--profile", "tiny"];
const HEADLINE: [&str; 6] = ["miou", "macc", "acc25", "acc50", "tube_iou", "select"];

fn scored_baselines() -> (Dir, Value) {
    let dir = Dir::with_benchmark();
    dir.succeed(&[&["baseline"], &TINY[..]].concat());
    let scores = dir.json(&[&["score"], &TINY[..]].concat());
    (dir, scores)
}

fn method<'a>(scores: &'a Value, name: &str) -> &'a Value {
    scores["methods"].as_array().unwrap().iter().find(|method| method["name"] == name).unwrap()
}

#[test]
fn baselines_bracket_the_scale() {
    let (_dir, scores) = scored_baselines();
    let oracle = method(&scores, "oracle");
    let none = method(&scores, "none");
    for column in HEADLINE {
        for table in tables(oracle) {
            assert_eq!(table[column], 100.0, "oracle, {column}: {table}");
        }
        for table in tables(none) {
            assert_eq!(table[column], 0.0, "none, {column}: {table}");
        }
    }
    assert_eq!(oracle["false_positive_rate"], 0.0);
    assert_eq!(none["false_positive_rate"], 0.0);
    assert_eq!(oracle["queries"], 8, "the rejected query of each scene is not scored");

    let all = method(&scores, "all");
    assert_eq!((&all["macc"], &all["false_positive_rate"]), (&100.0.into(), &100.0.into()));
    assert!(all["miou"].as_f64().unwrap() < 20.0);

    // Right about what, blind to when: only tube IoU and false positives can tell it from the oracle.
    let blind = method(&scores, "time-agnostic");
    for column in ["miou", "macc", "acc25", "acc50", "select"] {
        assert_eq!(blind[column], 100.0, "{column}");
    }
    assert!(blind["tube_iou"].as_f64().unwrap() < 100.0);
    assert!(blind["false_positive_rate"].as_f64().unwrap() > 0.0);

    // Marking all that might be meant is an accuracy of 100 without any understanding.
    let union = method(&scores, "look-alike-union");
    assert_eq!(union["macc"], 100.0);
    assert!(union["miou"].as_f64().unwrap() < 100.0);
}

/// Headline and every breakdown of a method.
fn tables(method: &Value) -> Vec<&Value> {
    let mut tables = vec![method];
    for group in ["categories", "scales", "scenes", "averages"] {
        let members = method[group].as_object().unwrap();
        assert!(!members.is_empty(), "{group}");
        tables.extend(members.values());
    }
    tables
}

#[test]
fn the_json_has_the_documented_shape() {
    let (_dir, scores) = scored_baselines();
    assert_eq!((&scores["protocol"], &scores["profile"]), (&"l4d".into(), &"tiny".into()));
    assert_eq!(scores["findings"], Value::Array(Vec::new()));
    let oracle = method(&scores, "oracle");
    assert_eq!(oracle["partial"], false);
    assert_eq!((&oracle["asked_queries"], &oracle["verified_queries"]), (&8.into(), &2.into()));
    assert_eq!(oracle["rejected_queries"], 2);
    assert_eq!(oracle["categories"]["attribute"]["queries"], 2);
    assert_eq!(oracle["scales"]["room"]["queries"], 4);
    let names: Vec<&str> =
        scores["methods"].as_array().unwrap().iter().map(|m| m["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["all", "look-alike-union", "none", "oracle", "random-look-alike", "time-agnostic"]);
}

#[test]
fn the_table_fits_100_columns() {
    let (dir, _) = scored_baselines();
    let run = dir.succeed(&[&["score"], &TINY[..]].concat());
    assert!(run.stdout.contains("mIoU") && run.stdout.contains("2 of 8 scored prompts are verified"));
    assert!(run.stdout.contains("Left out: 2 prompts that people rejected."), "{}", run.stdout);
    let oracle = run.stdout.lines().find(|line| line.starts_with("oracle")).unwrap();
    assert_eq!(oracle.matches("100.00").count(), 6, "{oracle}");
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{}", run.stdout);
}

#[test]
fn scores_follow_from_counts_alone() {
    let (dir, _) = scored_baselines();
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let exam = Exam::open(bench, Profile::Tiny, QuerySet::Queries, &[], &mut Report::default()).unwrap();
    for name in ["oracle", "random-look-alike", "all", "none", "time-agnostic", "look-alike-union"] {
        let counts = l4d_score::counts::read(&dir.path(format!("scores/{name}/counts.csv"))).unwrap();
        assert_eq!(counts.len(), 8 * 9, "{name}");
        let tallies = tallies_of_counts(&counts, &exam, &Options::default());
        let summary = Summary::read(&dir.path(format!("scores/{name}/summary.json"))).unwrap();
        assert_eq!(Breakdown::of(&tallies), summary.scores, "{name}");
    }
}

#[test]
fn one_method_and_a_selection_of_scenes_can_be_scored() {
    let (dir, _) = scored_baselines();
    let scores = dir.json(&["score", "results/oracle", "--profile", "tiny", "--scenes", "room_discs"]);
    assert_eq!(scores["methods"].as_array().unwrap().len(), 1);
    assert_eq!(method(&scores, "oracle")["queries"], 4);
    assert_eq!(scores["scenes"], serde_json::json!(["room_discs"]));
    let verified = dir.json(&["score", "results/oracle", "--profile", "tiny", "--verified-only"]);
    assert_eq!(method(&verified, "oracle")["queries"], 2);
}

#[test]
fn baselines_are_reproducible_resumable_and_never_replace_others() {
    let (dir, _) = scored_baselines();
    let random = "results/random-look-alike/masks/room_discs/001.json";
    let before = dir.read(random);
    let again = dir.succeed(&["baseline", "random-look-alike", "--profile", "tiny"]);
    assert!(again.stderr.contains("0 files written"), "{}", again.stderr);

    // A killed run: some masks and no card. The next run finishes it, alone or with other scenes.
    std::fs::remove_file(dir.path(random)).unwrap();
    std::fs::remove_file(dir.path("results/random-look-alike/method.json")).unwrap();
    dir.succeed(&["baseline", "random-look-alike", "--profile", "tiny", "--scenes", "room_discs"]);
    assert_eq!(dir.read(random), before);

    let mut differs = false;
    for seed in ["1", "2", "3", "4"] {
        let refused = dir.run(&["baseline", "random-look-alike", "--profile", "tiny", "--seed", seed]);
        if refused.code == 2 {
            assert!(refused.stderr.contains("--force"), "{}", refused.stderr);
            assert_eq!(dir.read(random), before);
            dir.succeed(&["baseline", "random-look-alike", "--profile", "tiny", "--seed", seed, "--force"]);
            differs = true;
            break;
        }
    }
    assert!(differs, "four other seeds chose the same");
}

#[test]
fn missing_answers_follow_the_policy() {
    let (dir, _) = scored_baselines();
    std::fs::remove_file(dir.path("results/oracle/masks/room_discs/001.json")).unwrap();
    let before = dir.read("scores/oracle/counts.csv");
    let refused = dir.run(&["score", "results/oracle", "--profile", "tiny"]);
    assert_eq!(refused.code, 1);
    assert!(
        refused.stdout.contains("L4D308") && refused.stdout.contains("9 of 9 frames"),
        "{}",
        refused.stdout
    );
    assert_eq!(dir.read("scores/oracle/counts.csv"), before, "scores of refused results were replaced");

    let zero = dir.json(&["score", "results/oracle", "--profile", "tiny", "--missing", "zero"]);
    let oracle = method(&zero, "oracle");
    assert_eq!((&oracle["miou"], &oracle["partial"]), (&87.5.into(), &false.into()));
    assert_eq!(oracle["missing_frames"], 9);

    let skip = dir.json(&["score", "results/oracle", "--profile", "tiny", "--missing", "skip"]);
    let oracle = method(&skip, "oracle");
    assert_eq!(
        (&oracle["miou"], &oracle["partial"], &oracle["queries"]),
        (&100.0.into(), &true.into(), &7.into())
    );
    assert_eq!(oracle["never_present"], serde_json::json!(["room_discs/001"]));
}

#[test]
fn larger_masks_are_resized_only_when_asked() {
    let (dir, _) = scored_baselines();
    for (scene, _) in SCENES {
        for number in QUERIES {
            double(&dir, &format!("results/oracle/masks/{scene}/{number}.json"));
        }
    }
    let refused = dir.run(&["score", "results/oracle", "--profile", "tiny"]);
    assert_eq!(refused.code, 1);
    assert!(refused.stdout.contains("L4D309") && refused.stdout.contains("--resize"), "{}", refused.stdout);
    let scores = dir.json(&["score", "results/oracle", "--profile", "tiny", "--resize"]);
    assert_eq!(method(&scores, "oracle")["miou"], 100.0, "halving doubled masks gives them back");
}

/// Doubles the size of all masks of a file.
fn double(dir: &Dir, path: &str) {
    let mut file: Value = serde_json::from_str(&dir.read(path)).unwrap();
    file["size"] = serde_json::json!([192, 256]);
    for counts in file["frames"].as_object_mut().unwrap().values_mut() {
        if let Some(text) = counts.as_str() {
            *counts = Mask::decode(text, 128, 96).unwrap().resized_nearest(256, 192).to_rle().counts().into();
        }
    }
    dir.write(path, file.to_string());
}

#[test]
fn a_query_whose_target_is_never_seen_is_a_finding_and_no_number() {
    let dir = Dir::with_benchmark();
    let truth = "benchmark/truth/tiny/room_discs.json";
    let mut file: Value = serde_json::from_str(&dir.read(truth)).unwrap();
    file["instances"][1]["masks"] = serde_json::json!({});
    dir.write(truth, file.to_string());
    dir.succeed(&["baseline", "oracle", "--profile", "tiny"]);
    let scores = dir.json(&["score", "--profile", "tiny"]);
    assert_eq!(scores["findings"][0]["code"], "L4D401");
    let oracle = method(&scores, "oracle");
    assert_eq!((&oracle["queries"], &oracle["miou"]), (&7.into(), &100.0.into()));
    assert_eq!(oracle["categories"]["action"]["queries"], 1);
}

/// Noise and shifted truth, as RLE and as PNG of every accepted kind, with frames left out.
fn write_random_results(dir: &Dir, seed: u64) {
    let mut noise = Noise::new(seed);
    dir.succeed(&["baseline", "look-alike-union", "--profile", "tiny", "--results", "made"]);
    dir.write("results/noisy/method.json", dir.read("made/look-alike-union/method.json"));
    dir.edit("results/noisy/method.json", "\"look-alike-union\"", "\"noisy\"");
    for (scene, _) in SCENES {
        for number in QUERIES {
            let as_png = noise.below(2) == 0;
            let mut frames = serde_json::Map::new();
            for frame in Profile::Tiny.frames() {
                let mask = random_mask(&mut noise);
                match noise.below(8) {
                    0 => {}
                    _ if as_png => {
                        let path = format!("results/noisy/masks/{scene}/{number}/{frame:04}.png");
                        dir.write(&path, png::encode(&mask));
                    }
                    1 => drop(frames.insert(format!("{frame:04}"), Value::Null)),
                    _ => drop(frames.insert(format!("{frame:04}"), mask.to_rle().counts().into())),
                }
            }
            if !as_png {
                let file = serde_json::json!({ "size": [96, 128], "frames": frames });
                dir.write(&format!("results/noisy/masks/{scene}/{number}.json"), file.to_string());
            }
        }
    }
}

fn random_mask(noise: &mut Noise) -> Mask {
    let density = noise.below(100);
    let (x, y, radius) = (noise.below(128) as i32, noise.below(96) as i32, noise.below(50) as i32);
    Mask::from_fn(128, 96, |col, row| {
        let (dx, dy) = (col as i32 - x, row as i32 - y);
        dx * dx + dy * dy < radius * radius && noise.below(100) >= density
    })
}

#[test]
fn an_independent_numpy_evaluator_agrees_to_the_last_pixel() {
    let python = blender_python();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benchmark/perf/reference_score.py");
    let dir = Dir::with_benchmark();
    let mut states = std::collections::BTreeSet::new();
    for seed in [1, 2, 3] {
        write_random_results(&dir, seed);
        let scores = dir.json(&["score", "results/noisy", "--profile", "tiny", "--missing", "zero"]);
        let reference = |extra: &[&str]| {
            let mut command = Command::new(&python);
            command.arg(&script).args(["results/noisy", "--profile", "tiny"]).args(extra);
            let run: Run = command.current_dir(dir.path("")).output().unwrap().into();
            assert_eq!(run.code, 0, "{}", run.stderr);
            run.stdout
        };
        let counts = dir.read("scores/noisy/counts.csv");
        assert_eq!(counts, reference(&[]), "seed {seed}");
        states.extend(counts.lines().skip(1).map(|row| row.split(',').nth(3).unwrap().to_owned()));
        let summary: Value = serde_json::from_str(&reference(&["--summary"])).unwrap();
        agree(method(&scores, "noisy"), &summary);
        std::fs::remove_dir_all(dir.path("results")).unwrap();
    }
    assert_eq!(states.len(), 5, "the noise must reach every state: {states:?}");
}

/// Every number of the reference is in our scores, equal but for the order of sums.
fn agree(ours: &Value, reference: &Value) {
    for (key, expected) in reference.as_object().unwrap() {
        match expected.as_f64() {
            Some(expected) => {
                let found = ours[key].as_f64().unwrap();
                assert!((found - expected).abs() < 1e-9, "{key}: {found} is not {expected}");
            }
            None => agree(&ours[key], expected),
        }
    }
}
