//! Files as the programs of other methods write them: imported without a flag, and scored as their evaluators score them.
//!
//! `tests/data/originals.json` holds what these evaluators said of the same files; `originals.py` runs them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::process::{Command, Stdio};

use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage};
use l4d_data::truth::Truth;
use l4d_data::{Camera, Query, Split};
use l4d_frames::Frame;
use l4d_frames::overlay::encode_jpeg;
use l4d_masks::{Mask, ids, target};
use l4d_testing::foreign::{npy, npy_texts, npz, pth};
use l4d_testing::{camera, flat, instance, query, scene, truth, write_benchmark, write_scene};
use serde_json::{Value, json};

use crate::support::{Dir, Noise, codes, files_below, root, shipped};

const SCENE: &str = "tabletop_cups";
/// The object of the gated sentence, as annotations call it.
const BASE: &str = "cup red";
/// Moments of the clip.
const MOMENTS: usize = 9;
const WIDTH: u32 = 128;
const HEIGHT: u32 = 96;

fn queries() -> Vec<Query> {
    let one = |number: &str, text: &str, referents: &[&str], frames: [u32; 2]| {
        query(&format!("{SCENE}/{number}"), text, referents, frames)
    };
    vec![
        one("001", "The red cup", &["cup_red"], [0, 96]),
        one("002", "the blue cup", &["cup_blue"], [0, 96]),
        one("003", "the red cup while it tips", &["cup_red"], [36, 60]),
        one("004", "both cups", &["cup_red", "cup_blue"], [0, 96]),
        one("005", "the pear", &["pear_green"], [0, 96]),
    ]
}

/// Columns and rows, each the first and the one after the last, of a thing at a moment; the blue cup leaves in the end.
fn place(id: u32, moment: usize) -> Option<[u32; 4]> {
    let along = 5 * moment as u32;
    match id {
        1 => Some([8 + along, 24 + along, 40, 62]),
        2 if moment < 7 => Some([70 + along, 86 + along, 38, 60]),
        3 => Some([30, 50, 68, 84]),
        1001 => Some([0, WIDTH, 90, HEIGHT]),
        _ => None,
    }
}

fn id_at(col: u32, row: u32, moment: usize) -> u32 {
    let covers = |id: &u32| {
        place(*id, moment).is_some_and(|[left, right, top, bottom]| {
            (left..right).contains(&col) && (top..bottom).contains(&row)
        })
    };
    [1, 2, 3, 1001].into_iter().find(covers).unwrap_or(0)
}

/// A folder with a benchmark of one scene, and what its held-out view sees.
struct Originals {
    dir: Dir,
    truth: Truth,
}

impl Originals {
    fn new() -> Self {
        let dir = Dir::new();
        let things = [(1, "cup_red"), (2, "cup_blue"), (3, "pear_green"), (1001, "mat")];
        let instances = things.map(|(id, label)| instance(id, label)).to_vec();
        let cameras =
            [("cam00", Split::Train), ("cam08", Split::Test)].map(|(view, split)| camera(view, split));
        let look =
            |_: &Camera, frame: u32| -> Frame { flat(|col, row| id_at(col, row, frame as usize / 12)) };
        let scene = scene(SCENE, cameras.to_vec(), instances);
        let scene = write_scene(&dir.path("data/tiny"), scene, |camera, frame| Some(look(camera, frame)));
        let truth = truth(&scene, |camera, frame| look(camera, frame).surfaces);
        write_benchmark(&dir.path("benchmark"), &[(truth.clone(), queries())]);
        let originals = Self { dir, truth };
        originals.write_truth();
        originals
    }

    /// What is asked for, for `originals.py`: `gt/<number>/<moment>.png`, none where the target is not there.
    fn write_truth(&self) {
        for (query, moment) in pairs() {
            let target = target::target(&self.truth, &query, 12 * moment as u32);
            if let Some(mask) = target {
                self.dir.write(&format!("gt/{}/{moment:05}.png", query.id.number), grey(&mask));
            }
        }
        let texts: BTreeMap<String, String> =
            queries().into_iter().map(|query| (query.id.number.to_string(), query.text)).collect();
        self.dir.write("gt/queries.json", json!({"scene": SCENE, "texts": texts}).to_string());
    }

