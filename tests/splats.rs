//! `train-splats` as its users run it, on a made-up scene: a checkered floor, a wall, and a ball that rolls.

use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::support::{Dir, Run};
use crate::world::{self, SCENE, write_scene};

const SPLATS: &str = "work/tiny/ball/splats";
const TRAIN: &str = "train-splats ball --profile tiny --data data";
/// Few iterations: enough to see what is asked here.
const SHORT: &str = "--gaussians 800 --coarse 40 --unfold 4 --fine 60 --patience 0 --checkpoint-seconds 0.1";
/// As few as there can be.
const FEW: &str = "--gaussians 300 --coarse 5 --unfold 1 --fine 5";

pub(crate) fn scene() -> Dir {
    let dir = Dir::new();
    write_scene(&dir.path("data"));
    dir
}

fn train(dir: &Dir, more: &str) -> Run {
    dir.run(format!("{TRAIN} {more}"))
}

/// The digest of what a model holds.
fn tensors(dir: &Dir, folder: &str) -> Value {
    dir.value(&format!("{folder}/checkpoint.json"))["tensors"]["sha256"].clone()
}

#[test]
fn a_scene_is_learned_from_its_training_cameras() {
    let dir = scene();
    let manifest = dir.json(format!("{TRAIN} --depth --gaussians 2500 --coarse 150 --unfold 20 --fine 600"));
    let report = &manifest["report"];
    let number = |path: &str| report.pointer(path).and_then(Value::as_f64).unwrap();
    assert!(number("/test/psnr_db") > 24.0, "{report}");
    assert!(number("/test/psnr_moving_db") > 18.0, "{report}");
    assert!(number("/test/depth_error_m") < 0.12, "{report}");
    assert!(number("/dynamic") > 20.0 && number("/dynamic") < 0.5 * number("/gaussians"), "{report}");
    let card = dir.value(&format!("{SPLATS}/checkpoint.json"));
    assert_eq!(card["inputs"], manifest["trained_on"]);
    let said = [&card["saw_depth"], &manifest["saw_depth"], &manifest["track"]];
    assert_eq!(said, [&json!(true), &json!(true), &json!("colour+depth")]);
}

#[test]
fn what_is_learned_does_not_change_when_the_held_out_pictures_do() {
    let dir = scene();
    let manifest = dir.json(format!("{TRAIN} {SHORT}"));
    let paths = |field: &str| manifest[field].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let (trained, compared) = (paths("trained_on"), paths("compared_with"));
    assert_eq!((trained.len(), compared.len()), (4 * 9, 9));
    assert!(trained.iter().all(|path| !path.contains("cam04")), "{trained:?}");
    assert!(compared.iter().all(|path| path.starts_with("frames/cam04/")), "{compared:?}");
    let before = tensors(&dir, SPLATS);
    world::blacken(&dir.path("data"), "cam04");
    dir.succeed(format!("{TRAIN} {SHORT} --force"));
    assert_eq!(tensors(&dir, SPLATS), before);
}

