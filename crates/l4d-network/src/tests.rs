//! A tiny network: computes what PyTorch computes, sees the same from any thread, and refuses what is damaged.

use std::path::{Path, PathBuf};

use l4d_formats::arrays;

use super::*;
use crate::segment::Pixels;

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn weights() -> Vec<u8> {
    std::fs::read(data("perception.onnx")).unwrap()
}

fn description() -> String {
    std::fs::read_to_string(data("perception.json")).unwrap()
}

fn network() -> Network {
    Network::load(weights(), &description()).unwrap()
}

/// An array of what PyTorch computed.
fn parity(folder: &Path, key: &str) -> (Vec<usize>, Vec<f32>) {
    let tensor = arrays::read(&folder.join("parity.npz"), Some(key)).unwrap();
    (tensor.shape.clone(), tensor.data.clone())
}

fn assert_near(ours: &[f32], theirs: &[f32], what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let scale = theirs.iter().fold(1.0, |most: f32, value| most.max(value.abs()));
    let worst = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst < 1e-4 * scale, "{what}: {worst} of {scale}");
}

/// A picture whose pixels are a function of their place.
fn picture(width: usize, height: usize) -> Picture {
    let colour = |at: usize| {
        let (row, column) = (at / width, at % width);
        let wave = |step: f32| 0.5 + 0.5 * (step * (row * 7 + column * 3) as f32).sin();
        [wave(0.05), wave(0.11), wave(0.017)]
    };
    Picture { width, height, colour: (0..width * height).flat_map(colour).collect() }
}

#[test]
fn computes_what_pytorch_computes() {
    assert_parity(&data(""));
}

/// `training/tests/test_training.py` trains some, exports them, and runs this.
#[test]
#[ignore = "needs a folder that l4d_network.export wrote, in L4D_WEIGHTS"]
fn computes_what_pytorch_computes_with_other_weights() {
    assert_parity(&PathBuf::from(std::env::var_os("L4D_WEIGHTS").expect("L4D_WEIGHTS names a folder")));
}

fn assert_parity(folder: &Path) {
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    let description = String::from_utf8(read("perception.json")).unwrap();
    let network = Network::load(read("perception.onnx"), &description).unwrap();
    let parity = |key: &str| parity(folder, key);
    let (shape, planar) = parity("picture");
    let (height, width) = (shape[1], shape[2]);
    let colour: Vec<f32> = (0..height * width)
        .flat_map(|at| [0, 1, 2].map(|channel| planar[channel * height * width + at]))
        .collect();
    let outputs = network.features(&colour, [width, height]).unwrap();
    assert_near(&outputs[0].values, &parity("pixels").1, "pixels");

    let half = [width / 2, height / 2];
    let (_, masks) = parity("masks");
    let size = half[0] * half[1];
    let labels: Vec<u32> = (0..size)
        .map(|at| (0..2).find(|object| masks[object * size + at] > 0.5).map_or(0, |object| object as u32 + 1))
        .collect();
    let rows = run::rows_of(&outputs, &labels, 2, &colour, [width, height]);
    assert_near(&rows.concat(), &parity("rows").1, "rows");

    let found = network.describe(&rows).unwrap();
    let kinds: Vec<f32> = found.iter().flat_map(|found| found.kinds.clone()).collect();
    let values: Vec<f32> = found.iter().flat_map(|found| found.values.clone()).collect();
    assert_near(&kinds, &parity("kinds").1, "kinds");
    assert_near(&values, &parity("values").1, "values");
}

#[test]
fn segments_are_those_of_python() {
    let network = network();
    let (shape, planes) = parity(&data(""), "pixels");
    let pixels = Pixels { width: shape[2], height: shape[1], planes: &planes };
    let centres = pixels.centres(network.description());
    let labels = pixels.labels(&centres, network.description().offset_px, [shape[2], shape[1]]);
    let (_, theirs) = parity(&data(""), "segments");
    let differ = labels.iter().zip(&theirs).filter(|(a, b)| **a != **b as u32).count();
    assert!(labels.iter().any(|label| *label > 0), "the fixture has no segment");
    assert_eq!(differ, 0);
}

#[test]
fn every_size_is_seen_and_the_same_from_any_thread() {
    let network = network();
    for (width, height) in [(8, 8), (128, 96), (2000, 2000), (1, 300), (0, 0)] {
        let picture = picture(width, height);
        let seen = network.look(&picture).unwrap();
        assert_eq!(seen.labels.len(), width * height);
        assert!(seen.labels.iter().all(|label| *label as usize <= seen.found.len()), "{width}x{height}");
        let again = std::thread::scope(|scope| {
            let looks: Vec<_> = (0..3).map(|_| scope.spawn(|| network.look(&picture).unwrap())).collect();
            looks.into_iter().map(|look| look.join().unwrap()).collect::<Vec<_>>()
        });
        assert!(again.iter().all(|other| *other == seen), "{width}x{height}");
    }
}

#[test]
fn colours_that_are_no_numbers_count_as_black() {
    let mut broken = picture(64, 48);
    broken.colour[300] = f32::NAN;
    broken.colour[301] = f32::INFINITY;
    let seen = network().look(&broken).unwrap();
    assert!(seen.found.iter().all(|found| found.kinds.iter().all(|kind| kind.is_finite())));
}

#[test]
fn damaged_weights_are_refused_with_a_hint() {
    let refused = |weights: Vec<u8>, json: &str| Network::load(weights, json).err().unwrap().to_string();
    let whole = weights();
    assert!(refused(whole[..whole.len() / 2].to_vec(), &description()).contains("damaged"));
    let mut flipped = whole.clone();
    flipped[2000] ^= 1;
    assert!(refused(flipped, &description()).contains("damaged"));
    let other = description().replace("l4d/perception/2", "l4d/perception/9");
    assert!(refused(whole.clone(), &other).contains("l4d/perception/9"));
    assert!(refused(whole.clone(), "{}").contains("take both files"));
    let short = description().replace("\"object\": 110", "\"object\": 50");
    assert!(refused(whole.clone(), &short).contains("object is 50"));
    // Weights that are whole, and no network: the digest fits, the parts are missing.
    let empty = Vec::new();
    let digest = l4d_data::digest::sha256_hex(&empty);
    let fits = description().replace(&l4d_data::digest::sha256_hex(&whole), &digest);
    assert!(refused(empty, &fits).contains("cannot be run"));
}