    /// What a method that knows no time says: a part of its referents, so that no two averages are the same.
    fn guess(&self, query: &Query, moment: usize) -> Mask {
        let whole = target::union(&self.truth, &query.referents, 12 * moment as u32);
        let cut = self.cut(query.id.number.as_str().parse().unwrap(), moment);
        let whole = whole.unwrap_or_else(|| Mask::empty(WIDTH, HEIGHT));
        Mask::from_fn(WIDTH, HEIGHT, |col, row| {
            whole.get(col, row) && (row < cut || row >= 64 && row < cut + 28)
        })
    }

    fn cut(&self, number: u32, moment: usize) -> u32 {
        44 + (3 * moment as u32 + 5 * number) % 18
    }

    /// Imports `theirs` and gives what `import --json` says: no flag but the profile, and no finding.
    fn import(&self, preset: &str, more: &str) -> Value {
        let run = self.dir.json(format!("import {preset} theirs --profile tiny --force {more}"));
        assert_eq!(run["findings"], json!([]), "{run:#}");
        let checked = self.dir.json(format!("check-results results/{preset} --profile tiny"));
        assert_eq!(checked["findings"], json!([]));
        run
    }

    /// What a protocol says of imported results, from 0 to 1.
    fn score(&self, preset: &str, protocol: &str) -> BTreeMap<String, f64> {
        let line = format!("score results/{preset} --profile tiny --protocol {protocol}");
        let document = self.dir.json(line);
        let measures = document["methods"][0]["measures"].as_object().unwrap();
        let numbers = measures.iter().filter_map(|(key, value)| Some((key.clone(), value.as_f64()? / 100.0)));
        numbers.collect()
    }

    /// Demands that a protocol says of a preset what the original evaluator said.
    fn agrees(&self, preset: &str, protocol: &str, evaluator: &str) {
        let ours = self.score(preset, protocol);
        let theirs = &recorded()[evaluator];
        assert!(!ours.is_empty());
        for (measure, ours) in ours {
            let theirs =
                theirs[&measure].as_f64().unwrap_or_else(|| panic!("{evaluator} said nothing of {measure}"));
            // Two of them divide in single precision.
            let bound = if ["refersplat", "4d-langsplat"].contains(&evaluator) { 1e-7 } else { 1e-9 };
            assert!((ours - theirs).abs() < bound, "{preset}, {measure}: {ours} is not {theirs}");
        }
    }
}

/// What the evaluators of the originals said.
fn recorded() -> Value {
    serde_json::from_str(&shipped("tests/data/originals.json")).unwrap()
}

fn pairs() -> impl Iterator<Item = (Query, usize)> {
    queries().into_iter().flat_map(|query| (0..MOMENTS).map(move |moment| (query.clone(), moment)))
}

fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// As PIL and OpenCV write a mask of 0 and 255.
fn grey(mask: &Mask) -> Vec<u8> {
    let (width, height) = mask.size();
    png(GrayImage::from_fn(width, height, |col, row| Luma([255 * u8::from(mask.get(col, row))])))
}

/// As `torchvision.utils.save_image` writes one channel: three.
fn rgb(mask: &Mask) -> Vec<u8> {
    let (width, height) = mask.size();
    png(RgbImage::from_fn(width, height, |col, row| Rgb([255 * u8::from(mask.get(col, row)); 3])))
}

fn gaussian_grouping() -> Originals {
    let originals = Originals::new();
    let run = format!("theirs/{SCENE}/test/ours_30000_text");
    for (query, moment) in pairs() {
        // `render_lerf_mask.py`: the index of a view is not padded here, and is elsewhere.
        let file = format!("{run}/test_mask/{moment}/{}.png", query.text);
        originals.dir.write(&file, grey(&originals.guess(&query, moment)));
        originals.dir.write(&format!("{run}/objects_feature16/{moment:05}.png"), "");
        originals.dir.write(&format!("{run}/grounded-sam---{}.png", query.text), "");
    }
    originals
}

#[test]
fn gaussian_grouping_goes_through() {
    let originals = gaussian_grouping();
    originals.import("gaussian-grouping", "");
    originals.agrees("gaussian-grouping", "gaussian-grouping", "gaussian-grouping");
}

