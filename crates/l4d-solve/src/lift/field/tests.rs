//! The short way gives the numbers of the objective as the paper writes it (equations 2 to 6): all features blended, the
//! decoder behind the blend, softmax and logarithms of probabilities, in f64.

use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::neighbours::Tree;
use l4d_splat::raster::{Cpu, RasterSettings, Rasterizer as _, Reference};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;

use super::encoding::{PLACE, Places, TIME, time};
use super::learn::Training;
use super::{FieldSettings, Network};
use crate::lift::evidence::{Evidence, EvidenceFrame, EvidenceView};
use crate::lift::rendered_model::RenderedModel;

const FRAMES: [u32; 3] = [0, 48, 96];

const SETTINGS: FieldSettings = FieldSettings {
    iterations: 0,
    learning_rate: 2e-3,
    lambda_2d: 1.0,
    lambda_3d: 2.0,
    sampled: 30,
    neighbours: 4,
    width: 12,
    features: 5,
    seed: 0,
};

struct Scene {
    model: Model,
    views: Vec<View>,
}

/// A room of 120 Gaussians, of which the 12 of the first ball are meant.
fn scene() -> Scene {
    let room = Room { gaussians: 120, moving: 0.3, ..Room::small(9) };
    Scene { model: room.model().unwrap(), views: room.views([20, 15]).unwrap()[..2].to_vec() }
}

fn evidence(scene: &Scene) -> Evidence {
    let cpu = Cpu::new();
    let first_ball: Vec<f32> = (0..120).map(|row| f32::from(u8::from(row >= 84 && row % 3 == 0))).collect();
    let view = |(index, view): (usize, &View)| {
        let frame = |frame: u32| {
            let splats = scene.model.at(frame as f32 / 96.0).unwrap();
            let seen = cpu.prepare(&splats, view, &RasterSettings::default()).unwrap();
            let blend = seen.splat_features(&first_ball, 1).unwrap();
            let mask = Mask::from_fn(20, 15, |column, row| blend[(row * 20 + column) as usize] > 0.4);
            EvidenceFrame { frame, time: frame as f32 / 96.0, view: *view, mask }
        };
        EvidenceView { name: format!("cam{index:02}"), frames: FRAMES.map(frame).to_vec() }
    };
    Evidence { views: scene.views.iter().enumerate().map(view).collect() }
}

/// A picture: for each pixel the Gaussians in it with their weights, and whether it is inside; and sampled Gaussians,
/// each with its neighbours.
struct TrainingPicture {
    time: f32,
    pixels: Vec<(Vec<(usize, f64)>, bool)>,
    near: Vec<(usize, Vec<usize>)>,
}

/// Pictures are numbered time by time, view by view.
fn picture_of(scene: &Scene, evidence: &Evidence, picture: usize, samples: &[u32]) -> TrainingPicture {
    let seen = &evidence.views[picture % 2].frames[picture / 2];
    let splats = scene.model.at(seen.time).unwrap();
    let projected = Reference::scene(&splats.to_f64(), &seen.view, &RasterSettings::default()).unwrap();
    let pixels = (0..15 * 20).map(|pixel| {
        let (column, row) = (pixel % 20, pixel / 20);
        let shown = projected.contributors(column as usize, row as usize);
        (shown, seen.mask.get(column, row))
    });
    let nearest = Tree::new(splats.means().as_flattened(), 3).neighbours(4, true);
    let near = |&sample: &u32| {
        (sample as usize, nearest[sample as usize].iter().map(|&(_, index)| index as usize).collect())
    };
    TrainingPicture { time: seen.time, pixels: pixels.collect(), near: samples.iter().map(near).collect() }
}

/// Weights \[outputs\]\[inputs\] and biases of the five layers, the first with places and times side by side, the
/// decoder last.
fn layers(network: &Network) -> Vec<(Vec<Vec<f64>>, Vec<f64>)> {
    let wide = |list: &[f32]| list.iter().map(|&value| f64::from(value)).collect::<Vec<f64>>();
    let [from_place, from_time, first_bias, others @ ..] = &network.lists;
    let places = from_place.chunks(PLACE).zip(from_time.chunks(TIME));
    let first = places.map(|(place, time)| [wide(place), wide(time)].concat()).collect();
    let inputs = [network.width, network.width, network.width, network.features];
    let others = others.as_chunks::<2>().0.iter().zip(inputs);
    let others =
        others.map(|([weight, bias], inputs)| (weight.chunks(inputs).map(wide).collect(), wide(bias)));
    std::iter::once((first, wide(first_bias))).chain(others).collect()
}

fn apply((weight, bias): &(Vec<Vec<f64>>, Vec<f64>), input: &[f64]) -> Vec<f64> {
    let dot = |row: &Vec<f64>| row.iter().zip(input).map(|(a, b)| a * b).sum::<f64>();
    weight.iter().zip(bias).map(|(row, bias)| dot(row) + bias).collect()
}

fn softmax(logits: &[f64]) -> Vec<f64> {
    let powers: Vec<f64> = logits.iter().map(|logit| logit.exp()).collect();
    powers.iter().map(|power| power / powers.iter().sum::<f64>()).collect()
}

