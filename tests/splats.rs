//! `train-splats` as its users run it, on a made-up scene: a checkered floor, a wall, and a ball that rolls.

use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::support::{Dir, Run};
use crate::world::{self, SCENE, write_scene};

const SPLATS: &str = "work/tiny/ball/splats";

/// Few iterations: enough to see what is asked here.
const SHORT: [&str; 12] = [
    "--gaussians",
    "1500",
    "--coarse",
    "60",
    "--unfold",
    "6",
    "--fine",
    "90",
    "--patience",
    "0",
    "--checkpoint-seconds",
    "0.3",
];

fn arguments<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["train-splats", SCENE, "--profile", "tiny", "--data", "data"], more].concat()
}

fn scene() -> Dir {
    let dir = Dir::new();
    write_scene(&dir.path("data"));
    dir
}

fn train(dir: &Dir, more: &[&str]) -> Run {
    dir.run(&arguments(&[&SHORT, more].concat()))
}

fn refused(run: &Run, parts: &[&str]) {
    assert_eq!(run.code, 2, "{}{}", run.stdout, run.stderr);
    for part in parts {
        assert!(run.stderr.contains(part), "no `{part}` in\n{}", run.stderr);
    }
    assert!(run.stderr.contains("hint:"), "{}", run.stderr);
}

/// Everything that has to be the same after a kill: the card without its times, and the name of the numbers, which
/// follows from their bytes.
fn card(dir: &Dir) -> Value {
    let mut card: Value = serde_json::from_str(&dir.read(&format!("{SPLATS}/checkpoint.json"))).unwrap();
    card["training"].as_object_mut().unwrap().remove("train_seconds");
    card
}

#[test]
fn a_scene_is_learned_from_its_training_cameras_alone() {
    let dir = scene();
    let brief = ["--gaussians", "2500", "--coarse", "150", "--unfold", "20", "--fine", "900"];
    let manifest = dir.json(&arguments(&brief));
    let report = &manifest["report"];
    let number = |path: &str| report.pointer(path).and_then(Value::as_f64).unwrap();
    assert!(number("/test/psnr_db") > 24.0, "{report}");
    assert!(number("/test/psnr_moving_db") > 18.0, "{report}");
    assert!(number("/test/depth_error_m") < 0.12, "{report}");
    assert!(number("/dynamic") > 20.0 && number("/dynamic") < 0.5 * number("/gaussians"), "{report}");
    let paths = |field: &str| manifest[field].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let (trained, compared) = (paths("trained_on"), paths("compared_with"));
    assert_eq!((trained.len(), compared.len()), (4 * 9, 9));
    assert!(trained.iter().all(|path| !path.contains("cam04")), "{trained:?}");
    assert!(compared.iter().all(|path| path.starts_with("frames/cam04/")), "{compared:?}");
    let card: Value = serde_json::from_str(&dir.read(&format!("{SPLATS}/checkpoint.json"))).unwrap();
    assert_eq!(card["inputs"], manifest["trained_on"]);
    let said = [&card["saw_depth"], &manifest["saw_depth"], &manifest["track"]];
    assert_eq!(said, [&json!(true), &json!(true), &json!("colour+depth")]);

    // What is learned does not change when the held-out pictures do.
    let tensors = card["tensors"]["sha256"].clone();
    world::blacken(&dir.path("data"), "cam04");
    let again = arguments(&[&brief[..], &["--overwrite"]].concat());
    dir.succeed(&again);
    let card: Value = serde_json::from_str(&dir.read(&format!("{SPLATS}/checkpoint.json"))).unwrap();
    assert_eq!(card["tensors"]["sha256"], tensors);
}