fn opengaussian() -> Originals {
    let originals = Originals::new();
    for (query, moment) in pairs() {
        for folder in ["renders_cluster", "renders_cluster_silhouette"] {
            let folder = format!("theirs/{SCENE}/text2obj/ours_70000/{folder}");
            let file = format!("{folder}/frame_{:05}_{}.png", 12 * moment, query.text);
            originals.dir.write(&file, rgb(&originals.guess(&query, moment)));
        }
    }
    originals
}

#[test]
fn opengaussian_goes_through() {
    let originals = opengaussian();
    originals.import("opengaussian", "");
    originals.agrees("opengaussian", "langsplat", "opengaussian");
}

fn refersplat() -> Originals {
    let originals = Originals::new();
    for (query, moment) in pairs() {
        let mask = originals.guess(&query, moment);
        for epoch in 0..5 {
            // Earlier epochs found nothing.
            let found: Vec<f32> =
                mask.to_bools().into_iter().map(|inside| f32::from(u8::from(inside && epoch == 4))).collect();
            let run = format!("theirs/{SCENE}/testccc/ours_{epoch}");
            let stem = format!("{:05}{}", 12 * moment, query.text);
            originals.dir.write(&format!("{run}/renders_npy/{stem}.npy"), npy(&[96, 128, 1], &found));
            originals.dir.write(&format!("{run}/renders/{stem}.png"), rgb(&mask));
        }
    }
    originals
}

#[test]
fn refersplat_goes_through() {
    let originals = refersplat();
    let run = originals.import("refersplat", "");
    assert_eq!(run["assumptions"][format!("{SCENE}: iteration")], "4, of 0, 1, 2, 3, 4");
    originals.agrees("refersplat", "langsplat", "refersplat");
}

/// A template for a model a moment, as [presets](../docs/import/presets.md) gives it.
fn of_moments(preset: &str) -> String {
    let start = format!("l4d import {preset} theirs/ --template ");
    let presets = shipped("docs/import/presets.md");
    let template = presets.lines().find_map(|line| line.trim().strip_prefix(&start)).unwrap();
    format!("--template '{}'", template.trim_matches('"'))
}

#[test]
fn opengaussian_and_refersplat_trained_a_moment_at_a_time_go_through() {
    let (clusters, maps) = (opengaussian(), refersplat());
    for originals in [&clusters, &maps] {
        originals.dir.remove("theirs");
    }
    for (query, moment) in pairs() {
        let of_moment = format!("theirs/{SCENE}_{:04}", 12 * moment);
        let run = format!("{of_moment}/text2obj/ours_70000/renders_cluster_silhouette");
        let mask = clusters.guess(&query, moment);
        clusters.dir.write(&format!("{run}/frame_00001_{}.png", query.text), rgb(&mask));
        let numbers: Vec<f32> =
            mask.to_bools().into_iter().map(|inside| f32::from(u8::from(inside))).collect();
        for epoch in 0..5 {
            let file = format!("{of_moment}/testccc/ours_{epoch}/renders_npy/00001{}.npy", query.text);
            maps.dir.write(&file, npy(&[96, 128, 1], &numbers));
        }
    }
    clusters.import("opengaussian", &of_moments("opengaussian"));
    clusters.agrees("opengaussian", "langsplat", "opengaussian");
    maps.import("refersplat", &of_moments("refersplat"));
    maps.agrees("refersplat", "langsplat", "refersplat");
}

/// A folder with what a method wrote as MeViS has it.
pub(crate) fn folder() -> Dir {
    mevis().dir
}

fn mevis() -> Originals {
    let originals = Originals::new();
    for (query, moment) in pairs() {
        let file = format!("theirs/{SCENE}/{}/{moment:05}.png", query.id.number);
        originals.dir.write(&file, grey(&originals.guess(&query, moment)));
    }
    originals
}

#[test]
fn mevis_goes_through() {
    let originals = mevis();
    originals.import("mevis", "");
    originals.agrees("mevis", "mevis", "mevis");
}

fn davis() -> Originals {
    let originals = Originals::new();
    for moment in 0..MOMENTS {
        let cut = originals.cut(1, moment);
        let pixels = (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |col| (col, row)));
        let number = |(col, row)| if row < cut || row >= 64 { id_at(col, row, moment) } else { 0 };
        let numbers: Vec<u8> = pixels.map(number).map(|id| if id == 1001 { 0 } else { id as u8 }).collect();
        // Sequences of the export are cameras, and a method may track in all of them.
        for view in ["cam00", "cam08"] {
            let shown = if view == "cam08" { numbers.clone() } else { vec![0; numbers.len()] };
            let file = format!("theirs/{SCENE}_{view}/{moment:05}.png");
            originals.dir.write(&file, ids::encode_palette(WIDTH, HEIGHT, &shown));
        }
    }
    originals
}

