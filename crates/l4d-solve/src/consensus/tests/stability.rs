//! Hard cases: no one right, few right, hidden, small, late, twins, and what is no proposal at all.

use std::collections::BTreeMap;

use glam::DVec3;
use half::f16;
use l4d_ground::{Grounding, Outcome, ViewClip};
use l4d_masks::Mask;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::world::{Shape, Thing, World, arc, looking};
use super::{decide, has_conflict};
use crate::consensus::settings::Undecided;
use crate::consensus::{Consensus, ConsensusSettings, Decision, Preset, ViewVerdict};

const FLOOR: Thing = Thing {
    id: 1001,
    shape: Shape::Box(DVec3::new(20.0, 20.0, 0.1)),
    centre: |_| DVec3::new(0.0, 0.0, -0.6),
};
const TWIN: Thing = Thing {
    id: 1,
    shape: Shape::Sphere(0.3),
    centre: |frame| DVec3::new(-0.7, f64::from(frame) / 300.0, 0.0),
};
const OTHER_TWIN: Thing = Thing {
    id: 2,
    shape: Shape::Sphere(0.3),
    centre: |frame| DVec3::new(0.7, f64::from(frame) / 300.0, 0.0),
};

fn twins(views: usize) -> World {
    World {
        things: vec![FLOOR, TWIN, OTHER_TWIN],
        cameras: arc(views, 80.0, [96, 72], 90.0),
        frames: (0..97).step_by(16).collect(),
    }
}

fn presets() -> [ConsensusSettings; 2] {
    [ConsensusSettings::paper(), ConsensusSettings::robust()]
}

/// Round blobs anywhere, another one in each frame.
fn blobs(clip: &ViewClip, seed: u64) -> Grounding {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut blob = || {
        let (x, y) = (random.random_range(0.0..96.0), random.random_range(0.0..72.0));
        let radius: f64 = random.random_range(4.0..12.0);
        Mask::from_fn(clip.width, clip.height, |column, row| {
            (f64::from(column) - x).hypot(f64::from(row) - y) < radius
        })
    };
    Grounding::of_masks(clip, clip.frame_numbers().map(|frame| (frame, blob())).collect(), Vec::new())
}

fn of_ids(world: &World, clips: &[ViewClip], ids: &[u32]) -> Vec<Grounding> {
    ids.iter().enumerate().map(|(view, &id)| world.marking(clips, view, id)).collect()
}

/// Checks that the votes decided nothing, and that what follows is what the preset says: nothing, or every view that
/// found something. Gives the number of those views.
fn undecided(consensus: &Consensus) -> usize {
    let found = consensus.views.iter().filter(|view| view.marked_frames > 0).count();
    match consensus.settings.undecided {
        Undecided::Abstain => {
            assert_eq!((consensus.decision, consensus.evidence.len()), (Decision::NoneReliable, 0));
        }
        Undecided::AllCandidates => {
            assert_eq!((consensus.decision, consensus.evidence.len()), (Decision::NoneReliableAll, found));
        }
    }
    found
}

#[test]
fn views_that_are_all_wrong_decide_nothing_nor_does_one_that_is_right() {
    let world = twins(8);
    let clips = world.clips();
    for settings in presets() {
        for seed in 0..10 {
            let mut groundings: Vec<Grounding> =
                clips.iter().zip(0..).map(|(clip, view)| blobs(clip, 100 * seed + view)).collect();
            let consensus = decide(&clips, &groundings, &settings);
            assert_eq!(undecided(&consensus), 8, "seed {seed}\n{}", consensus.summary());
            groundings[3] = world.marking(&clips, 3, 1);
            let consensus = decide(&clips, &groundings, &settings);
            assert_eq!(undecided(&consensus), 8, "seed {seed}\n{}", consensus.summary());
            assert_eq!(consensus.views[3].standing, ViewVerdict::FewVotes);
        }
    }
}

#[test]
fn a_view_that_marks_both_twins_does_not_reconcile_the_groups() {
    let world = twins(9);
    let clips = world.clips();
    let mut groundings = of_ids(&world, &clips, &[1, 1, 1, 1, 1, 2, 2, 2, 2]);
    for (frame, mask) in &mut groundings[4].masks {
        mask.union_with(&world.mask(4, *frame, 2));
    }
    let consensus = decide(&clips, &groundings, &ConsensusSettings::robust());
    assert_eq!(consensus.groups.len(), 2, "{}", consensus.explain());
    assert!(has_conflict(&consensus));
    assert!(!consensus.evidence.contains(&8), "{}", consensus.explain());
}

#[test]
fn a_handful_of_pixels_is_enough() {
    // 9 cm at 4.3 m and 90 px of focal length: 2 px across.
    let mut world = twins(8);
    world.things = vec![
        FLOOR,
        Thing {
            id: 1,
            shape: Shape::Sphere(0.045),
            centre: |frame| DVec3::new(0.01 * f64::from(frame), 0.0, 0.1),
        },
    ];
    let clips = world.clips();
    let groundings = of_ids(&world, &clips, &[1; 8]);
    let sizes: Vec<u64> = groundings.iter().flat_map(|view| view.masks.values()).map(Mask::area).collect();
    assert!(sizes.iter().all(|&pixels| (1..10).contains(&pixels)), "{sizes:?}");
    for settings in presets() {
        let consensus = decide(&clips, &groundings, &settings);
        assert_eq!(consensus.decision, Decision::Reliable, "{}", consensus.explain());
    }
    let robust = decide(&clips, &groundings, &ConsensusSettings::robust());
    assert!(robust.evidence.len() >= 6, "{}", robust.explain());
}