#[test]
fn kills_and_numbers_of_threads_do_not_change_what_is_learned() {
    // Everything that has to be the same after a kill: the card without its times, and the name of the numbers, which
    // follows from their bytes.
    let card = |dir: &Dir| {
        let mut card = dir.value(&format!("{SPLATS}/checkpoint.json"));
        card["training"].as_object_mut().unwrap().remove("spent");
        card
    };
    let whole = scene();
    let mut alone = whole.command(format!("{TRAIN} {SHORT}"));
    assert!(alone.env("RAYON_NUM_THREADS", "1").output().unwrap().status.success());
    let expected = card(&whole);
    let fine = |dir: &Dir| dir.value(&format!("{SPLATS}/manifest.json"))["report"]["fine"].clone();
    assert_eq!(fine(&whole)["iterations"], 60);
    assert_eq!(expected["training"]["done"], json!(true));

    let dir = scene();
    let mut kills = 0;
    for wait_ms in [200, 50, 400, 150] {
        let mut command = dir.command(format!("{TRAIN} {SHORT}"));
        command.env("RAYON_NUM_THREADS", "4").stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
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
    train(&dir, SHORT).says(0, &[]);
    assert_eq!(card(&dir), expected);
    // Seconds of all runs together.
    assert_eq!(fine(&dir)["iterations"], 60);
    assert!(fine(&dir)["seconds"].as_f64() > Some(0.0));
    // A third run finds the work done.
    train(&dir, SHORT).says(0, &["holds this model already"]);
}

#[test]
fn a_folder_with_another_model_is_left_alone() {
    let dir = scene();
    dir.succeed(format!("{TRAIN} {FEW}"));
    let before = dir.read(&format!("{SPLATS}/checkpoint.json"));
    train(&dir, &format!("{FEW} --seed 7")).refused(&["`seed` was 0 and is 7 now", "--force"]);
    assert_eq!(dir.read(&format!("{SPLATS}/checkpoint.json")), before);
    world::blacken(&dir.path("data"), "cam01");
    train(&dir, FEW).refused(&["frames/cam01/0000.exr has changed", "--force"]);
    dir.succeed(format!("{TRAIN} {FEW} --seed 7 --force"));
}

#[test]
fn training_ends_with_the_track_of_its_model() {
    let dir = scene();
    let depth = "track: colour + depth (learned from rendered depth)\n";
    let run = dir.succeed(format!("{TRAIN} {FEW} --depth"));
    assert!(run.stderr.ends_with(depth), "{run}");
    let run = dir.succeed(format!("{TRAIN} {FEW} --depth"));
    assert!(run.stderr.contains("holds this model already") && run.stderr.ends_with(depth), "{run}");
    assert_eq!(dir.json(format!("{TRAIN} {FEW} --depth"))["track"], "colour+depth");

    let blind = format!("{TRAIN} {FEW} --out blind");
    let run = dir.succeed(&blind);
    assert!(run.stderr.ends_with("track: colour\n"), "{run}");
    let manifest = dir.json(&blind);
    assert_eq!((&manifest["saw_depth"], &manifest["track"]), (&json!(false), &json!("colour")));
    // One that was shown depth is not passed off as one that was not.
    dir.edit("blind/checkpoint.json", "\"saw_depth\": false", "\"saw_depth\": true");
    dir.refuses(&blind, &["it was shown depth", "--force"]);
}

#[test]
fn without_depth_no_byte_of_it_matters() {
    let dir = scene();
    dir.succeed(format!("{TRAIN} {FEW} --out first"));
    for view in ["cam00", "cam01", "cam02", "cam03"] {
        world::spoil_depth_and_ids(&dir.path("data"), view);
    }
    dir.succeed(format!("{TRAIN} {FEW} --out second"));
    assert_eq!(tensors(&dir, "first"), tensors(&dir, "second"));
    // Who asks for depth meets what was spoilt.
    dir.refuses(format!("{TRAIN} {FEW} --depth --out third"), &[".exr", "channel `Z`"]);
}

#[test]
fn scenes_that_cannot_be_learned_are_refused_with_the_place_and_a_hint() {
    let dir = scene();
    let ghost = "train-splats ghost --profile tiny --data data";
    dir.refuses(ghost, &["data/ghost", "build-scenes"]);
    let small = format!("train-splats {SCENE} --profile small --data data");
    dir.refuses(small, &["`profile` is tiny", "--profile tiny"]);

    let scene_json = "data/ball/scene.json";
    let whole = dir.read(scene_json);
    dir.edit(scene_json, "\"fx\": 140.0", "\"fx\": 0.0");
    train(&dir, FEW).refused(&["scene.json", "`fx` is 0"]);
    dir.write(scene_json, whole.replace("\"split\": \"train\"", "\"split\": \"test\""));
    train(&dir, FEW).refused(&["scene.json", "held out"]);
    dir.write(scene_json, &whole);

    let frame = "data/ball/frames/cam02/0048.exr";
    let bytes = dir.bytes(frame);
    dir.write(frame, &bytes[..bytes.len() / 2]);
    train(&dir, FEW).refused(&["cam02/0048.exr"]);
    let sheet = format!("sheet {SCENE} --profile tiny --data data --views cam02 --frames 48");
    dir.refuses(
        &sheet,
        &["cam02/0048.exr", "delete the file and run `l4d build-scenes --profile tiny --data data` again"],
    );
    dir.remove(frame);
    dir.refuses(&sheet, &["cam02/0048.exr"]);
    train(&dir, FEW).refused(&["cam02/0048.exr"]);
    dir.write(frame, &bytes);

    dir.write("points3D.txt", "1 0.0 0.5 nan 10 20 30 0.1\n");
    train(&dir, &format!("{FEW} --points points3D.txt")).refused(&["points3D.txt", "point 1"]);
    assert!(!dir.path(SPLATS).exists());
}

#[test]
fn training_begins_at_given_points_too() {
    let dir = scene();
    let point = |index: u32| {
        let [x, y] = [f64::from(index % 20) * 0.1 - 1.0, f64::from(index / 20) * 0.2];
        format!("{index} {x} {y} 0.0 200 100 50 0.1\n")
    };
    dir.write("points3D.txt", (0..200).map(point).collect::<String>());
    let few = "--gaussians 400 --coarse 30 --unfold 2 --fine 30";
    let manifest = dir.json(format!("{TRAIN} {few} --points points3D.txt --out model"));
    assert_eq!((&manifest["init"], &manifest["saw_depth"]), (&json!("points3D.txt"), &json!(false)));
    assert!(manifest["report"]["test"]["psnr_db"].as_f64().unwrap() > 5.0);
}
