//! `solve` and `query` as their users run them, on made-up twins: one ball rolls, its twin lies farther back.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use glam::UVec2;
use l4d_data::Profile;
use l4d_data::layout::SceneDir;
use l4d_frames::exr::read_surfaces;
use l4d_masks::{Mask, png};
use serde_json::{Value, json};

use crate::support::{Dir, Run};
use crate::world::{SCENE, write_twins, write_twins_benchmark};

const SOLVE: [&str; 5] = ["solve", "--profile", "tiny", "--data", "data"];
/// One sentence about the scene; the rest of the command line follows.
const QUERY: [&str; 9] =
    ["query", SCENE, "The ball that rolls", "--profile", "tiny", "--data", "data", "--grounder", "oracle"];

/// Another sentence, for the grounder that needs nothing.
fn query<'a>(text: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["query", SCENE, text, "--profile", "tiny", "--data", "data"], more].concat()
}

/// Enough iterations for two balls, so that they have an outline.
const LEARNED: [&str; 8] = ["--gaussians", "2500", "--coarse", "150", "--unfold", "20", "--fine", "400"];

/// A folder with the scene, a model of it and a benchmark about it. The model is learned once for all tests.
pub(crate) fn world() -> Dir {
    static MODEL: OnceLock<Dir> = OnceLock::new();
    let model = MODEL.get_or_init(|| {
        let dir = Dir::new();
        write_twins(&dir.path("data"));
        let train = ["train-splats", SCENE, "--profile", "tiny", "--data", "data"];
        dir.succeed(&[&train[..], &LEARNED].concat());
        dir
    });
    let dir = Dir::new();
    for part in ["data", "work"] {
        copy(&model.path(part), &dir.path(part));
    }
    write_twins_benchmark(&dir.path("benchmark"), &dir.path("data"));
    dir
}

pub(crate) fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

fn solve<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&SOLVE, more].concat()
}

pub(crate) fn refused(run: &Run, parts: &[&str]) {
    assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
    for part in parts {
        assert!(run.stderr.contains(part), "no `{part}` in\n{}", run.stderr);
    }
    assert!(run.stderr.contains("hint:"), "{}", run.stderr);
}

fn score(dir: &Dir, method: &str) -> Value {
    let document = dir.json(&["score", "results", "--profile", "tiny"]);
    let methods = document["methods"].as_array().unwrap();
    methods.iter().find(|found| found["name"] == method).unwrap_or_else(|| panic!("{document}")).clone()
}

/// Masks of an instance as a grounder of files reads them, in some views of a query.
fn write_masks(dir: &Dir, number: &str, instance_of_view: &[(&str, u32)]) {
    let scene = SceneDir::new(&dir.path("data"), SCENE);
    for (view, id) in instance_of_view {
        for frame in Profile::Tiny.frames() {
            let surfaces = read_surfaces(&scene.frame(view, frame), UVec2::new(128, 96)).unwrap();
            let mask = Mask::from_ids(128, 96, &surfaces.id, *id).unwrap();
            dir.write(&format!("made/{SCENE}/{number}/{view}/{frame:04}.png"), png::encode(&mask));
        }
    }
}

fn results(dir: &Dir, method: &str) -> BTreeMap<String, String> {
    let file = |number: &&str| {
        let path = format!("results/{method}/masks/{SCENE}/{number}.json");
        ((*number).to_owned(), dir.read(&path))
    };
    ["001", "002", "003"].iter().map(file).collect()
}

