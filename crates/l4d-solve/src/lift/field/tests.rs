//! The short way and the literal one give the same numbers.

use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::raster::{Cpu, RasterSettings, Rasterizer as _};
use l4d_splat::synthetic::Room;
use l4d_splat::view::View;

use super::learn::{Footage, Lesson};
use super::literal::{self, Shot};
use super::settings::{FieldSettings, Normalisation};
use crate::lift::canvas::Canvas;
use crate::lift::evidence::{Evidence, EvidenceFrame, EvidenceView};
use crate::lift::tree::Tree;

const FRAMES: [u32; 3] = [0, 48, 96];

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

fn settings(normalisation: Normalisation) -> FieldSettings {
    FieldSettings {
        width: 12,
        features: 5,
        sampled: 30,
        neighbours: 4,
        normalisation,
        ..FieldSettings::paper()
    }
}

/// A picture for the literal objective; pictures are numbered time by time, view by view.
fn shot(scene: &Scene, evidence: &Evidence, picture: usize, samples: &[u32], neighbours: usize) -> Shot {
    let (at, view) = (picture / 2, picture % 2);
    let seen = &evidence.views[view].frames[at];
    let time = seen.time;
    let splats = scene.model.at(time).unwrap();
    let cpu = Cpu::new();
    let projected = cpu.prepare(&splats, &seen.view, &RasterSettings::default()).unwrap();
    let pixels = (0..15 * 20).map(|pixel| {
        let (column, row) = (pixel % 20, pixel / 20);
        let shown = projected.contributors(column, row).unwrap();
        let shown = shown.iter().map(|one| (one.index as usize, f64::from(one.weight))).collect();
        (shown, seen.mask.get(column, row))
    });
    let nearest = Tree::new(splats.means().as_flattened(), 3).neighbours(neighbours, true);
    let near = |&sample: &u32| {
        (sample as usize, nearest[sample as usize].iter().map(|&(_, index)| index as usize).collect())
    };
    Shot { time, pixels: pixels.collect(), near: samples.iter().map(near).collect() }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most, number| most.max(number.abs()))
}

#[test]
fn loss_and_gradient_are_those_of_the_literal_objective() {
    let (scene, cpu, raster) = (scene(), Cpu::new(), RasterSettings::default());
    let canvas = Canvas { model: &scene.model, rasterizer: &cpu, raster: &raster, states: None };
    let evidence = evidence(&scene);
    for normalisation in [Normalisation::Paper, Normalisation::Code] {
        let settings = settings(normalisation);
        let mut lesson = Lesson::new(Footage::new(&canvas, &evidence).unwrap(), &settings).unwrap();
        for picture in [0, 3, 4] {
            let samples = lesson.samples(settings.sampled as usize);
            let (loss, slopes, bias) = lesson.slopes(&canvas, &settings, picture, &samples).unwrap();
            let gradient = literal::flat(&literal::layers(lesson.gradient(&slopes, bias)));
            let shot = shot(&scene, &evidence, picture, &samples, 4);
            let layers = literal::layers(&lesson.learner.network);
            let (expected_loss, expected) =
                literal::loss(&layers, &scene.model.gaussians.means, &shot, &settings);
            assert!((loss - expected_loss).abs() < 1e-5 * expected_loss, "{loss} {expected_loss}");
            let expected = literal::flat(&expected);
            let scale = largest(&expected);
            for (index, (found, expected)) in gradient.iter().zip(&expected).enumerate() {
                assert!((found - expected).abs() < 1e-4 * scale, "{index}: {found} {expected} of {scale}");
            }
        }
    }
}

#[test]
fn the_literal_gradient_is_that_of_central_differences() {
    let scene = scene();
    let evidence = evidence(&scene);
    let settings = settings(Normalisation::Code);
    let network = super::init::network(12, 5, 3);
    let samples: Vec<u32> = (70..120).collect();
    let shot = shot(&scene, &evidence, 2, &samples, 4);
    let means = &scene.model.gaussians.means;
    let mut layers = literal::layers(&network);
    let gradient = literal::flat(&literal::loss(&layers, means, &shot, &settings).1);
    let numbers = literal::flat(&layers);
    let scale = largest(&gradient);
    // Every 37th parameter, and all of the decoder.
    let last = numbers.len();
    for index in (0..last).step_by(37).chain(last - 12..last) {
        let mut at = |change: f64| {
            let mut changed = numbers.clone();
            changed[index] += change;
            literal::set(&mut layers, &changed);
            literal::loss(&layers, means, &shot, &settings).0
        };
        let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
        assert!((slope - gradient[index]).abs() < 1e-5 * scale, "{index}: {slope} {}", gradient[index]);
    }
}

