//! Evidence and models at the edge of sense: an answer or an error, never a panic.

use std::ops::ControlFlow;

use l4d_masks::Mask;
use l4d_solve::lift::{
    ClosedSettings, DistilSettings, Evidence, FieldSettings, LiftError, LiftSettings, Phase, lift,
};
use l4d_splat::Model;
use l4d_splat::view::View;

use crate::fixture::{FRAMES, SIZE, Scene, as_it_is, empty};

/// Every lift, quick.
fn all() -> Vec<LiftSettings> {
    let field = FieldSettings { iterations: 12, width: 16, sampled: 50, ..FieldSettings::paper() };
    vec![
        LiftSettings::Closed(ClosedSettings::robust()),
        LiftSettings::Closed(ClosedSettings::vote()),
        LiftSettings::Closed(ClosedSettings::sirt()),
        LiftSettings::Field(field),
        LiftSettings::Distil(DistilSettings { field, rows: 100, ..DistilSettings::usual() }),
    ]
}

#[test]
fn empty_masks_give_an_empty_answer() {
    let scene = Scene::new();
    let evidence = scene.evidence(3, |_, _, _| empty());
    for settings in &all()[..3] {
        let lifted = scene.lift(&evidence, settings).unwrap();
        assert!(FRAMES.iter().all(|&frame| scene.held_out(&lifted, frame).is_empty()), "{settings:?}");
    }
    for settings in &all()[3..] {
        scene.lift(&evidence, settings).unwrap();
    }
}

#[test]
fn full_masks_give_what_is_there() {
    let scene = Scene::new();
    let evidence = scene.evidence(3, |_, _, mask| Mask::full(mask.width(), mask.height()));
    for settings in all() {
        let lifted = scene.lift(&evidence, &settings).unwrap();
        if matches!(settings, LiftSettings::Closed(_)) {
            let share = scene.held_out(&lifted, 48).area() as f64 / f64::from(SIZE[0] * SIZE[1]);
            assert!(share > 0.85, "{settings:?}: {share}");
        }
    }
}

#[test]
fn one_pixel_one_view_and_one_frame_are_enough_to_go_on() {
    let scene = Scene::new();
    let pixel =
        |_: usize, _: u32, _: Mask| Mask::from_fn(SIZE[0], SIZE[1], |column, row| (column, row) == (30, 20));
    let mut one_frame = scene.evidence(1, as_it_is);
    one_frame.views[0].frames.truncate(1);
    for evidence in [scene.evidence(3, pixel), scene.evidence(1, as_it_is), one_frame] {
        for settings in all() {
            let lifted = scene.lift(&evidence, &settings).unwrap();
            scene.held_out(&lifted, 60);
        }
    }
}

#[test]
fn nobody_in_sight_gives_an_empty_answer() {
    let scene = Scene::new();
    // High above the room, looking up.
    let up = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -50.0]];
    let away = View::new(SIZE, [50.0, 50.0], [32.0, 24.0], up).unwrap();
    let mut evidence = scene.evidence(2, as_it_is);
    for frame in evidence.views.iter_mut().flat_map(|view| &mut view.frames) {
        frame.view = away;
    }
    for settings in all() {
        let lifted = scene.lift(&evidence, &settings).unwrap();
        if matches!(settings, LiftSettings::Closed(_)) {
            assert!(scene.held_out(&lifted, 48).is_empty());
        }
    }
}

#[test]
fn a_scene_that_stands_still_and_one_of_nothing_can_be_lifted_onto() {
    let scene = Scene::new();
    let evidence = scene.evidence(3, as_it_is);
    let still = Model { field: None, dynamic: Vec::new(), ..scene.model.clone() };
    let kept = Model { dynamic: Vec::new(), ..scene.model.clone() };
    let few = l4d_splat::reduce::keep(&still, &[301, 303]);
    for model in [still, kept, few, Model::default()] {
        let scene = Scene { model, ..Scene::new() };
        for settings in all() {
            let lifted = scene.lift(&evidence, &settings).unwrap();
            scene.held_out(&lifted, 10);
        }
    }
}