#[test]
fn what_the_training_views_show_becomes_masks_of_the_held_out_one() {
    let dir = world();
    let run = dir.succeed(&solve(&["--grounder", "oracle"]));
    assert!(run.stderr.contains("3 queries: 3 reliable"), "{}", run.stderr);
    let card: Value = serde_json::from_str(&dir.read("results/panopticquery-oracle/method.json")).unwrap();
    assert_eq!(
        (&card["used"]["ground_truth"], &card["used"]["test_view"]),
        (&Value::from(true), &Value::from(false))
    );
    assert_eq!(card["used"]["depth"], true, "train-splats learns from depth by default");
    let scored = score(&dir, "panopticquery-oracle");
    let number = |field: &str| scored[field].as_f64().unwrap();
    assert!(number("miou") > 75.0 && number("macc") > 99.0 && number("select") > 99.0, "{scored}");
    assert!(number("tube_iou") > 75.0, "{scored}");
    // The third sentence holds in the middle of the clip alone, and its answer does too.
    let gated: Value = serde_json::from_str(&results(&dir, "panopticquery-oracle")["003"]).unwrap();
    for (frame, counts) in gated["frames"].as_object().unwrap() {
        let holds = (24..=72).contains(&frame.parse::<u32>().unwrap());
        assert_eq!(counts.is_string(), holds, "frame {frame}");
    }

    // What is answered stays answered, and other settings are not mixed in under the same name.
    let record =
        |dir: &Dir| dir.read(&format!("work/tiny/{SCENE}/answers/panopticquery-oracle/001/manifest.json"));
    let before = record(&dir);
    dir.succeed(&solve(&["--grounder", "oracle"]));
    assert_eq!(record(&dir), before);
    let other = solve(&["--grounder", "oracle", "--views", "3", "--name", "panopticquery-oracle"]);
    refused(&dir.run(&other), &["with other settings", "--overwrite"]);
    dir.succeed(&[&other[..], &["--overwrite"]].concat());
    assert_ne!(record(&dir), before);
}

#[test]
fn a_view_that_means_the_twin_is_outvoted() {
    let dir = world();
    let views = [("cam00", 1), ("cam01", 2), ("cam02", 1), ("cam03", 1)];
    write_masks(&dir, "001", &views);
    let files = ["--grounder", "files", "--masks", "made", "--queries", "ball/001"];
    dir.succeed(&solve(&[&files[..], &["--name", "voted"]].concat()));
    dir.succeed(&solve(&[&files[..], &["--name", "unvoted", "--no-consensus"]].concat()));
    let consensus: Value =
        serde_json::from_str(&dir.read(&format!("work/tiny/{SCENE}/answers/voted/001/consensus.json")))
            .unwrap();
    assert_eq!(consensus["evidence"], serde_json::json!([0, 2, 3]), "{consensus}");
    let rows = |method: &str| {
        let document = dir.json(&["score", "results", "--profile", "tiny", "--missing", "skip"]);
        let methods = document["methods"].as_array().unwrap();
        let found = methods.iter().find(|found| found["name"] == method).unwrap();
        found["miou"].as_f64().unwrap()
    };
    assert!(
        rows("voted") > 75.0 && rows("voted") > rows("unvoted") + 1.0,
        "{} {}",
        rows("voted"),
        rows("unvoted")
    );
}