#[test]
fn both_learn_alike() {
    let (scene, cpu, raster) = (scene(), Cpu::new(), RasterSettings::default());
    let canvas = Canvas { model: &scene.model, rasterizer: &cpu, raster: &raster, states: None };
    let evidence = evidence(&scene);
    let settings = FieldSettings { learning_rate: 2e-3, ..settings(Normalisation::Paper) };
    let mut lesson = Lesson::new(Footage::new(&canvas, &evidence).unwrap(), &settings).unwrap();
    let mut layers = literal::layers(&lesson.learner.network);
    let mut numbers = literal::flat(&layers);
    let zeros = vec![0.0; numbers.len()];
    let mut adam = literal::Adam { first: zeros.clone(), second: zeros, steps: 0 };
    let mut losses = Vec::new();
    for iteration in 0..60 {
        let picture = lesson.next_picture();
        let samples = lesson.samples(settings.sampled as usize);
        let (loss, slopes, bias) = lesson.slopes(&canvas, &settings, picture, &samples).unwrap();
        let shot = shot(&scene, &evidence, picture, &samples, 4);
        let (expected, gradient) = literal::loss(&layers, &scene.model.gaussians.means, &shot, &settings);
        assert!((loss - expected).abs() < 2e-3 * expected, "iteration {iteration}: {loss} {expected}");
        lesson.descend(&slopes, bias, iteration).unwrap();
        adam.step(&mut numbers, &literal::flat(&gradient), settings.learning_rate);
        literal::set(&mut layers, &numbers);
        losses.push(loss);
    }
    assert!(losses[59] < 0.7 * losses[0], "{} to {}", losses[0], losses[59]);
    let found = literal::flat(&literal::layers(&lesson.learner.network));
    let apart: f64 = found.iter().zip(&numbers).map(|(a, b)| (a - b).powi(2)).sum();
    let start = literal::flat(&literal::layers(&super::init::network(12, 5, settings.seed)));
    let way: f64 = start.iter().zip(&numbers).map(|(a, b)| (a - b).powi(2)).sum();
    assert!(apart < 1e-4 * way, "{apart} apart after a way of {way}");
}

#[test]
fn leaving_out_stays_within_its_bound() {
    let (scene, cpu, raster) = (scene(), Cpu::new(), RasterSettings::default());
    let canvas = Canvas { model: &scene.model, rasterizer: &cpu, raster: &raster, states: None };
    let evidence = evidence(&scene);
    let settings = settings(Normalisation::Paper);
    let left_out = 0.05;
    let mut lesson = Lesson::new(Footage::new(&canvas, &evidence).unwrap(), &settings).unwrap();
    let samples = lesson.samples(settings.sampled as usize);
    let (_, slopes, bias) = lesson.slopes(&canvas, &settings, 3, &samples).unwrap();
    let numbers = |gradient: &super::network::Network| literal::flat(&literal::layers(gradient));
    let exact = numbers(lesson.gradient(&slopes, bias));
    let steepest = (0..slopes.len()).fold(0.0_f64, |most, row| {
        let mut alone = vec![0.0; slopes.len()];
        alone[row] = 1.0;
        most.max(largest(&numbers(lesson.gradient(&alone, 0.0))))
    });
    let kept = lesson.keep_steep(&slopes, left_out, 3);
    assert!(
        kept.len() < slopes.len() && kept.len() > slopes.len() / 10,
        "{} of {}",
        kept.len(),
        slopes.len()
    );
    let fewer = numbers(lesson.gradient(&kept, bias));
    let off: Vec<f64> = exact.iter().zip(&fewer).map(|(a, b)| a - b).collect();
    let sum: f64 = slopes.iter().map(|slope| f64::from(slope.abs())).sum();
    let bound = left_out * sum * steepest;
    assert!(largest(&off) > 0.0 && largest(&off) <= bound, "{} of {bound}", largest(&off));
}