#[test]
fn davis_goes_through() {
    let originals = davis();
    originals.import("davis", "");
    originals.agrees("davis", "davis", "davis");
}

/// Widths of the made-up embeddings of sentences, and of what is between them and a latent.
const EMBEDDING: usize = 12;

/// An autoencoder: a layer that parts positive from negative, then one that spreads them.
struct Autoencoder {
    inputs: usize,
    spread: Vec<f32>,
}

impl Autoencoder {
    fn new(inputs: usize, seed: u64) -> Self {
        let mut noise = Noise::new(seed);
        let number = |_| noise.below(2000) as f32 / 1000.0 - 1.0;
        Self { inputs, spread: (0..EMBEDDING * 2 * inputs).map(number).collect() }
    }

    /// What a latent means, of length 1.
    fn decode(&self, latent: &[f32]) -> Vec<f32> {
        let parts: Vec<f32> = [1.0, -1.0]
            .into_iter()
            .flat_map(|sign| latent.iter().map(move |x| (sign * x).max(0.0)))
            .collect();
        let rows = self.spread.chunks_exact(2 * self.inputs);
        unit(rows.map(|row| row.iter().zip(&parts).map(|(weight, part)| weight * part).sum()).collect())
    }

    /// Its weights, the encoder of features of this width included, as `torch.save` writes a state dict.
    fn weights(&self, features: usize) -> Vec<u8> {
        let (inputs, hidden) = (self.inputs, 2 * self.inputs);
        let sign = |index: usize| match (index / inputs, index % inputs) {
            (row, col) if row == col => 1.0,
            (row, col) if row == col + inputs => -1.0,
            _ => 0.0,
        };
        pth(&[
            ("encoder.0.weight", &[inputs, features], vec![0.01; inputs * features]),
            ("encoder.0.bias", &[inputs], vec![0.0; inputs]),
            ("decoder.0.weight", &[hidden, inputs], (0..hidden * inputs).map(sign).collect()),
            ("decoder.0.bias", &[hidden], vec![0.0; hidden]),
            ("decoder.2.weight", &[EMBEDDING, hidden], self.spread.clone()),
            ("decoder.2.bias", &[EMBEDDING], vec![0.0; EMBEDDING]),
        ])
    }
}

fn unit(mut vector: Vec<f32>) -> Vec<f32> {
    let length = vector.iter().map(|x| x * x).sum::<f32>().sqrt();
    vector.iter_mut().for_each(|x| *x /= length);
    vector
}

/// What a thing is as a latent.
fn direction(id: u32) -> [f32; 3] {
    match id {
        1 => [1.0, 0.0, 0.0],
        2 => [0.0, 1.0, 0.0],
        3 => [0.0, 0.0, 1.0],
        1001 => [-1.0, 0.0, 0.0],
        _ => [0.0, -0.6, -0.8],
    }
}

/// A render of latents of a level: blended, so shorter than 1, and never quite the same.
fn latents(level: u64, moment: usize) -> Vec<u8> {
    let mut noise = Noise::new(100 * level + moment as u64 + 1);
    let share = [0.0, 0.7, 0.9, 0.6][level as usize];
    let pixels = (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |col| (col, row)));
    let numbers = pixels.flat_map(|(col, row)| direction(id_at(col, row, moment)));
    let numbers: Vec<f32> = numbers.map(|x| share * x + noise.below(1000) as f32 / 2500.0 - 0.2).collect();
    npy(&[96, 128, 3], &numbers)
}

/// A render of latents of time: something happens at moments 3 to 5, and seems to before.
fn latents_of_time(moment: usize) -> Vec<u8> {
    let mut noise = Noise::new(moment as u64 + 77);
    let share = [0.2, 0.25, 0.8, 0.9, 0.85, 0.9, 0.3, 0.2, 0.25][moment];
    let pixel = [share, 1.0 - share, 0.1, 0.0, 0.2, 0.0_f32];
    let pixels = (0..WIDTH * HEIGHT).flat_map(|_| pixel);
    let numbers: Vec<f32> = pixels.map(|x| x + noise.below(1000) as f32 / 5000.0 - 0.1).collect();
    npy(&[96, 128, 6], &numbers)
}