#[test]
fn what_cannot_be_lifted_is_told() {
    let scene = Scene::new();
    for settings in all() {
        let mut silent = scene.evidence(1, as_it_is);
        silent.views[0].frames.clear();
        for nothing in [Evidence::default(), silent] {
            assert!(matches!(scene.lift(&nothing, &settings), Err(LiftError::NoEvidence)));
        }
        let mut evidence = scene.evidence(2, as_it_is);
        evidence.views[1].frames[2].mask = Mask::empty(3, 4);
        let error = scene.lift(&evidence, &settings).unwrap_err().to_string();
        assert_eq!(error, "view `cam01`, frame 48: the mask is 3x4, but the view has 64x48 pixels");

        let mut model = scene.model.clone();
        model.gaussians.means[7][1] = f32::NAN;
        let broken = Scene { model, ..Scene::new() };
        let error = broken.lift(&scene.evidence(2, as_it_is), &settings).unwrap_err();
        assert!(matches!(error, LiftError::Model { .. }), "{error}");
    }
}

#[test]
fn settings_outside_their_ranges_are_named() {
    let scene = Scene::new();
    let evidence = scene.evidence(1, as_it_is);
    let (closed, field) = (ClosedSettings::robust(), FieldSettings::paper());
    for (name, settings) in [
        ("smoothness", LiftSettings::Closed(ClosedSettings { smoothness: f32::NAN, ..closed })),
        ("change_price", LiftSettings::Closed(ClosedSettings { change_price: -1.0, ..closed })),
        ("step_times", LiftSettings::Closed(ClosedSettings { step_times: 0, ..closed })),
        ("learning_rate", LiftSettings::Field(FieldSettings { learning_rate: f64::NAN, ..field })),
        ("left_out", LiftSettings::Field(FieldSettings { left_out: 2.0, ..field })),
        ("width", LiftSettings::Field(FieldSettings { width: u32::MAX, ..field })),
    ] {
        let error = scene.lift(&evidence, &settings).unwrap_err().to_string();
        assert!(error.contains(&format!("`{name}`")), "{error}");
    }
}

#[test]
fn a_field_that_diverges_says_so() {
    let scene = Scene::new();
    let evidence = scene.evidence(2, as_it_is);
    let field = FieldSettings { learning_rate: 1e3, iterations: 200, width: 16, ..FieldSettings::paper() };
    match scene.lift(&evidence, &LiftSettings::Field(field)) {
        // Wild but finite numbers are an answer.
        Ok(lifted) => drop(scene.held_out(&lifted, 48)),
        Err(error) => assert!(matches!(error, LiftError::Learning { .. }), "{error}"),
    }
}

#[test]
fn every_lift_tells_its_steps_and_ends_when_asked() {
    let scene = Scene::new();
    let evidence = scene.evidence(2, as_it_is);
    for settings in all() {
        let mut told = Vec::new();
        lift(&scene.canvas(), &evidence, &settings, &mut |progress| {
            told.push(progress);
            ControlFlow::Continue(())
        })
        .unwrap();
        let done: Vec<usize> = told.iter().map(|progress| progress.done).collect();
        assert_eq!(done, (0..told.len()).collect::<Vec<_>>());
        assert_eq!(told.last().map(|progress| progress.all), Some(told.len()));
        if told.last().is_some_and(|progress| progress.phase == Phase::Learning) {
            assert!(told.last().unwrap().loss.is_some_and(f64::is_finite));
        }
        for after in [0, 3] {
            let stopped = lift(&scene.canvas(), &evidence, &settings, &mut |progress| {
                if progress.done == after { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert!(matches!(stopped, Err(LiftError::Cancelled)));
        }
    }
}