#[test]
fn views_that_do_not_answer_are_told_and_asked_again() {
    let dir = world();
    write_masks(&dir, "002", &[("cam00", 2), ("cam03", 2)]);
    let files = solve(&["--grounder", "files", "--masks", "made", "--queries", "ball/002", "--name", "half"]);
    let run = dir.succeed(&files);
    assert!(run.stderr.contains("views: 2 error, 2 found"), "{}", run.stderr);
    assert!(
        run.stderr.contains("1 queries have views that did not answer, ball/002 for one"),
        "{}",
        run.stderr
    );
    let half = dir.read(&format!("results/half/masks/{SCENE}/002.json"));
    assert!(half.contains("\"0048\":\""), "two views that agree are enough: {half}");
    write_masks(&dir, "002", &[("cam01", 2), ("cam02", 2)]);
    let run = dir.succeed(&[&files[..], &["--overwrite"]].concat());
    assert!(
        run.stderr.contains("views: 4 found") && !run.stderr.contains("did not answer"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_sentence_is_answered_from_any_camera_at_any_time() {
    let dir = world();
    let run = dir.succeed(&[&QUERY[..], &["--explain", "--out", "asked"]].concat());
    for part in ["grounding", "consensus", "masks", "seconds", "4 of 4 views go on"] {
        assert!(run.stdout.contains(part), "no `{part}` in\n{}", run.stdout);
    }
    for file in ["sheet.png", "consensus.json", "lift", "masks/cam04/0048.png"] {
        assert!(dir.path("asked").join(file).exists(), "{file}");
    }
    assert!(dir.path("asked/overlay.png").exists() || dir.path("asked/overlay.mp4").exists());
    let last = run.stdout.lines().last().unwrap();
    assert!(
        last.starts_with("answer: seen in 9 of 9 frames of the held-out camera cam04, at most "),
        "{last}"
    );
    assert!(last.ends_with(" pixels (4 of 4 views agree); picture: asked/sheet.png"), "{last}");

    let truth = |view: &str, frame: u32| {
        let scene = SceneDir::new(&dir.path("data"), SCENE);
        let surfaces = read_surfaces(&scene.frame(view, frame), UVec2::new(128, 96)).unwrap();
        Mask::from_ids(128, 96, &surfaces.id, 1).unwrap()
    };
    let mask = |folder: &str, view: &str, key: &str| {
        let bytes = std::fs::read(dir.path(format!("{folder}/masks/{view}/{key}.png"))).unwrap();
        png::decode(&bytes, 128, 96).unwrap()
    };
    let iou = |a: &Mask, b: &Mask| a.and_count(b) as f64 / a.or_count(b).max(1) as f64;
    assert!(iou(&mask("asked", "cam04", "0048"), &truth("cam04", 48)) > 0.7);
    let elsewhere = ["--camera", "cam01,cam02", "--time", "0.5,0.3", "--out", "elsewhere"];
    let document = dir.json(&[&QUERY[..], &elsewhere].concat());
    assert_eq!(document["decision"], "reliable");
    assert_eq!(document["answer"]["status"], "answered");
    assert!(document["answer"]["message"].as_str().unwrap().starts_with("answer: seen in 4 of 4 frames"));
    assert_eq!(document["answer"].as_object().unwrap().len(), 2, "{}", document["answer"]);
    assert_eq!(document["frames"]["cam01"].as_object().unwrap().len(), 2);
    assert!(iou(&mask("elsewhere", "cam01", "t0.500000"), &truth("cam01", 48)) > 0.7);

    let between = dir.json(&[&QUERY[..], &["--from", "36", "--to", "60", "--out", "between"]].concat());
    let frames: Vec<&String> = between["frames"]["cam04"].as_object().unwrap().keys().collect();
    assert_eq!(frames, ["0036", "0048", "0060"]);
}

#[test]
fn what_cannot_be_answered_is_refused() {
    let dir = world();
    let oracle = solve(&["--grounder", "oracle"]);
    let with = |more: &[&str]| dir.run(&[&oracle[..], more].concat());
    refused(&with(&["--queries", "ball/999"]), &["has no query ball/999"]);
    refused(&with(&["--scenes", "cave"]), &["no scene `cave`", "ball"]);
    refused(&dir.run(&solve(&["--grounder", "files", "--masks", "made", "--noise", "x.toml"])), &["--noise"]);
    dir.write("noise.toml", "seed = 1\n[noise.swap]\nprobability = 3\n");
    refused(&with(&["--noise", "noise.toml"]), &["noise.toml", "swap.probability", "between 0 and 1"]);

    let query = |more: &[&str]| dir.run(&[&QUERY[..], more].concat());
    refused(&query(&["--camera", "cam99"]), &["no camera `cam99`", "cam00"]);
    refused(&query(&["--time", "1.5"]), &["time 1.5 is outside the clip"]);
    refused(&query(&["--from", "60", "--to", "20"]), &["--from, --to"]);
    refused(&query(&["--from", "1", "--to", "5"]), &["no moment"]);
    refused(&dir.run(&["query", SCENE, "  ", "--profile", "tiny", "--data", "data"]), &["sentence is empty"]);

    std::fs::remove_dir_all(dir.path(format!("work/tiny/{SCENE}/splats"))).unwrap();
    refused(&with(&[]), &["there are no splats", "l4d train-splats ball --profile tiny"]);
    std::fs::remove_file(dir.path(format!("data/{SCENE}/scene.json"))).unwrap();
    refused(&with(&[]), &["there is no scene", "l4d build-scenes"]);
}

#[test]
fn sentences_of_any_length_and_script_come_to_an_end() {
    let dir = world();
    for (text, folder) in
        [("ball ".repeat(10_000), "long"), ("球 🎾 \u{202e}\u{1b}[2J что".to_owned(), "strange")]
    {
        let run = dir.run(&query(&text, &["--out", folder]));
        assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.starts_with("no answer: ") && !run.stdout.contains('\u{1b}'), "{}", run.stdout);
        assert!(run.stdout.lines().count() == 1 && run.stdout.len() < 500, "{}", run.stdout);
        assert!(!dir.path(folder).exists(), "{folder}");
    }
}

#[test]
fn a_sentence_that_cannot_be_read_is_answered_by_what_can() {
    let dir = world();
    let ask = |text: &str, more: &[&str]| dir.run(&query(text, more));
    let run = ask("The flurb that rolls", &["--out", "asked"]);
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    let [line] = run.stdout.lines().collect::<Vec<_>>()[..] else { panic!("{}", run.stdout) };
    for part in ["no answer: cannot read \"flurb\"; ", "verbs such as walk", "reads: \"The ball that rolls\""]
    {
        assert!(line.contains(part), "no `{part}` in {line}");
    }
    assert!(line.len() < 400, "{line}");
    for written in [dir.path("asked"), dir.path(format!("work/tiny/{SCENE}/asked"))] {
        assert!(!written.exists(), "{}", written.display());
    }

    let document = dir.json(&query("The ball nearest to the zorple", &[]));
    let answer = &document["answer"];
    assert_eq!((&answer["status"], &answer["unread_words"]), (&json!("unread"), &json!(["zorple"])));
    assert_eq!(answer["nearest"], "The ball nearest to the wall");
    assert_eq!((&document["folder"], &document["frames"]), (&Value::Null, &json!({})));
    let last = |text: &str, more: &[&str]| ask(text, more).stdout.lines().last().unwrap().to_owned();
    let unmeasured = last("The ball with the ribbon", &[]);
    assert!(unmeasured.starts_with("no answer: reads \"ribbon\", but measures nothing"), "{unmeasured}");
    let alone = last("The ball", &["--bench", "nowhere"]);
    assert!(
        alone.contains("\"the ball\" says nothing beside the kind") && !alone.contains("nearest"),
        "{alone}"
    );
}

#[test]
fn an_answer_of_ones_own_sentence_ends_with_a_line() {
    let dir = world();
    let run = dir.run(&query("The ball that moves", &[]));
    let last = run.stdout.lines().last().unwrap();
    assert!(last.starts_with("answer: ") && last.contains("; picture: work/tiny/ball/"), "{}", run.stdout);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let absent = dir.run(&query("The red bus", &["--out", "absent"]));
    assert_eq!(absent.stdout.lines().last(), Some("no answer: no view shows it"), "{}", absent.stdout);
    assert_eq!(absent.code, 1);
    assert!(dir.path("absent/masks/cam04/0048.png").exists(), "that nothing is there is in masks, too");
}

#[test]
fn grounders_that_know_the_benchmark_alone_refuse_other_sentences_once() {
    let dir = world();
    for more in [&["--grounder", "oracle"][..], &["--grounder", "files", "--masks", "made"]] {
        let run = dir.run(&query("The ball that jumps", more));
        refused(&run, &["about scene ball", "ask \"The ball that rolls\"", "--grounder geometric"]);
        assert_eq!(run.stderr.matches("error:").count(), 1, "{}", run.stderr);
        assert!(run.stderr.contains("answers only sentences of the benchmark") && run.stdout.is_empty());
        refused(
            &dir.run(&query("The ball that rolls", &[more, &["--bench", "nowhere"]].concat())),
            &["nowhere has none about scene ball", "--bench"],
        );
    }
    assert!(!dir.path(format!("work/tiny/{SCENE}/clips")).exists(), "nothing is drawn");
}

#[test]
fn a_card_says_whether_the_splats_saw_depth() {
    let dir = world();
    let model = format!("work/tiny/{SCENE}/splats/checkpoint.json");
    let answer = |name: &str, more: &[&str]| {
        let one = ["--grounder", "oracle", "--queries", "ball/001", "--name", name];
        let run = dir.succeed(&solve(&[&one, more].concat()));
        let card: Value = serde_json::from_str(&dir.read(&format!("results/{name}/method.json"))).unwrap();
        (
            card["used"]["depth"].as_bool().unwrap(),
            run.stderr.contains("not known whether the splats of ball"),
        )
    };
    assert_eq!(answer("deep", &[]), (true, false));
    // A model of before there was the field: how it was trained says it.
    dir.edit(&model, "  \"saw_depth\": true,\n", "");
    assert_eq!(answer("older", &[]), (true, false));
    dir.edit(&model, "\"init\": \"depth\"", "\"init\": \"sweep\"");
    assert_eq!(answer("bright", &[]), (false, false));
    assert_eq!(answer("masks", &["--used-depth"]), (true, false));
    // A model from elsewhere says nothing, so the user has to.
    dir.edit(&model, "\"init\": \"sweep\"", "\"began\": \"somewhere\"");
    assert_eq!(answer("foreign", &[]), (false, true));
    assert_eq!(answer("foreign", &["--used-depth"]), (true, false), "a card learns what was not known");
    assert_eq!(answer("foreign", &[]), (true, true), "and does not forget it");
}

#[test]
fn a_model_of_another_scene_is_refused() {
    let dir = world();
    let card = format!("work/tiny/{SCENE}/splats/checkpoint.json");
    dir.edit(&card, "\"scene\": \"ball\"", "\"scene\": \"barn\"");
    refused(
        &dir.run(&solve(&["--grounder", "oracle"])),
        &["was trained on scene barn", "l4d train-splats ball"],
    );
}

#[test]
fn a_killed_run_ends_with_the_masks_of_one_that_was_not() {
    let whole = world();
    whole.succeed(&solve(&["--grounder", "oracle", "--name", "whole"]));
    let dir = world();
    for patience_ms in [150, 300, 600] {
        let mut child = start(&dir, &solve(&["--grounder", "oracle", "--name", "whole"]));
        sleep(Duration::from_millis(patience_ms));
        child.kill().unwrap();
        child.wait().unwrap();
    }
    dir.succeed(&solve(&["--grounder", "oracle", "--name", "whole"]));
    assert_eq!(results(&dir, "whole"), results(&whole, "whole"));
}

#[test]
fn shards_together_answer_everything_once() {
    let dir = world();
    let begin = Instant::now();
    for shard in ["1/2", "2/2"] {
        dir.succeed(&solve(&["--grounder", "oracle", "--name", "sharded", "--shard", shard, "--jobs", "2"]));
    }
    assert!(begin.elapsed() < Duration::from_secs(300));
    let scored = score(&dir, "sharded");
    assert_eq!(scored["queries"], 3);
    assert_eq!(scored["partial"], false);
}

fn start(dir: &Dir, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_l4d"))
        .args(arguments)
        .current_dir(dir.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}
