//! The grounder that needs nothing, where nothing on disk knows the answer: no truth, no tracks, no ids.

use std::path::Path;

use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image};
use exr::prelude::{LineOrder, WritableImage as _};
use glam::UVec2;
use l4d_data::query::text_digest;
use l4d_frames::exr::read_frame;
use serde_json::{Value, json};

use crate::solving::world;
use crate::support::Dir;
use crate::world::SCENE;

const PLACE: [&str; 4] = ["--profile", "tiny", "--data", "data"];
const METHOD: &str = "panopticquery-geometric";

fn run<'a>(verb: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&[verb], &PLACE[..], more].concat()
}

fn masks(dir: &Dir) -> Vec<String> {
    ["001", "002", "003"]
        .map(|number| dir.read(&format!("results/{METHOD}/masks/{SCENE}/{number}.json")))
        .into()
}

/// Takes away all that knows more than a camera with a depth sensor.
fn blind(dir: &Dir) {
    std::fs::remove_dir_all(dir.path("benchmark/truth")).unwrap();
    for file in ["tracks.json", "plan.json", "scene.usdc"] {
        assert!(!dir.path(format!("data/{SCENE}/{file}")).exists(), "the made-up scene has no {file}");
    }
    let path = format!("data/{SCENE}/scene.json");
    let mut scene: Value = serde_json::from_str(&dir.read(&path)).unwrap();
    for field in ["instances", "events"] {
        scene[field] = json!([]);
    }
    scene["digests"] = json!({});
    dir.write(&path, scene.to_string());
    let mut pictures = 0;
    for view in std::fs::read_dir(dir.path(format!("data/{SCENE}/frames"))).unwrap() {
        for file in std::fs::read_dir(view.unwrap().path()).unwrap() {
            drop_ids(&file.unwrap().path());
            pictures += 1;
        }
    }
    assert_eq!(pictures, 5 * 9);
}

/// Writes a picture anew, without the channel `id`.
fn drop_ids(path: &Path) {
    let size = UVec2::new(128, 96);
    let frame = read_frame(path, size).unwrap();
    let colour = |index: usize| FlatSamples::F16(frame.rgb.iter().map(|pixel| pixel[index]).collect());
    let channels = vec![
        AnyChannel::new("B", colour(2)),
        AnyChannel::new("G", colour(1)),
        AnyChannel::new("R", colour(0)),
        AnyChannel::new("Z", FlatSamples::F32(frame.surfaces.depth_m.clone())),
    ];
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (size.x as usize, size.y as usize);
    let image = Image::from_encoded_channels(size, encoding, AnyChannels::sort(channels.into()));
    image.write().to_file(path).unwrap();
    assert!(read_frame(path, UVec2::new(128, 96)).is_err(), "the ids are gone");
}

#[test]
fn truth_tracks_and_ids_make_no_difference() {
    let seeing = world();
    seeing.succeed(&run("solve", &[]));
    let found = masks(&seeing).iter().filter(|masks| masks.contains(":\"")).count();
    assert!(found > 0, "geometry alone finds one of two balls");

    let dir = world();
    blind(&dir);
    let oracle = dir.run(&run("solve", &["--grounder", "oracle"]));
    assert!(oracle.code == 2 && oracle.stderr.contains("ball_a"), "{}", oracle.stderr);
    let solved = dir.succeed(&run("solve", &[]));
    assert!(solved.stderr.contains("3 queries"), "{}", solved.stderr);
    assert_eq!(masks(&dir), masks(&seeing));
    let query = ["query", SCENE, "The ball that rolls"];
    let ask = |dir: &Dir| dir.json(&[&query[..], &PLACE, &["--out", "asked"]].concat());
    let (blindly, seeingly) = (ask(&dir), ask(&seeing));
    assert_eq!((&blindly["frames"], &blindly["decision"]), (&seeingly["frames"], &seeingly["decision"]));

    // Who made masks without the truth cannot be judged by another; beside the truth the card is completed.
    let card = || serde_json::from_str::<Value>(&dir.read(&format!("results/{METHOD}/method.json"))).unwrap();
    assert_eq!(card()["truth_digest"], "");
    std::fs::create_dir_all(dir.path("benchmark/truth/tiny")).unwrap();
    let truth = format!("benchmark/truth/tiny/{SCENE}.json");
    std::fs::copy(seeing.path(&truth), dir.path(&truth)).unwrap();
    let run_score = dir.run(&["score", "results", "--profile", "tiny"]);
    assert_eq!(run_score.code, 1, "{}{}", run_score.stdout, run_score.stderr);
    assert!(run_score.stdout.contains("is no truth") || run_score.stderr.contains("is no truth"));
    dir.succeed(&run("solve", &[]));
    assert_eq!(card()["truth_digest"].as_str().unwrap().len(), 64);
    dir.succeed(&["score", "results", "--profile", "tiny"]);
}

#[test]
fn a_model_is_learned_without_ids() {
    let brief = ["--gaussians", "300", "--coarse", "6", "--unfold", "2", "--fine", "4", "--out", "brief"];
    let learned = |dir: &Dir| {
        dir.succeed(&[&["train-splats", SCENE], &PLACE[..], &brief].concat());
        let files = std::fs::read_dir(dir.path("brief")).unwrap().map(|file| file.unwrap().path());
        let tensors = files.filter(|path| path.extension().is_some_and(|ending| ending == "safetensors"));
        tensors.map(|path| std::fs::read(path).unwrap()).collect::<Vec<_>>()
    };
    let (seeing, dir) = (world(), world());
    blind(&dir);
    let tensors = learned(&dir);
    assert_eq!(tensors.len(), 1);
    assert!(tensors == learned(&seeing), "ids changed what was learned");
}

#[test]
fn what_nothing_satisfies_is_absent_or_beyond_its_words() {
    let dir = world();
    let sentence = |number: &str, text: &str| {
        json!({
            "id": format!("{SCENE}/{number}"), "text": text, "categories": ["attribute"], "referents": [],
            "temporal": "whole", "frames": [[0, 96]], "predicate": null,
            "text_digest": text_digest(text, None), "provenance": { "source": "author" }, "status": "candidate",
        })
    };
    let sentences = [
        sentence("901", "The blue ball"),
        sentence("902", "The zorple"),
        sentence("903", "The ball with the ponytail"),
    ];
    let lines: Vec<String> = sentences.iter().map(Value::to_string).collect();
    dir.write(&format!("benchmark/queries/{SCENE}.absent.jsonl"), lines.join("\n") + "\n");
    let run_solve = dir.succeed(&run("solve", &["--set", "absents"]));
    assert!(run_solve.stderr.contains("8 unsupported"), "{}", run_solve.stderr);
    assert!(!run_solve.stderr.contains("did not answer"), "{}", run_solve.stderr);
    let name = "panopticquery-geometric-absents";
    for number in ["902", "903"] {
        let masks = dir.read(&format!("results/{name}/masks/{SCENE}/{number}.json"));
        assert!(!masks.contains(":\""), "{number} claims something: {masks}");
    }
    assert!(!dir.path(format!("results/{METHOD}")).exists(), "sets are not mixed under one name");

    // Its last word is not asked for again.
    let said = dir.path(format!("work/tiny/{SCENE}/answers/{name}/902/grounded/cam00.json"));
    let manifest = dir.path(format!("work/tiny/{SCENE}/answers/{name}/902/manifest.json"));
    let written = || [&said, &manifest].map(|path| std::fs::metadata(path).unwrap().modified().unwrap());
    let before = written();
    dir.succeed(&run("solve", &["--set", "absents"]));
    assert_eq!(written(), before);
}