/// Sentences as CLIP and E5 would see them, in files for `--texts` and `--time-texts`.
fn write_texts(dir: &Dir, clip: &Autoencoder, video: &Autoencoder) {
    let sum = |ids: &[u32]| -> Vec<f32> {
        let parts: Vec<Vec<f32>> = ids.iter().map(|&id| clip.decode(&direction(id))).collect();
        unit((0..EMBEDDING).map(|place| parts.iter().map(|part| part[place]).sum()).collect())
    };
    let texts: Vec<String> = queries().into_iter().map(|query| query.text).chain([BASE.to_owned()]).collect();
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let sentences: [&[u32]; 6] = [&[1], &[2], &[1, 1001], &[1, 2], &[3], &[1, 3]];
    let phrases: [&[u32]; 4] = [&[1001], &[0], &[0, 1001], &[3, 0]];
    let vectors = |of: &[&[u32]]| {
        npy(&[of.len(), EMBEDDING], &of.iter().flat_map(|ids| sum(ids)).collect::<Vec<f32>>())
    };
    let archive = npz(&[
        ("queries", npy_texts(&texts)),
        ("positives", vectors(&sentences)),
        ("negatives", vectors(&phrases)),
    ]);
    dir.write("clip.npz", archive);
    let tipping = video.decode(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let archive = npz(&[("queries", npy_texts(&texts[2..3])), ("positives", npy(&[1, EMBEDDING], &tipping))]);
    dir.write("e5.npz", archive);
}

const TEXTS: &str = "--texts clip.npz";
const BOTH_TEXTS: &str = "--texts clip.npz --time-texts e5.npz";

/// What LangSplat's training and `render.py` leave of a scene whose held-out camera is its training set.
fn langsplat() -> Originals {
    let originals = Originals::new();
    let clip = Autoencoder::new(3, 5);
    write_texts(&originals.dir, &clip, &Autoencoder::new(6, 6));
    for (level, moment) in (1..=3).flat_map(|level| (0..MOMENTS).map(move |moment| (level, moment))) {
        let run = format!("theirs/output/{SCENE}_{level}/train/ours_None");
        originals.dir.write(&format!("{run}/renders_npy/{moment:05}.npy"), latents(level, moment));
        originals.dir.write(&format!("{run}/gt_npy/{moment:05}.npy"), "");
    }
    originals.dir.write(&format!("theirs/autoencoder/ckpt/{SCENE}/ae_ckpt/best_ckpt.pth"), clip.weights(512));
    originals
}

#[test]
fn langsplat_goes_through() {
    let originals = langsplat();
    let line = format!("import langsplat theirs --profile tiny {TEXTS}");
    let run = originals.dir.json(&line);
    // Its evaluator reads the split `train`: there is no other without `--eval`.
    assert_eq!(codes(&run), ["L4D580"], "{run:#}");
    let said = &recorded()["langsplat"];
    let recount = &run["recounted"][SCENE]["langsplat"]["measures"];
    for measure in ["miou", "localisation"] {
        let (ours, theirs) = (recount[measure].as_f64().unwrap(), said[measure].as_f64().unwrap());
        // Four decimals are what its log has.
        assert!((ours - theirs).abs() < 1e-4, "{measure}: {ours} is not {theirs}");
    }
}

#[test]
fn masks_that_langsplat_chose_go_through() {
    let originals = Originals::new();
    let out = format!("theirs/eval_result/{SCENE}");
    for (query, moment) in pairs() {
        let mask = originals.guess(&query, moment);
        let folder = format!("{out}/{:05}", moment + 1);
        originals.dir.write(&format!("{folder}/chosen_{}.png", query.text), grey(&mask));
        for level in 0..3 {
            originals.dir.write(&format!("{folder}/heatmap/{}_{level}.png", query.text), "");
        }
        originals.dir.write(&format!("{out}/gt/frame_{:05}/{}.jpg", moment + 1, query.text), "");
    }
    let log = "2026-01-01 00:00:00,000 - tabletop_cups - INFO - ";
    let log =
        format!("{log}trunc thresh: 0.4\n{log}iou chosen: 0.5000\n{log}Localization accuracy: 0.2500\n");
    originals.dir.write(&format!("{out}/20260101_000000.log"), log);
    let run = originals.import("langsplat-masks", "");
    assert_eq!(run["claimed"][format!("{SCENE}: iou chosen")], 0.5);
    originals.agrees("langsplat-masks", "langsplat", "opengaussian");
    // One data set a moment, as the labels of `l4d export --format lerf-ovs` are.
    originals.dir.remove("theirs");
    for (query, moment) in pairs() {
        let folder = format!("theirs/eval_result/{SCENE}_{:04}/00001", 12 * moment);
        let mask = originals.guess(&query, moment);
        originals.dir.write(&format!("{folder}/chosen_{}.png", query.text), grey(&mask));
    }
    originals.import("langsplat-per-frame-masks", "");
    assert_eq!(
        originals.score("langsplat-per-frame-masks", "langsplat"),
        originals.score("langsplat-masks", "langsplat")
    );
}

/// The image of a moment: Roboflow numbers images in no order.
fn image_of(moment: usize) -> usize {
    (2 * moment + 3) % MOMENTS
}

/// What 4D LangSplat's training and `render.py` leave of a scene of HyperNeRF, with its annotations.
fn four_d_langsplat() -> Originals {
    let originals = Originals::new();
    let (clip, video) = (Autoencoder::new(3, 5), Autoencoder::new(6, 6));
    write_texts(&originals.dir, &clip, &video);
    let output = format!("theirs/output/hypernerf/{SCENE}");
    let write = |level: u64, iteration: u32, moment: usize, bytes: Vec<u8>| {
        let run = format!("{output}/{SCENE}_{level}/video_lang/ours_{iteration}");
        originals.dir.write(&format!("{run}/renders_npy/{moment:05}.npy"), bytes);
        originals.dir.write(&format!("{run}/renders/{moment:05}.png"), "");
        let colours =
            format!("{output}/{SCENE}_{level}/video_rgb/ours_{iteration}/renders_npy/{moment:05}.npy");
        originals.dir.write(&colours, npy(&[1, 1, 3], &[0.9; 3]));
    };
    for moment in 0..MOMENTS {
        (1..=3).for_each(|level| write(level, 10_000, moment, latents(level, moment)));
        write(0, 20_000, moment, latents_of_time(moment));
    }
    originals.dir.write(&format!("{output}/clip_best_ckpt.pth"), clip.weights(512));
    originals.dir.write(&format!("{output}/video_best_ckpt.pth"), video.weights(4096));

    let annotations = format!("theirs/data/hypernerf/{SCENE}/annotations");
    let categories = [
        ("The red cup", vec![1]),
        ("the blue cup", vec![2]),
        (BASE, vec![1]),
        ("both cups", vec![1, 2]),
        ("the pear", vec![3]),
    ];
    let (mut images, mut drawn) = (Vec::new(), Vec::new());
    for moment in 0..MOMENTS {
        let file = format!("{:06}_png.rf.0a1b2c{moment}.jpg", moment + 1);
        images.push(json!({"id": image_of(moment), "license": 1, "file_name": &file, "height": HEIGHT, "width": WIDTH}));
        originals
            .dir
            .write(&format!("{annotations}/train/{file}"), encode_jpeg(&RgbImage::new(WIDTH, HEIGHT)));
        for (category, (_, things)) in categories.iter().enumerate() {
            for [left, right, top, bottom] in things.iter().filter_map(|&id| place(id, moment)) {
                let corners = [left, top, right - 1, top, right - 1, bottom - 1, left, bottom - 1];
                drawn.push(json!({
                    "id": drawn.len(), "image_id": image_of(moment), "category_id": category + 1, "iscrowd": 0,
                    "bbox": [left, top, right - left, bottom - top], "segmentation": [corners],
                }));
            }
        }
    }
    images.sort_by_key(|image| image["id"].as_u64());
    let named = |(index, (name, _)): (usize, &(&str, Vec<u32>))| json!({"id": index + 1, "name": name, "supercategory": "things"});
    let mut listed = vec![json!({"id": 0, "name": "things", "supercategory": "none"})];
    listed.extend(categories.iter().enumerate().map(named));
    let document = json!({"images": images, "categories": listed, "annotations": drawn});
    originals.dir.write(&format!("{annotations}/train/_annotations.coco.json"), document.to_string());
    let intervals = json!({BASE: {"the red cup while it tips": [[3, 5]]}});
    originals.dir.write(&format!("{annotations}/video_annotations.json"), intervals.to_string());
    originals
}

#[test]
fn four_d_langsplat_goes_through() {
    let originals = four_d_langsplat();
    originals.import("4d-langsplat", BOTH_TEXTS);
    originals.agrees("4d-langsplat", "4d-langsplat", "4d-langsplat");

    // Neu3D: the held-out camera is drawn as `test`, a spiral as `video`, and 300 moments whatever the clip has.
    let hypernerf = originals.dir.tree("results/4d-langsplat/masks");
    originals.dir.rename("theirs/output/hypernerf", "theirs/output/neu3d");
    let output = originals.dir.path(format!("theirs/output/neu3d/{SCENE}"));
    for level in 1..=3 {
        let run = output.join(format!("{SCENE}_{level}"));
        fs::create_dir_all(run.join("test_lang")).unwrap();
        fs::rename(run.join("video_lang/ours_10000"), run.join("test_lang/ours_10000")).unwrap();
        let spiral = run.join("video_lang/ours_10000/renders_npy");
        fs::create_dir_all(&spiral).unwrap();
        fs::write(spiral.join("00000.npy"), latents(level, 4)).unwrap();
    }
    for run in [
        "_1/test_lang/ours_10000",
        "_2/test_lang/ours_10000",
        "_3/test_lang/ours_10000",
        "_0/video_lang/ours_20000",
    ] {
        let folder = output.join(format!("{SCENE}{run}/renders_npy"));
        for moment in MOMENTS..300 {
            fs::hard_link(folder.join("00008.npy"), folder.join(format!("{moment:05}.npy"))).unwrap();
        }
    }
    let run = originals.import("4d-langsplat", BOTH_TEXTS);
    assert_eq!(originals.dir.tree("results/4d-langsplat/masks"), hypernerf);
    let assumed = |topic: &str| run["assumptions"][format!("{SCENE}: {topic}")].clone();
    assert_eq!(assumed("split"), "test, of test, video");
    assert_eq!(assumed("pictures"), "9 to 299 repeat the last frame and are left out");
}

#[test]
fn masks_that_4d_langsplat_chose_go_through_with_the_annotations_that_were_exported() {
    let originals = Originals::new();
    let export = "export tabletop_cups --profile tiny --format 4d-langsplat-annotations";
    originals.dir.succeed(format!("{export} --out theirs/data/neu3d/{SCENE}"));
    let out = format!("theirs/eval/eval_result/{SCENE}/{SCENE}/20260101_000000-default");
    let base = Query { text: BASE.to_owned(), ..queries()[0].clone() };
    for (query, moment) in pairs().chain((0..MOMENTS).map(|moment| (base.clone(), moment))) {
        // Its reader makes pictures of Neu3D 1352x1014. A prompt has a mask where it is annotated.
        if target::union(&originals.truth, &query.referents, 12 * moment as u32).is_some() {
            let mask = grey(&originals.guess(&query, moment).resized_nearest(1352, 1014));
            for kind in ["chosen_", "chosen_for_video_"] {
                originals.dir.write(&format!("{out}/{:05}/{kind}{}.png", moment + 1, query.text), &mask);
            }
        }
    }
    let log = "2026-01-01 00:00:00,000 - x - INFO - key:The red cup, mean_iou:0.5\n\
               key:cup red, mean_iou:0.2\nkey:the pear, mean_iou:0.3\nMean IoU: 0.33333\n";
    originals.dir.write(&format!("{out}/20260101_000000.log"), log);
    let line = "import 4d-langsplat-masks theirs --profile tiny";
    let run = originals.dir.json(line);
    // The blue cup is not annotated once it left.
    assert_eq!(codes(&run), ["L4D548"], "{run:#}");
    assert_eq!(
        run["assumptions"][format!("{SCENE}: base objects")],
        "left out, since no query is one: cup red"
    );
    let claimed = |claim: &str| run["claimed"][format!("{SCENE}: {claim}")].as_f64().unwrap();
    assert_eq!((claimed("mean iou"), claimed("mean iou without base objects")), (0.33333, 0.4));
    let answers = originals.dir.value(&format!("results/4d-langsplat-masks/masks/{SCENE}/001.json"));
    let first = Mask::decode(answers["frames"]["0000"].as_str().unwrap(), WIDTH, HEIGHT).unwrap();
    assert_eq!(first, originals.guess(&queries()[0], 0), "up and down again is the same");
}

#[test]
fn nothing_is_claimed_before_nothing_was_written() {
    let originals = Originals::new();
    let out = format!("theirs/eval_result/{SCENE}");
    originals.dir.write(&format!("{out}/00001/chosen_the yellow cup.png"), grey(&Mask::full(WIDTH, HEIGHT)));
    originals.dir.write(&format!("{out}/20260101_000000.log"), "iou chosen: 0.5000\n");
    let run = originals.dir.run("import langsplat-masks theirs --profile tiny");
    run.says(1, &["L4D544", "nothing was written"]);
    assert!(!run.stdout.contains("claimed") && !run.stdout.contains("recount"), "{run}");
    // Flags that hints name are there.
    let help = originals.dir.succeed("import --help").stdout + &originals.dir.succeed("score --help").stdout;
    let foreign = ["--feature_level", "--include_feature", "--eval", "--model", "--queries", "--format"];
    for file in files_below(&root().join("crates/l4d-import/src/results")) {
        let text = fs::read_to_string(&file).unwrap();
        for flag in text
            .split_whitespace()
            .filter_map(|word| word.trim_start_matches(['"', '(', '`']).strip_prefix("--"))
        {
            let end =
                flag.find(|c: char| !(c.is_ascii_lowercase() || "_-".contains(c))).unwrap_or(flag.len());
            let flag = format!("--{}", &flag[..end]);
            assert!(help.contains(&flag) || foreign.contains(&flag.as_str()), "{}: {flag}", file.display());
        }
    }
}

/// Runs the evaluators themselves on these files, and imports the masks that they chose.
#[test]
#[ignore = "needs checkouts of seven repositories, and Python with PyTorch (docs/import/verified.md)"]
fn the_originals_say_what_is_recorded() {
    type Write = fn() -> Originals;
    let methods: [(&str, Write); 7] = [
        ("gaussian-grouping", gaussian_grouping),
        ("opengaussian", opengaussian),
        ("refersplat", refersplat),
        ("mevis", mevis),
        ("davis", davis),
        ("langsplat", langsplat),
        ("4d-langsplat", four_d_langsplat),
    ];
    let checkouts = fs::canonicalize(std::env::var("L4D_ORIGINALS").unwrap()).unwrap();
    let mut said = serde_json::Map::new();
    for (method, write) in methods {
        let originals = write();
        let mut python = Command::new(std::env::var("L4D_ORIGINALS_PYTHON").unwrap());
        let name = method.replace("4d-", "four-d-");
        python.arg(root().join("tests/originals.py")).arg(name).arg(&checkouts).arg(originals.dir.path(""));
        let numbers: Value =
            serde_json::from_slice(&python.stderr(Stdio::inherit()).output().unwrap().stdout).unwrap();
        for (preset, protocol, measure, bound) in
            [("langsplat", "langsplat", "miou", 1e-4), ("4d-langsplat", "4d-langsplat", "miou", 1e-7)]
        {
            if preset == method {
                let run = originals.dir.json(format!("import {preset}-masks theirs --profile tiny"));
                // Masks are there where a prompt is annotated.
                assert_eq!(
                    codes(&run).into_iter().collect::<BTreeSet<_>>(),
                    BTreeSet::from(["L4D548"]),
                    "{run:#}"
                );
                let ours = run["recounted"][SCENE][protocol]["measures"][measure].as_f64().unwrap();
                assert!(
                    (ours - numbers[measure].as_f64().unwrap()).abs() < bound,
                    "{preset}: {ours} from chosen masks"
                );
            }
        }
        said.insert(method.to_owned(), numbers);
    }
    let said = Value::from(said);
    if std::env::var_os("UPDATE_ORIGINALS").is_some() {
        let text = serde_json::to_string_pretty(&said).unwrap() + "\n";
        fs::write(root().join("tests/data/originals.json"), text).unwrap();
    }
    for (method, numbers) in recorded().as_object().unwrap() {
        for (measure, number) in numbers.as_object().unwrap() {
            let now = said[method][measure].as_f64().unwrap();
            assert!((now - number.as_f64().unwrap()).abs() < 1e-9, "{method}, {measure}: {now}");
        }
    }
}
