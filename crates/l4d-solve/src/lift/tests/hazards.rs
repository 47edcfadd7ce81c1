//! Evidence and models at the edge of sense: an answer or an error, never a panic.

use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::view::View;

use super::fixture::{FRAMES, SIZE, Scene, as_it_is, closed, empty, field, sirt, vote};
use crate::lift::{ClosedSettings, Evidence, FieldSettings, LiftError, LiftSettings, lift};

/// Every lift, quick.
fn all() -> [LiftSettings; 4] {
    [closed(), vote(), sirt(), field(12)]
}

#[test]
fn masks_that_say_nothing_everything_or_a_pixel_are_lifted() {
    let scene = Scene::new();
    let pixel =
        |_: usize, _: u32, _: Mask| Mask::from_fn(SIZE[0], SIZE[1], |column, row| (column, row) == (30, 20));
    let mut one_frame = scene.evidence(1, as_it_is);
    one_frame.views[0].frames.truncate(1);
    // High above the room, looking up.
    let up = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -50.0]];
    let away = View::new(SIZE, [50.0, 50.0], [32.0, 24.0], up).unwrap();
    let mut out_of_sight = scene.evidence(2, as_it_is);
    for frame in out_of_sight.views.iter_mut().flat_map(|view| &mut view.frames) {
        frame.view = away;
    }
    // Share of the held-out view that a closed form marks.
    for (evidence, shares) in [
        (scene.evidence(3, |_, _, _| empty()), 0.0..=0.0),
        (scene.evidence(3, |_, _, mask| Mask::full(mask.width(), mask.height())), 0.85..=1.0),
        (out_of_sight, 0.0..=0.0),
        (scene.evidence(3, pixel), 0.0..=1.0),
        (scene.evidence(1, as_it_is), 0.0..=1.0),
        (one_frame, 0.0..=1.0),
    ] {
        for settings in all() {
            let lifted = scene.lift(&evidence, &settings).unwrap();
            for frame in FRAMES {
                let share = scene.held_out(&lifted, frame).area() as f64 / f64::from(SIZE[0] * SIZE[1]);
                let is_right = shares.contains(&share) || matches!(settings, LiftSettings::Field(_));
                assert!(is_right, "{settings:?}, frame {frame}: {share}");
            }
        }
    }
}

#[test]
fn a_scene_that_stands_still_and_one_of_nothing_can_be_lifted_onto() {
    let scene = Scene::new();
    let evidence = scene.evidence(3, as_it_is);
    let still = Model { field: None, dynamic: Vec::new(), ..scene.model.clone() };
    let kept = Model { dynamic: Vec::new(), ..scene.model.clone() };
    let few = still.keep(&[301, 303]);
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
            assert_eq!(lift(&scene.rendered(), &nothing, &settings).unwrap(), None);
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
    let evidence = scene.evidence(1, as_it_is);
    let (closed, field) = (ClosedSettings::robust(), FieldSettings::paper());
    for (name, settings) in [
        ("smoothness", LiftSettings::Closed(ClosedSettings { smoothness: f32::NAN, ..closed })),
        ("change_price", LiftSettings::Closed(ClosedSettings { change_price: -1.0, ..closed })),
        ("step_times", LiftSettings::Closed(ClosedSettings { step_times: 0, ..closed })),
        ("learning_rate", LiftSettings::Field(FieldSettings { learning_rate: f64::NAN, ..field })),
        ("width", LiftSettings::Field(FieldSettings { width: u32::MAX, ..field })),
    ] {
        let error = scene.lift(&evidence, &settings).unwrap_err().to_string();
        assert!(error.contains(&format!("`{name}`")), "{error}");
    }
}

#[test]
fn a_field_that_diverges_says_so() {
    let scene = Scene::new();
    let settings = FieldSettings { learning_rate: 1e3, iterations: 200, width: 16, ..FieldSettings::paper() };
    match scene.lift(&scene.evidence(2, as_it_is), &LiftSettings::Field(settings)) {
        // Wild but finite numbers are an answer.
        Ok(lifted) => drop(scene.held_out(&lifted, 48)),
        Err(error) => assert!(matches!(error, LiftError::Learning { .. }), "{error}"),
    }
}

#[test]
fn one_two_and_five_threads_give_the_same_bytes_and_another_seed_others() {
    let lifted = |threads: usize, settings: &LiftSettings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scene = Scene::new();
            scene.lift(&scene.evidence(3, as_it_is), settings).unwrap()
        })
    };
    for settings in [closed(), field(8)] {
        let one = lifted(1, &settings);
        assert!([2, 5].into_iter().all(|threads| lifted(threads, &settings) == one), "{settings:?}");
    }
    let LiftSettings::Field(settings) = field(8) else { panic!("a field") };
    assert_ne!(lifted(2, &field(8)), lifted(2, &LiftSettings::Field(FieldSettings { seed: 1, ..settings })));
}