/// The objective with one parameter changed.
fn loss(
    network: &Network,
    (list, place, change): (usize, usize, f64),
    scene: &Scene,
    picture_of: &TrainingPicture,
) -> f64 {
    let mut layers = layers(network);
    // The two lists of the first layer are one matrix.
    let (layer, weight) = (list.saturating_sub(1) / 2, list < 2 || list % 2 == 1);
    let (inputs, offset) = match list {
        0 => (PLACE, 0),
        1 => (TIME, PLACE),
        _ => (layers[layer].0[0].len(), 0),
    };
    match weight {
        true => layers[layer].0[place / inputs][offset + place % inputs] += change,
        false => layers[layer].1[place] += change,
    }

    let places = Places::new(&scene.model.gaussians.means);
    let phi = |gaussian: usize| {
        let mut input = Vec::new();
        places.of(&[gaussian as u32], &mut input);
        let input: Vec<f64> =
            input.iter().chain(&time(picture_of.time)).map(|&value| f64::from(value)).collect();
        let rectified = |layer, input: &[f64]| -> Vec<f64> {
            apply(layer, input).into_iter().map(|value| value.max(0.0)).collect()
        };
        apply(&layers[3], &layers[..3].iter().fold(input, |input, layer| rectified(layer, &input)))
    };
    let features: Vec<Vec<f64>> = (0..120).map(phi).collect();

    let mut loss_2d = 0.0;
    for (contributions, inside) in &picture_of.pixels {
        let mut blended = vec![0.0; 5];
        for &(gaussian, weight) in contributions {
            blended.iter_mut().zip(&features[gaussian]).for_each(|(sum, value)| *sum += weight * value);
        }
        loss_2d -= softmax(&apply(&layers[4], &blended))[usize::from(*inside)].ln();
    }
    let identities: Vec<Vec<f64>> =
        features.iter().map(|feature| softmax(&apply(&layers[4], feature))).collect();
    let pairs =
        picture_of.near.iter().flat_map(|(sample, near)| near.iter().map(move |other| (*sample, *other)));
    let divergence = |(sample, other): (usize, usize)| {
        let both = identities[sample].iter().zip(&identities[other]);
        both.map(|(p, q)| p * (p / q).ln()).sum::<f64>()
    };
    let divergences: Vec<f64> = pairs.map(divergence).collect();
    SETTINGS.lambda_2d * loss_2d / picture_of.pixels.len() as f64
        + SETTINGS.lambda_3d * divergences.iter().sum::<f64>() / divergences.len() as f64
}

#[test]
fn loss_and_gradient_are_those_of_the_objective_as_it_is_written() {
    let (scene, cpu, raster) = (scene(), Cpu::new(), RasterSettings::default());
    let rendered = RenderedModel { model: &scene.model, rasterizer: &cpu, raster: &raster, states: None };
    let evidence = evidence(&scene);
    let mut training = Training::new(&rendered, &evidence, &SETTINGS).unwrap();
    for picture in [0, 3, 4] {
        let samples = training.samples();
        let (found, slopes) = training.slopes(picture, &samples).unwrap();
        let gradient = training.gradient(&slopes).clone();
        let picture_of = picture_of(&scene, &evidence, picture, &samples);
        let at = |list, place, change| loss(&training.network, (list, place, change), &scene, &picture_of);
        let expected = at(0, 0, 0.0);
        assert!((found - expected).abs() < 1e-5 * expected, "{found} {expected}");
        let steepest = gradient.lists.iter().flatten().fold(0.0_f32, |most, slope| most.max(slope.abs()));
        for (list, slopes) in gradient.lists.iter().enumerate() {
            // Every 37th parameter, and all of the short lists.
            for place in (0..slopes.len()).step_by(if slopes.len() < 13 { 1 } else { 37 }) {
                let expected = (at(list, place, 1e-5) - at(list, place, -1e-5)) / 2e-5;
                let off = (f64::from(slopes[place]) - expected).abs();
                assert!(off < 1e-4 * f64::from(steepest), "{list} {place}: {} {expected}", slopes[place]);
            }
        }
    }
}

#[test]
fn a_step_goes_down_each_derivative_by_the_rate_and_many_bring_the_loss_down() {
    let (scene, cpu, raster) = (scene(), Cpu::new(), RasterSettings::default());
    let rendered = RenderedModel { model: &scene.model, rasterizer: &cpu, raster: &raster, states: None };
    let evidence = evidence(&scene);
    let mut training = Training::new(&rendered, &evidence, &SETTINGS).unwrap();
    let mut losses = Vec::new();
    for iteration in 0..60 {
        let (picture, samples) = (training.next_picture(), training.samples());
        let (loss, slopes) = training.slopes(picture, &samples).unwrap();
        let gradient = training.gradient(&slopes).clone();
        let before = training.network.clone();
        training.descend(&slopes, iteration).unwrap();
        losses.push(loss);
        // Adam's first step is the rate against the sign of the derivative, however steep that is.
        let lists = training.network.lists.iter().flatten().zip(before.lists.iter().flatten());
        for ((after, before), slope) in lists.zip(gradient.lists.iter().flatten()) {
            let off = after - before + 2e-3 * slope.signum();
            assert!(iteration > 0 || slope.abs() < 1e-8 || off.abs() < 1e-5, "{before} {after} {slope}");
        }
    }
    assert!(losses[59] < 0.7 * losses[0], "{} to {}", losses[0], losses[59]);
}
