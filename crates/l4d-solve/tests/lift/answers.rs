//! What can be done with an answer.

use std::ops::ControlFlow;

use l4d_masks::Mask;
use l4d_solve::lift::edit::{extract, highlight, remove};
use l4d_solve::lift::{
    Canvas, ClosedSettings, FieldSettings, Layer, LiftError, LiftSettings, ModelStates, lift, masks,
};
use l4d_splat::Model;
use l4d_splat::model::time_of_frame;
use l4d_splat::raster::Rasterizer as _;

use crate::fixture::{FRAMES, Scene, as_it_is, empty};

#[test]
fn many_answers_at_once_are_those_of_one_after_the_other() {
    let scene = Scene::new();
    let evidence = scene.evidence(4, as_it_is);
    let field = FieldSettings { iterations: 5, width: 16, ..FieldSettings::paper() };
    let some: Vec<Layer> = [
        LiftSettings::Closed(ClosedSettings::robust()),
        LiftSettings::Field(field),
        LiftSettings::Field(FieldSettings { seed: 5, ..field }),
    ]
    .iter()
    .map(|settings| scene.lift(&evidence, settings).unwrap().layer_at(&scene.model, 0.3).unwrap())
    .collect();
    let splats = scene.model.at(0.3).unwrap();
    let view = &scene.views[8];
    let projected = scene.cpu.prepare(&splats, view, &scene.raster).unwrap();
    for count in [0, 1, 10, 100] {
        let layers: Vec<&Layer> = (0..count).map(|index| &some[index % 3]).collect();
        let together = masks(projected.as_ref(), view, &layers).unwrap();
        assert_eq!(together.len(), count);
        for (layer, mask) in layers.iter().zip(&together) {
            assert_eq!(*mask, layer.mask(projected.as_ref(), view).unwrap());
        }
    }
}

#[test]
fn what_answers_share_changes_none_of_them() {
    let scene = Scene::new();
    let shared = ModelStates::at(FRAMES.map(time_of_frame));
    let together = Canvas { states: Some(&shared), ..scene.canvas() };
    let late = |_: usize, frame: u32, mask: Mask| if frame < 48 { empty() } else { mask };
    let settings = LiftSettings::Closed(ClosedSettings::robust());
    for evidence in [scene.evidence(8, as_it_is), scene.evidence(8, late), scene.evidence(5, as_it_is)] {
        let lifted = lift(&together, &evidence, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(lifted, scene.lift(&evidence, &settings).unwrap());
    }
}

#[test]
fn an_answer_is_a_part_of_the_scene_that_can_be_shown_taken_and_left_out() {
    let scene = Scene::new();
    let settings = LiftSettings::Closed(ClosedSettings::robust());
    let lifted = scene.lift(&scene.evidence(8, as_it_is), &settings).unwrap();
    let members = lifted.layer_at(&scene.model, 0.5).unwrap().members;
    let count = members.iter().filter(|member| **member).count();
    assert!((20..60).contains(&count), "{count}");
    let splats = scene.model.at(0.5).unwrap();
    let view = &scene.views[8];
    let draw = |splats: &_| scene.cpu.prepare(splats, view, &scene.raster).unwrap().draw().unwrap();

    let alone = extract(&splats, &members).unwrap();
    let without = remove(&splats, &members).unwrap();
    assert_eq!((alone.len(), alone.len() + without.len()), (count, 400));
    let truth = scene.truth(view, 48);
    let covered = draw(&alone).alpha;
    let inside: Vec<f32> =
        truth.pixels().map(|(column, row)| covered[(row * 64 + column) as usize]).collect();
    assert!(inside.iter().filter(|&&alpha| alpha > 0.5).count() * 10 > inside.len() * 8);

    let red = draw(&highlight(&splats, &members, [1.0, 0.0, 0.0], 1.0).unwrap());
    let plain = draw(&splats);
    for (pixel, (red, plain)) in red.colour.iter().zip(&plain.colour).enumerate() {
        let (column, row) = (pixel as u32 % 64, pixel as u32 / 64);
        if truth.get(column, row) {
            assert!(red[1] <= plain[1] + 1e-4, "no pixel of the ball is greener than before");
        }
    }
    let redder = truth.pixels().filter(|&(column, row)| {
        let pixel = (row * 64 + column) as usize;
        red.colour[pixel][0] - red.colour[pixel][1] > 0.4
    });
    assert!(redder.count() as u64 * 10 > truth.area() * 8);
    assert_eq!(highlight(&splats, &members, [1.0, 0.0, 0.0], 0.0).unwrap(), splats);
    assert!(highlight(&splats, &members, [f32::NAN, 0.0, 0.0], 1.0).is_err());
}

#[test]
fn an_answer_means_nothing_to_another_model_or_time() {
    let scene = Scene::new();
    let settings = LiftSettings::Closed(ClosedSettings::vote());
    let lifted = scene.lift(&scene.evidence(2, as_it_is), &settings).unwrap();
    lifted.check_model(&scene.model).unwrap();
    let mut other = scene.model.clone();
    other.gaussians.opacity_logits[3] += 0.5;
    assert!(matches!(lifted.check_model(&other), Err(LiftError::OtherModel { .. })));
    let fewer =
        Model { dynamic: Vec::new(), field: None, ..l4d_splat::reduce::keep(&scene.model, &[1, 2, 3]) };
    let error = lifted.layer_at(&fewer, 0.5).unwrap_err().to_string();
    assert!(error.contains("of 400 Gaussians") && error.contains("this one has 3"), "{error}");
    for time in [-0.1, 1.1, f32::NAN] {
        assert!(matches!(lifted.layer_at(&scene.model, time), Err(LiftError::Time { .. })));
    }
}
