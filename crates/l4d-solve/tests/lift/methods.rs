//! What each lift reaches where the truth is a matter of labels.

use l4d_masks::Mask;
use l4d_solve::lift::{
    Answer, ClosedSettings, Cut, DistilSettings, FieldSettings, LiftSettings, Normalisation, ReadOut,
};

use crate::fixture::{FRAMES, Scene, as_it_is, empty};

fn small_field() -> FieldSettings {
    FieldSettings { iterations: 150, learning_rate: 3e-3, width: 32, sampled: 100, ..FieldSettings::paper() }
}

#[test]
fn closed_forms_find_the_ball_in_a_view_that_nobody_saw() {
    let scene = Scene::new();
    let evidence = scene.evidence(8, as_it_is);
    for (name, settings, least) in [
        ("robust", ClosedSettings::robust(), 0.9),
        ("vote", ClosedSettings::vote(), 0.8),
        ("sirt", ClosedSettings::sirt(), 0.85),
        ("pixels", ClosedSettings { cut: Cut::Pixels, ..ClosedSettings::robust() }, 0.8),
    ] {
        let score = scene.score(&scene.lift(&evidence, &LiftSettings::Closed(settings)).unwrap());
        assert!(score > least, "{name}: {score}");
    }
}

#[test]
fn the_field_finds_the_ball_however_it_is_read_and_normalised() {
    let scene = Scene::new();
    let evidence = scene.evidence(8, as_it_is);
    for normalisation in [Normalisation::Paper, Normalisation::Code] {
        // One half has no meaning for a blend of features at a soft outline, least of all after few iterations.
        for (read_out, least) in [(ReadOut::Decode2d, 0.5), (ReadOut::Hard3d, 0.7)] {
            let settings = FieldSettings { normalisation, read_out, ..small_field() };
            let score = scene.score(&scene.lift(&evidence, &LiftSettings::Field(settings)).unwrap());
            assert!(score > least, "{normalisation:?} {read_out:?}: {score}");
        }
    }
}

#[test]
fn a_field_learns_labels_without_pictures() {
    let scene = Scene::new();
    let evidence = scene.evidence(8, as_it_is);
    let usual = DistilSettings::usual();
    let settings = DistilSettings { field: FieldSettings { width: 64, ..usual.field }, rows: 400, ..usual };
    let lifted = scene.lift(&evidence, &LiftSettings::Distil(settings)).unwrap();
    assert!(matches!(lifted.answer, Answer::Field(_)));
    let score = scene.score(&lifted);
    assert!(score > 0.85, "{score}");
}

#[test]
fn what_holds_for_half_of_the_clip_gives_no_mask_in_the_other_half() {
    let scene = Scene::new();
    let gated = |_: usize, frame: u32, mask: Mask| if frame > 48 { empty() } else { mask };
    let evidence = scene.evidence(8, gated);
    let closed = [ClosedSettings::robust(), ClosedSettings::vote(), ClosedSettings::sirt()];
    for settings in closed.map(LiftSettings::Closed) {
        let lifted = scene.lift(&evidence, &settings).unwrap();
        for frame in FRAMES {
            let (found, truth) = (scene.held_out(&lifted, frame), scene.truth(&scene.views[8], frame));
            if frame > 48 {
                assert!(found.is_empty(), "{settings:?}, frame {frame}: {} pixels", found.area());
            } else if !truth.is_empty() {
                assert!(
                    found.and_count(&truth) * 10 > found.or_count(&truth) * 7,
                    "{settings:?}, frame {frame}"
                );
            }
        }
        // Between clip times the nearest counts: 48 until 60.
        assert!(scene.held_out(&lifted, 61).is_empty());
    }
}

#[test]
fn one_missed_frame_of_one_view_changes_nothing_but_a_frame_that_all_miss_does() {
    let scene = Scene::new();
    let settings = LiftSettings::Closed(ClosedSettings::robust());
    let one = scene.evidence(4, |view, frame, mask| if (view, frame) == (1, 48) { empty() } else { mask });
    let Answer::Labels(labels) = scene.lift(&one, &settings).unwrap().answer else { panic!("labels") };
    assert_eq!(labels.state_of, [0; 5]);
    let all = scene.evidence(4, |_, frame, mask| if frame == 48 { empty() } else { mask });
    let Answer::Labels(labels) = scene.lift(&all, &settings).unwrap().answer else { panic!("labels") };
    assert_eq!(labels.state_of, [0, 0, 1, 0, 0]);
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
    let evidence = scene.evidence(8, noisy);
    let robust = scene.lift(&evidence, &LiftSettings::Closed(ClosedSettings::robust())).unwrap();
    let score = scene.score(&robust);
    assert!(score > 0.8, "{score}");
}
