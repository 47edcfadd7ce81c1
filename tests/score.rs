//! `l4d baseline` and `l4d score`, from files to files.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use l4d_data::{Benchmark, Profile, Report};
use l4d_masks::{Mask, png};
use l4d_score::averages::Breakdown;
use l4d_score::score::tallies_of_counts;
use l4d_score::{EvalSet, Options, QuerySet, Summary};
use serde_json::{Map, Value, json};

use crate::support::{Dir, Noise, QUERIES, Run, SCENES, named, root};

const SCORE: &str = "score --profile tiny";
const ORACLE: &str = "score results/oracle --profile tiny";
const RANDOM: &str = "baseline random-look-alike --profile tiny";
const HEADLINE: [&str; 6] = ["miou", "macc", "acc25", "acc50", "tube_iou", "select"];
const BASELINES: [&str; 6] =
    ["all", "look-alike-union", "none", "oracle", "random-look-alike", "time-agnostic"];

/// Baselines and their scores, in files and as JSON.
static SCORED: LazyLock<(Dir, Value)> = LazyLock::new(|| {
    let dir = Dir::with_baselines();
    let scores = dir.json(SCORE);
    (dir, scores)
});

fn method(name: &str) -> &'static Value {
    named(&SCORED.1["methods"], name)
}

/// What a run of `score` says of the oracle.
fn oracle(dir: &Dir, line: &str) -> Value {
    named(&dir.json(line)["methods"], "oracle").clone()
}

#[test]
fn baselines_bracket_the_scale() {
    let [oracle, none] = ["oracle", "none"].map(method);
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

    let all = method("all");
    assert_eq!((&all["macc"], &all["false_positive_rate"]), (&100.0.into(), &100.0.into()));
    assert!(all["miou"].as_f64().unwrap() < 20.0);

    // Right about what, blind to when: only tube IoU and false positives can tell it from the oracle.
    let blind = method("time-agnostic");
    for column in ["miou", "macc", "acc25", "acc50", "select"] {
        assert_eq!(blind[column], 100.0, "{column}");
    }
    assert!(blind["tube_iou"].as_f64().unwrap() < 100.0);
    assert!(blind["false_positive_rate"].as_f64().unwrap() > 0.0);

    // Marking all that might be meant is an accuracy of 100 without any understanding.
    let union = method("look-alike-union");
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
    let (_, scores) = &*SCORED;
    assert_eq!((&scores["protocol"], &scores["profile"]), (&"l4d".into(), &"tiny".into()));
    assert_eq!(scores["findings"], json!([]));
    let oracle = method("oracle");
    assert_eq!(oracle["partial"], false);
    let counts = ["asked_queries", "verified_queries", "rejected_queries"].map(|count| &oracle[count]);
    assert_eq!(counts, [8, 2, 2]);
    assert_eq!(oracle["categories"]["attribute"]["queries"], 2);
    assert_eq!(oracle["scales"]["room"]["queries"], 4);
    let names = scores["methods"].as_array().unwrap().iter().map(|method| &method["name"]);
    assert!(names.eq(BASELINES));
}

#[test]
fn the_table_fits_100_columns() {
    let run = SCORED.0.copy().succeed(SCORE);
    let rejected = "Left out: 2 prompts that people rejected.";
    run.says(0, &["mIoU", "2 of 8 scored prompts are verified", rejected]);
    let oracle = run.stdout.lines().find(|line| line.starts_with("oracle")).unwrap();
    assert_eq!(oracle.matches("100.00").count(), 6, "{oracle}");
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 100), "{run}");
}

#[test]
fn scores_follow_from_counts_alone() {
    let (dir, _) = &*SCORED;
    let bench = Benchmark::open(dir.path("benchmark")).unwrap();
    let eval_set =
        EvalSet::open(bench, Profile::Tiny, QuerySet::Queries, &[], &mut Report::default()).unwrap();
    for name in BASELINES {
        let counts = l4d_score::counts::read(&dir.path(format!("scores/{name}/counts.csv"))).unwrap();
        assert_eq!(counts.len(), 8 * 9, "{name}");
        let tallies = tallies_of_counts(&counts, &eval_set, &Options::default());
        let summary = Summary::read(&dir.path(format!("scores/{name}/summary.json"))).unwrap();
        assert_eq!(Breakdown::of(&tallies), summary.scores, "{name}");
    }
}

#[test]
fn one_method_and_a_selection_of_scenes_can_be_scored() {
    let dir = Dir::with_oracle();
    let scores = dir.json(format!("{ORACLE} --scenes room_discs"));
    assert_eq!(scores["methods"].as_array().unwrap().len(), 1);
    assert_eq!(scores["methods"][0]["queries"], 4);
    assert_eq!(scores["scenes"], json!(["room_discs"]));
    assert_eq!(oracle(&dir, &format!("{ORACLE} --verified-only"))["queries"], 2);
}