#[test]
fn a_killed_training_ends_as_one_that_was_not() {
    let whole = scene();
    assert_eq!(train(&whole, &[]).code, 0);
    let expected = card(&whole);
    assert_eq!(expected["training"]["done"], json!(true));

    let dir = scene();
    let mut kills = 0;
    for wait_ms in [500, 200, 900, 350] {
        let mut child = spawn(&dir);
        let end = Instant::now() + Duration::from_secs(60);
        // Some training has to be saved first, then the moment is arbitrary.
        let saved = || dir.path(format!("{SPLATS}/checkpoint.json")).exists();
        while !saved() && child.try_wait().unwrap().is_none() && Instant::now() < end {
            sleep(Duration::from_millis(5));
        }
        sleep(Duration::from_millis(wait_ms));
        kills += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(kills > 0, "training was over before it could be killed");
    let run = train(&dir, &[]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(card(&dir), expected);
    // A third run finds the work done.
    assert!(train(&dir, &[]).stderr.contains("holds this model already"));
}

fn spawn(dir: &Dir) -> Child {
    Command::new(env!("CARGO_BIN_EXE_l4d"))
        .args(arguments(&SHORT))
        .current_dir(dir.path("."))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn one_thread_and_four_learn_the_same_bytes() {
    let dir = scene();
    let learn = |threads: &str| {
        let out = format!("model{threads}");
        let status = Command::new(env!("CARGO_BIN_EXE_l4d"))
            .args(arguments(&[&SHORT, ["--out", out.as_str()].as_slice()].concat()))
            .current_dir(dir.path("."))
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap()
            .status;
        assert!(status.success());
        let card: Value = serde_json::from_str(&dir.read(&format!("{out}/checkpoint.json"))).unwrap();
        card["tensors"]["sha256"].clone()
    };
    assert_eq!(learn("1"), learn("4"));
}

#[test]
fn a_folder_with_another_model_is_left_alone() {
    let dir = scene();
    let few = ["--coarse", "5", "--unfold", "1", "--fine", "5", "--gaussians", "300"];
    dir.succeed(&arguments(&few));
    let before = dir.read(&format!("{SPLATS}/checkpoint.json"));
    let other = [few.as_slice(), &["--seed", "7"]].concat();
    refused(&dir.run(&arguments(&other)), &["`seed` was 0 and is 7 now", "--overwrite"]);
    assert_eq!(dir.read(&format!("{SPLATS}/checkpoint.json")), before);
    world::blacken(&dir.path("data"), "cam01");
    refused(&dir.run(&arguments(&few)), &["frames/cam01/0000.exr has changed", "--overwrite"]);
    dir.succeed(&arguments(&[other.as_slice(), &["--overwrite"]].concat()));
}

#[test]
fn training_ends_with_the_track_of_its_model() {
    let dir = scene();
    let few = ["--coarse", "5", "--unfold", "1", "--fine", "5", "--gaussians", "300"];
    let depth = "track: colour + depth (learned from rendered depth)\n";
    let run = dir.succeed(&arguments(&few));
    assert!(run.stderr.ends_with(depth), "{}", run.stderr);
    let run = dir.succeed(&arguments(&few));
    assert!(run.stderr.contains("holds this model already") && run.stderr.ends_with(depth), "{}", run.stderr);
    assert_eq!(dir.json(&arguments(&few))["track"], "colour+depth");

    let blind = [few.as_slice(), &["--init", "sweep"]].concat();
    let run = dir.succeed(&arguments(&[blind.as_slice(), &["--out", "blind"]].concat()));
    assert!(run.stderr.ends_with("track: colour\n"), "{}", run.stderr);
    let manifest = dir.json(&arguments(&[blind.as_slice(), &["--out", "blind"]].concat()));
    assert_eq!((&manifest["saw_depth"], &manifest["track"]), (&json!(false), &json!("colour")));
    // One that was shown depth is not passed off as one that was not.
    dir.edit("blind/checkpoint.json", "\"saw_depth\": false", "\"saw_depth\": true");
    let again = arguments(&[blind.as_slice(), &["--out", "blind"]].concat());
    refused(&dir.run(&again), &["it was shown depth", "--overwrite"]);
}

#[test]
fn scenes_that_cannot_be_learned_are_refused_with_the_place_and_a_remedy() {
    let dir = scene();
    let scene_json = "data/ball/scene.json";
    let whole = dir.read(scene_json);
    refused(
        &dir.run(&["train-splats", "ghost", "--profile", "tiny", "--data", "data"]),
        &["data/ghost", "build-scenes"],
    );
    refused(
        &dir.run(&["train-splats", SCENE, "--profile", "small", "--data", "data"]),
        &["`profile` is tiny", "--profile tiny"],
    );

    dir.edit(scene_json, "\"fx\": 140.0", "\"fx\": 0.0");
    refused(&train(&dir, &[]), &["scene.json", "`fx` is 0"]);
    dir.write(scene_json, whole.replace("\"split\": \"train\"", "\"split\": \"test\""));
    refused(&train(&dir, &[]), &["scene.json", "held out"]);
    dir.write(scene_json, &whole);

    let frame = "data/ball/frames/cam02/0048.exr";
    let bytes = std::fs::read(dir.path(frame)).unwrap();
    dir.write(frame, &bytes[..bytes.len() / 2]);
    refused(&train(&dir, &[]), &["cam02/0048.exr"]);
    std::fs::remove_file(dir.path(frame)).unwrap();
    refused(&train(&dir, &[]), &["cam02/0048.exr"]);
    dir.write(frame, &bytes);

    dir.write("points3D.txt", "1 0.0 0.5 nan 10 20 30 0.1\n");
    refused(&train(&dir, &["--init", "points3D.txt"]), &["points3D.txt", "point 1"]);
    assert!(!dir.path(SPLATS).exists());
}

#[test]
fn training_begins_at_given_points_too() {
    let dir = scene();
    let few = ["--coarse", "30", "--unfold", "2", "--fine", "30", "--gaussians", "400"];
    let points: String = (0..200)
        .map(|index| {
            format!(
                "{index} {} {} 0.0 200 100 50 0.1\n",
                f64::from(index % 20) * 0.1 - 1.0,
                f64::from(index / 20) * 0.2
            )
        })
        .collect();
    dir.write("points3D.txt", points);
    let manifest =
        dir.json(&arguments(&[few.as_slice(), &["--init", "points3D.txt", "--out", "model"]].concat()));
    assert_eq!((&manifest["init"], &manifest["saw_depth"]), (&json!("points3D.txt"), &json!(true)));
    assert!(manifest["report"]["test"]["psnr_db"].as_f64().unwrap() > 5.0);
}
