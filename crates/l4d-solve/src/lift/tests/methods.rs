//! What each lift reaches where the truth is a matter of labels.

use l4d_masks::Mask;

use super::fixture::{FRAMES, Scene, as_it_is, closed, empty, sirt, vote};
use crate::lift::{Answer, FieldSettings, LiftSettings};

#[test]
fn every_lift_finds_the_ball_in_a_view_that_nobody_saw() {
    let scene = Scene::new();
    let evidence = scene.evidence(8, as_it_is);
    let field = FieldSettings {
        iterations: 150,
        learning_rate: 3e-3,
        width: 32,
        sampled: 100,
        ..FieldSettings::paper()
    };
    // One half has no meaning for a blend of features at a soft outline, least of all after few iterations.
    for (settings, least) in
        [(closed(), 0.9), (vote(), 0.8), (sirt(), 0.85), (LiftSettings::Field(field), 0.5)]
    {
        let score = scene.score(&scene.lift(&evidence, &settings).unwrap());
        assert!(score > least, "{settings:?}: {score}");
    }
}

#[test]
fn what_holds_for_half_of_the_clip_gives_no_mask_in_the_other_half() {
    let scene = Scene::new();
    let gated = |_: usize, frame: u32, mask: Mask| if frame > 48 { empty() } else { mask };
    let evidence = scene.evidence(8, gated);
    for settings in [closed(), vote(), sirt()] {
        let lifted = scene.lift(&evidence, &settings).unwrap();
        for frame in FRAMES {
            let (found, truth) = (scene.held_out(&lifted, frame), scene.truth(&scene.views[8], frame));
            if frame > 48 {
                assert!(found.is_empty(), "{settings:?}, frame {frame}: {} pixels", found.area());
            } else if !truth.is_empty() {
                assert!(found.iou(&truth) > Some(0.7), "{settings:?}, frame {frame}");
            }
        }
        // Between clip times the nearest counts: 48 until 60.
        assert!(scene.held_out(&lifted, 61).is_empty());
    }
}

#[test]
fn one_missed_frame_of_one_view_changes_nothing_but_a_frame_that_all_miss_does() {
    let scene = Scene::new();
    let states = |change: fn(usize, u32, Mask) -> Mask| {
        let answer = scene.lift(&scene.evidence(4, change), &closed()).unwrap();
        let Answer::Labels(labels) = answer else { panic!("labels") };
        labels.state_of
    };
    assert_eq!(states(|view, frame, mask| if (view, frame) == (1, 48) { empty() } else { mask }), [0; 5]);
    assert_eq!(states(|_, frame, mask| if frame == 48 { empty() } else { mask }), [0, 0, 1, 0, 0]);
}

#[test]
fn noisy_masks_are_averaged_out() {
    let scene = Scene::new();
    // Every third mask has a blob in a corner, every fourth is missing.
    let noisy = |view: usize, frame: u32, mask: Mask| {
        let turn = view + frame as usize / 24;
        if turn % 4 == 3 {
            return empty();
        }
        let (width, height) = mask.size();
        let blob = |column: u32, row: u32| turn.is_multiple_of(3) && column < 9 && row < 9;
        Mask::from_fn(width, height, |column, row| mask.get(column, row) || blob(column, row))
    };
    let score = scene.score(&scene.lift(&scene.evidence(8, noisy), &closed()).unwrap());
    assert!(score > 0.8, "{score}");
}
