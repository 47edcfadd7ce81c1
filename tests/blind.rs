//! The grounder that needs nothing, where nothing on disk knows the answer: no truth, no tracks, no ids.

use std::path::Path;

use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image};
use exr::prelude::{LineOrder, WritableImage as _};
use glam::UVec2;
use l4d_frames::exr::read_frame;
use serde_json::json;

use crate::solving::world;
use crate::support::{Dir, query};
use crate::world::SCENE;

const SOLVE: &str = "solve --profile tiny --data data";
const METHOD: &str = "panopticquery-panoptic";

/// Takes away all that knows more than a camera with a depth sensor, and what was drawn before.
fn blind(dir: &Dir) {
    dir.remove("benchmark/truth");
    dir.remove(&format!("work/tiny/{SCENE}/clips"));
    for file in ["tracks.json", "plan.json", "scene.usdc"] {
        assert!(!dir.path(format!("data/{SCENE}/{file}")).exists(), "the made-up scene has no {file}");
    }
    dir.change(&format!("data/{SCENE}/scene.json"), |scene| {
        (scene["instances"], scene["events"], scene["digests"]) = (json!([]), json!([]), json!({}));
    });
    let frames = format!("data/{SCENE}/frames");
    let pictures: Vec<String> = dir.tree(&frames).into_keys().filter(|name| name.ends_with(".exr")).collect();
    assert_eq!(pictures.len(), 5 * 9);
    pictures.iter().for_each(|picture| drop_ids(&dir.path(&frames).join(picture)));
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
    let masks = |dir: &Dir| dir.tree(&format!("results/{METHOD}/masks/{SCENE}"));
    let seeing = world();
    seeing.succeed(SOLVE);
    let has_pixels = |file: &Vec<u8>| String::from_utf8_lossy(file).contains(":\"");
    assert!(masks(&seeing).values().any(has_pixels), "geometry alone finds one of two balls");

    let dir = world();
    blind(&dir);
    dir.run(format!("{SOLVE} --grounder oracle")).says(2, &["ball_a"]);
    dir.run(SOLVE).says(0, &["3 queries"]);
    assert_eq!(masks(&dir), masks(&seeing));
    let ask = |dir: &Dir| {
        let asked = dir.json("query ball 'The ball that rolls' --profile tiny --data data --out asked");
        (asked["frames"].clone(), asked["decision"].clone())
    };
    assert_eq!(ask(&dir), ask(&seeing));

    // Who made masks without the truth cannot be judged by another; beside the truth the card is completed.
    let digest = || dir.value(&format!("results/{METHOD}/method.json"))["truth_digest"].clone();
    assert_eq!(digest(), "");
    let truth = format!("benchmark/truth/tiny/{SCENE}.json");
    dir.write(&truth, seeing.bytes(&truth));
    dir.run("score results --profile tiny").says(1, &["is no truth"]);
    dir.succeed(SOLVE);
    assert_eq!(digest().as_str().unwrap().len(), 64);
    dir.succeed("score results --profile tiny");
}

#[test]
fn a_model_is_learned_without_ids() {
    let brief = "--gaussians 300 --coarse 6 --unfold 2 --fine 4 --out brief";
    let learned = |dir: &Dir| {
        dir.succeed(format!("train-splats {SCENE} --profile tiny --data data {brief}"));
        let mut files = dir.tree("brief");
        files.retain(|name, _| name.ends_with(".safetensors"));
        files
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
    let sentences = [("901", "The blue ball"), ("902", "The zorple"), ("903", "The flurb that rolls")];
    let lines = sentences.map(|(number, text)| {
        format!("{}\n", query(&format!("{SCENE}/{number}"), text, "attribute", &[], "whole", [0, 96]))
    });
    dir.write(&format!("benchmark/queries/{SCENE}.absent.jsonl"), lines.concat());
    let solved = dir.succeed(format!("{SOLVE} --set absents"));
    solved.says(0, &["8 unsupported"]);
    assert!(!solved.stderr.contains("did not answer"), "{solved}");
    let name = "panopticquery-panoptic-absents";
    for number in ["902", "903"] {
        let masks = dir.read(&format!("results/{name}/masks/{SCENE}/{number}.json"));
        assert!(!masks.contains(":\""), "{number} claims something: {masks}");
    }
    assert!(!dir.path(format!("results/{METHOD}")).exists(), "sets are not mixed under one name");

    // Its last word is not asked for again.
    let answer = dir.path(format!("work/tiny/{SCENE}/answers/{name}/902"));
    let files = ["grounded/cam00.json", "manifest.json"].map(|file| answer.join(file));
    let written = || files.each_ref().map(|path| path.metadata().unwrap().modified().unwrap());
    let before = written();
    dir.succeed(format!("{SOLVE} --set absents"));
    assert_eq!(written(), before);
}