#[test]
fn baselines_are_reproducible_resumable_and_never_replace_others() {
    let dir = Dir::with_baselines();
    let random = "results/random-look-alike/masks/room_discs/001.json";
    let before = dir.read(random);
    dir.run(RANDOM).says(0, &["0 files written"]);

    // A killed run: some masks and no card. The next run finishes it, alone or with other scenes.
    dir.remove(random);
    dir.remove("results/random-look-alike/method.json");
    dir.succeed(format!("{RANDOM} --scenes room_discs"));
    assert_eq!(dir.read(random), before);

    let is_refused = |seed: &u32| dir.run(format!("{RANDOM} --seed {seed}")).code == 2;
    let seed = (1..5).find(is_refused).expect("four other seeds chose the same");
    dir.run(format!("{RANDOM} --seed {seed}")).says(2, &["--force"]);
    assert_eq!(dir.read(random), before);
    dir.succeed(format!("{RANDOM} --seed {seed} --force"));
}

#[test]
fn missing_answers_follow_the_policy() {
    let dir = SCORED.0.copy();
    dir.remove("results/oracle/masks/room_discs/001.json");
    let before = dir.read("scores/oracle/counts.csv");
    dir.run(ORACLE).says(1, &["L4D308", "9 of 9 frames"]);
    assert_eq!(dir.read("scores/oracle/counts.csv"), before, "scores of refused results were replaced");

    let zero = oracle(&dir, &format!("{ORACLE} --missing zero"));
    assert_eq!((&zero["miou"], &zero["partial"]), (&87.5.into(), &false.into()));
    assert_eq!(zero["missing_frames"], 9);
    let skip = oracle(&dir, &format!("{ORACLE} --missing skip"));
    assert_eq!((&skip["miou"], &skip["partial"]), (&100.0.into(), &true.into()));
    assert_eq!((&skip["queries"], &skip["never_present"]), (&7.into(), &json!(["room_discs/001"])));
}

#[test]
fn larger_masks_are_resized_only_when_asked() {
    let dir = Dir::with_oracle();
    for (scene, _) in SCENES {
        for number in QUERIES {
            dir.change(&format!("results/oracle/masks/{scene}/{number}.json"), double);
        }
    }
    dir.run(ORACLE).says(1, &["L4D309", "--resize"]);
    let resized = oracle(&dir, &format!("{ORACLE} --resize"));
    assert_eq!(resized["miou"], 100.0, "halving doubled masks gives them back");
}

/// Doubles the size of all masks of a file.
fn double(file: &mut Value) {
    file["size"] = json!([192, 256]);
    for counts in file["frames"].as_object_mut().unwrap().values_mut() {
        if let Some(text) = counts.as_str() {
            *counts = Mask::decode(text, 128, 96).unwrap().resized_nearest(256, 192).to_rle().counts().into();
        }
    }
}

#[test]
fn a_query_whose_target_is_never_seen_is_a_finding_and_no_number() {
    let dir = Dir::with_benchmark();
    dir.change("benchmark/truth/tiny/room_discs.json", |truth| truth["instances"][1]["masks"] = json!({}));
    dir.succeed("baseline oracle --profile tiny");
    let scores = dir.json(SCORE);
    assert_eq!(scores["findings"][0]["code"], "L4D401");
    let oracle = named(&scores["methods"], "oracle");
    assert_eq!((&oracle["queries"], &oracle["miou"]), (&7.into(), &100.0.into()));
    assert_eq!(oracle["categories"]["action"]["queries"], 1);
}

/// Noise and shifted truth, as RLE and as PNG of every accepted kind, with frames left out.
fn write_random_results(dir: &Dir, seed: u64) {
    let mut noise = Noise::new(seed);
    for (scene, _) in SCENES {
        for number in QUERIES {
            let as_png = noise.below(2) == 0;
            let mut frames = Map::new();
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
                let file = json!({ "size": [96, 128], "frames": frames });
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

/// An evaluator of its own in numpy; the environment of Blender has that.
pub(crate) fn compare_with_numpy(python: &Path) {
    let mut states = BTreeSet::new();
    for seed in [1, 2, 3] {
        let dir = Dir::with_baselines();
        dir.contestant("look-alike-union", "noisy");
        dir.remove("results/noisy/masks");
        write_random_results(&dir, seed);
        let scores = dir.json("score results/noisy --profile tiny --missing zero");
        let reference = |extra: &[&str]| {
            let mut command = Command::new(python);
            command.arg(root().join("perf/reference_score.py"));
            command.args(["results/noisy", "--profile", "tiny"]).args(extra).current_dir(dir.path(""));
            let run = Run::from(command.output().unwrap());
            run.says(0, &[]);
            run.stdout
        };
        let counts = dir.read("scores/noisy/counts.csv");
        assert_eq!(counts, reference(&[]), "seed {seed}");
        states.extend(counts.lines().skip(1).map(|row| row.split(',').nth(3).unwrap().to_owned()));
        let summary: Value = serde_json::from_str(&reference(&["--summary"])).unwrap();
        agree(named(&scores["methods"], "noisy"), &summary);
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