/// A ball that a wall hides from the views on the left, in all frames but the last ones.
fn behind_a_wall() -> World {
    World {
        things: vec![
            FLOOR,
            Thing { id: 1, shape: Shape::Sphere(0.3), centre: |_| DVec3::ZERO },
            Thing {
                id: 3,
                shape: Shape::Box(DVec3::new(0.9, 0.05, 0.8)),
                centre: |frame| DVec3::new(-0.9, -0.8, if frame < 64 { 0.0 } else { 40.0 }),
            },
        ],
        ..twins(8)
    }
}

#[test]
fn what_is_hidden_most_of_the_time_is_judged_when_it_is_seen() {
    let world = behind_a_wall();
    let clips = world.clips();
    let groundings = of_ids(&world, &clips, &[1; 8]);
    let first = &groundings[0];
    assert_eq!(first.masks.values().filter(|mask| mask.area() < 30).count(), 4, "hidden in 4 of 7 frames");
    let robust = decide(&clips, &groundings, &ConsensusSettings::robust());
    assert_eq!(robust.evidence, [0, 1, 2, 3, 4, 5, 6, 7], "{}", robust.explain());
    // Who sees it all the time is not judged by the frames in which the others cannot.
    let pair = robust.pair(7, 1).unwrap();
    assert_eq!((pair.agreeing, pair.counted, pair.seen), (3, 3, 3));
    let paper = decide(&clips, &groundings, &ConsensusSettings::paper());
    let pair = paper.pair(7, 1).unwrap();
    assert_eq!((pair.agreeing, pair.counted), (3, 7), "to the letter they count");
}

#[test]
fn what_enters_late_is_judged_by_the_frames_after_that() {
    let mut world = twins(8);
    world.things[1].centre =
        |frame| if frame < 64 { DVec3::new(-60.0, 0.0, 0.0) } else { DVec3::new(0.0, 0.0, 0.0) };
    let clips = world.clips();
    let groundings = of_ids(&world, &clips, &[1; 8]);
    for settings in presets() {
        let consensus = decide(&clips, &groundings, &settings);
        assert_eq!(consensus.evidence.len(), 8, "{}", consensus.summary());
        let pair = consensus.pair(0, 1).unwrap();
        assert_eq!((pair.agreeing, pair.counted), (3, 3));
    }
}

#[test]
fn empty_and_full_masks_decide_nothing_by_accident() {
    let world = twins(8);
    let clips = world.clips();
    for preset in [Preset::Paper, Preset::Robust, Preset::Off] {
        let empty: Vec<Grounding> =
            clips.iter().map(|clip| Grounding::of_masks(clip, BTreeMap::new(), Vec::new())).collect();
        let consensus = decide(&clips, &empty, &preset.settings());
        assert_eq!((consensus.decision, consensus.evidence.len()), (Decision::Absent, 0));
        // Says that it found something, and marks nothing.
        let mut liar = empty.clone();
        liar[0].outcome = Outcome::Found;
        assert_eq!(decide(&clips, &liar, &preset.settings()).views[0].standing, ViewVerdict::Absent);
    }
    // Seven views mark the ball, one everything: it is not what the others mean.
    let mut groundings = of_ids(&world, &clips, &[1; 8]);
    for mask in groundings[4].masks.values_mut() {
        *mask = Mask::full(96, 72);
    }
    for settings in presets() {
        let consensus = decide(&clips, &groundings, &settings);
        assert_eq!(consensus.evidence, [0, 1, 2, 3, 5, 6, 7], "{}", consensus.explain());
    }
}

#[test]
fn broken_depth_never_panics_and_is_not_believed() {
    let world = twins(5);
    let sound = world.clips();
    let groundings = of_ids(&world, &sound, &[1; 5]);
    for bad in [f32::NAN, f32::INFINITY, 0.0, -1.0, f32::MAX, f32::MIN_POSITIVE] {
        for settings in presets() {
            let mut clips = sound.clone();
            for frame in &mut clips[1].frames {
                frame.depth.depth_m.fill(bad);
                frame.depth.near_m.fill(f16::NAN);
                frame.depth.far_m.fill(f16::NEG_INFINITY);
            }
            let consensus = decide(&clips, &groundings, &settings);
            assert!(!consensus.evidence.contains(&1), "{bad}\n{}", consensus.summary());
            assert!(consensus.evidence.contains(&0), "{bad}\n{}", consensus.explain());
            for frame in clips.iter_mut().flat_map(|clip| &mut clip.frames) {
                frame.depth.depth_m.fill(bad);
            }
            decide(&clips, &groundings, &settings);
        }
    }
}

#[test]
fn moving_cameras_and_pictures_of_other_sizes_take_part() {
    let mut world = twins(6);
    for (index, (camera, size)) in world.cameras.iter_mut().enumerate() {
        if index % 2 == 1 {
            (camera.fx, camera.fy, camera.cx, camera.cy) = (50.0, 50.0, 25.0, 20.0);
            *size = [50, 40];
        }
        if index > 2 {
            let pose = |frame: u32| {
                let angle = (f64::from(frame) / 2.0 - 20.0 + 8.0 * index as f64).to_radians();
                let eye = DVec3::new(4.0 * angle.sin(), -4.0 * angle.cos(), 1.5);
                looking("moving", eye, DVec3::ZERO, *size, 1.0).world_from_camera[0]
            };
            camera.world_from_camera = (0..97).map(pose).collect();
        }
    }
    let clips = world.clips();
    let groundings = of_ids(&world, &clips, &[1; 6]);
    for settings in presets() {
        let consensus = decide(&clips, &groundings, &settings);
        assert_eq!(consensus.evidence, [0, 1, 2, 3, 4, 5], "{}", consensus.explain());
    }
}
