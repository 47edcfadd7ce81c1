//! Losses, penalties and Adam against torch, and what they do with poison.

use std::collections::BTreeMap;

use l4d_splat::deform::{Bounds, DeformConfig, DeformationField, FieldGradients, Init};
use l4d_splat::optimise::{
    Adam, DepthGradient, Group, GroupUpdate, LearningRate, OptimiseError, PlaneWeights, RenderedDepth,
    depth_l1, l1, plane_penalty,
};
use serde::Deserialize;

use crate::fixtures::{
    Named, largest_difference, narrow, read, relative_difference, small_config, small_field,
};

#[derive(Debug, Deserialize)]
struct Fixture {
    l1: Pictures,
    depth: Vec<Depths>,
    planes: Planes,
    adam: Steps,
}

#[derive(Debug, Deserialize)]
struct Pictures {
    prediction: Vec<f64>,
    target: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

#[derive(Debug, Deserialize)]
struct Depths {
    sum_m: Vec<f64>,
    alpha: Vec<f64>,
    target_m: Vec<Option<f64>>,
    knee_m: f32,
    value: f64,
    sum_gradient: Vec<f64>,
    alpha_gradient: Vec<f64>,
}

#[derive(Debug, Deserialize)]
struct Planes {
    channels: usize,
    spatial_resolution: [usize; 3],
    time_resolution: usize,
    multires: Vec<u32>,
    weights: BTreeMap<String, f32>,
    tensors: BTreeMap<String, Named>,
    gradients: BTreeMap<String, Named>,
}

#[derive(Debug, Deserialize)]
struct Steps {
    first: f64,
    last: f64,
    steps: u64,
    start: Vec<f64>,
    rates: Vec<f64>,
    gradients: Vec<Vec<f64>>,
    trajectory: Vec<Vec<f64>>,
}

fn fixture() -> Fixture {
    read("optimise.json")
}

#[test]
fn l1_is_that_of_torch() {
    let Pictures { prediction, target, value, gradient } = fixture().l1;
    let mut found = vec![0.0; prediction.len()];
    let loss = l1(&narrow(&prediction), &narrow(&target), 1.0, &mut found).unwrap();
    assert!((loss - value).abs() < 1.0e-7);
    assert!(relative_difference(&found, &gradient) < 1.0e-6);
}

#[test]
fn depth_is_that_of_torch() {
    let cases = fixture().depth;
    assert_eq!(cases.len(), 2);
    for case in cases {
        let target: Vec<f32> =
            case.target_m.iter().map(|depth| depth.map_or(f32::INFINITY, |depth| depth as f32)).collect();
        let (sum_m, alpha) = (narrow(&case.sum_m), narrow(&case.alpha));
        let (mut by_sum, mut by_alpha) = (vec![0.0; sum_m.len()], vec![0.0; sum_m.len()]);
        let rendered = RenderedDepth { sum_m: &sum_m, alpha: &alpha };
        let gradient = DepthGradient { sum: &mut by_sum, alpha: &mut by_alpha };
        let loss = depth_l1(rendered, &target, case.knee_m, 1.0, gradient).unwrap();
        assert!((loss - case.value).abs() < 1.0e-6, "{loss} instead of {}", case.value);
        assert!(relative_difference(&by_sum, &case.sum_gradient) < 1.0e-4);
        assert!(relative_difference(&by_alpha, &case.alpha_gradient) < 1.0e-4);
    }
}

#[test]
fn plane_penalties_are_those_of_torch() {
    let planes = fixture().planes;
    let config = DeformConfig {
        channels: planes.channels,
        spatial_resolution: planes.spatial_resolution,
        time_resolution: planes.time_resolution,
        multires: planes.multires,
        width: 1,
        ..small_config()
    };
    let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
    let mut tensors = DeformationField::new(config.clone(), bounds, Init::Foreign, 0).unwrap().tensors();
    tensors.extend(crate::fixtures::tensors(&planes.tensors));
    let field = DeformationField::from_tensors(config, &tensors).unwrap();
    let weights = PlaneWeights {
        space: planes.weights["space"],
        time: planes.weights["time"],
        stillness: planes.weights["stillness"],
    };
    let mut gradients = field.zero_gradients();
    plane_penalty(&field, &weights, &mut gradients).unwrap();
    let found = field.gradient_tensors(&gradients);
    for (name, expected) in &planes.gradients {
        let difference = relative_difference(&found[name].data, &expected.data);
        assert!(difference < 1.0e-4, "`{name}` differs by {difference:e}");
    }
}

#[test]
fn adam_walks_as_that_of_torch() {
    let Steps { first, last, steps, start, rates, gradients, trajectory } = fixture().adam;
    assert_eq!(trajectory.len(), 8);
    let rate = LearningRate::log_linear(first, last, steps).unwrap();
    let mut adam = Adam { groups: vec![Group::new("all", rate, &[start.len()])] };
    let mut parameters = narrow(&start);
    for (step, (gradient, expected)) in gradients.iter().zip(&trajectory).enumerate() {
        let iteration = step as u64 + 1;
        assert!((rate.at(iteration) / rates[step] - 1.0).abs() < 1.0e-12);
        let gradient = narrow(gradient);
        let share = GroupUpdate { parameters: vec![&mut parameters], gradients: vec![&gradient] };
        adam.step(iteration, vec![share]).unwrap();
        let difference = largest_difference(&parameters, expected);
        assert!(difference < 1.0e-6, "step {iteration}: {difference:e}");
    }
}

#[test]
fn gradients_are_added_with_their_weight() {
    let prediction = [0.2, 0.9, 0.4, 0.4];
    let target = [0.5, 0.5, 0.4, 0.1];
    let mut gradient = [1.0; 4];
    let value = l1(&prediction, &target, -2.0, &mut gradient).unwrap();
    assert!((value - 0.25).abs() < 1.0e-7);
    assert_eq!(gradient, [1.5, 0.5, 1.0, 0.5]);
}

#[test]
fn equal_pictures_have_no_loss_and_no_gradient() {
    let picture: Vec<f32> = (0..300).map(|place| (place % 7) as f32 / 7.0).collect();
    let mut gradient = vec![0.0; 300];
    assert_eq!(l1(&picture, &picture, 1.0, &mut gradient).unwrap(), 0.0);
    assert!(gradient.iter().all(|value| *value == 0.0));
}

#[test]
fn nothing_to_compare_is_no_loss() {
    assert_eq!(l1(&[], &[], 1.0, &mut []).unwrap(), 0.0);
    let nothing_hit = [f32::INFINITY; 2];
    let rendered = RenderedDepth { sum_m: &[1.0; 2], alpha: &[0.5; 2] };
    let (mut sum, mut alpha) = ([0.0; 2], [0.0; 2]);
    let gradient = DepthGradient { sum: &mut sum, alpha: &mut alpha };
    assert_eq!(depth_l1(rendered, &nothing_hit, 0.0, 1.0, gradient).unwrap(), 0.0);
    assert_eq!([sum, alpha], [[0.0; 2]; 2]);
}

/// Calls with a number that is not finite at this place of the first list, and what they left of the gradient.
fn poisoned(place: usize, poison: f32) -> Vec<(Result<f64, OptimiseError>, Vec<f32>)> {
    let clean = [0.5; 24];
    let mut bad = clean;
    bad[place] = poison;
    let mut calls = Vec::new();
    for (prediction, target) in [(bad, clean), (clean, bad)] {
        let mut gradient = vec![7.0; 24];
        calls.push((l1(&prediction, &target, 1.0, &mut gradient), gradient));
    }
    for (sum_m, alpha, target) in [(bad, clean, clean), (clean, bad, clean), (clean, clean, bad)] {
        let (mut sum, mut by_alpha) = (vec![7.0; 24], vec![7.0; 24]);
        let rendered = RenderedDepth { sum_m: &sum_m, alpha: &alpha };
        let gradient = DepthGradient { sum: &mut sum, alpha: &mut by_alpha };
        let loss = depth_l1(rendered, &target, 0.1, 1.0, gradient);
        sum.extend(by_alpha);
        calls.push((loss, sum));
    }
    calls
}

#[test]
fn poison_is_named_and_touches_no_gradient() {
    for (place, poison) in [(0, f32::NAN), (17, f32::NEG_INFINITY), (23, f32::NAN)] {
        let calls = poisoned(place, poison);
        assert_eq!(calls.len(), 5);
        for (result, gradient) in calls {
            let message = result.unwrap_err().to_string();
            let is_named =
                ["value", "pixel"].iter().any(|what| message.contains(&format!("{what} {place} is")));
            assert!(is_named, "{message}");
            assert!(gradient.iter().all(|value| *value == 7.0));
        }
    }
}

#[test]
fn lists_that_do_not_belong_together_are_refused() {
    assert!(l1(&[0.0; 3], &[0.0; 4], 1.0, &mut [0.0; 3]).is_err());
    assert!(l1(&[0.0; 3], &[0.0; 3], 1.0, &mut [0.0; 2]).is_err());
    for target in [0.0, -1.0] {
        let rendered = RenderedDepth { sum_m: &[1.0], alpha: &[0.5] };
        let gradient = DepthGradient { sum: &mut [0.0], alpha: &mut [0.0] };
        assert!(depth_l1(rendered, &[target], 0.0, 1.0, gradient).is_err());
    }
}

#[test]
fn a_poisoned_plane_is_named_and_gradients_of_another_field_are_refused() {
    let mut field = small_field(small_config(), 1);
    let mut gradients: FieldGradients = field.zero_gradients();
    field.parameters_mut().planes[9][3] = f32::NAN;
    let message = plane_penalty(&field, &PlaneWeights::default(), &mut gradients).unwrap_err().to_string();
    assert!(message.starts_with("plane 3 of level 1: value 3 is NaN"), "{message}");
    assert_eq!(gradients, field.zero_gradients());
    let other = small_field(DeformConfig { channels: 3, ..small_config() }, 1);
    assert!(plane_penalty(&other, &PlaneWeights::default(), &mut gradients).is_err());
}
