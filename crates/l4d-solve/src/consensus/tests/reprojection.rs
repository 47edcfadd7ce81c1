//! Re-projection against worlds where it can be known: a wall by hand, curved and hidden things by ray casting.

use glam::DVec3;
use half::f16;
use l4d_ground::ViewClip;
use l4d_masks::Mask;

use super::world::{Shape, Thing, World, arc, looking};
use crate::consensus::ConsensusSettings;
use crate::consensus::reproject::{Reprojection, reproject};
use crate::consensus::settings::ReprojectionSettings;
use crate::consensus::view_geometry::ViewGeometry;

fn robust() -> ReprojectionSettings {
    ConsensusSettings::robust().reprojection
}

fn carry(
    clips: &[ViewClip],
    (from, to): (usize, usize),
    mask: &Mask,
    settings: &ReprojectionSettings,
) -> Reprojection {
    let frame = clips[from].frames[0].frame;
    let sight =
        |view: usize| ViewGeometry::of_clip(&clips[view], frame, settings).expect("the clip has that frame");
    reproject(&sight(from), mask, &sight(to), settings)
}

/// Two cameras 0.2 m apart, side by side, that look along +Y at a wall 2 m away: 100 px * 0.2 / 2 = 10 px.
fn stereo() -> World {
    let size = [80, 60];
    let camera =
        |name, x| (looking(name, DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0), size, 100.0), size);
    let wall = Thing {
        id: 1,
        shape: Shape::Box(DVec3::new(50.0, 0.5, 50.0)),
        centre: |_| DVec3::new(0.0, 2.5, 0.0),
    };
    World { things: vec![wall], cameras: vec![camera("left", 0.0), camera("right", 0.2)], frames: vec![0] }
}

/// A sphere and a box on a floor, another box in front of the sphere for some of the cameras.
fn still_life() -> World {
    let fixed = |id, shape, centre| Thing { id, shape, centre };
    World {
        things: vec![
            fixed(1001, Shape::Box(DVec3::new(20.0, 20.0, 0.1)), |_| DVec3::new(0.0, 0.0, -0.6)),
            fixed(1, Shape::Sphere(0.5), |_| DVec3::ZERO),
            fixed(2, Shape::Box(DVec3::new(0.2, 0.1, 0.3)), |_| DVec3::new(0.5, -0.9, -0.2)),
        ],
        cameras: arc(6, 100.0, [128, 96], 130.0),
        frames: vec![0],
    }
}

#[test]
fn a_wall_moves_by_the_disparity() {
    let clips = stereo().clips();
    let block = |first: u32, last: u32| {
        Mask::from_fn(80, 60, |column, row| (first..last).contains(&column) && (20..30).contains(&row))
    };
    let inside = carry(&clips, (0, 1), &block(30, 42), &robust());
    assert_eq!(inside.covered, block(20, 32));
    assert_eq!((inside.projected, inside.in_frame, inside.passing), (120, 120, 120));
    // Columns 5 to 9 land left of the picture.
    let cut = carry(&clips, (0, 1), &block(5, 12), &robust());
    assert_eq!(cut.covered, block(0, 2));
    assert_eq!((cut.projected, cut.in_frame, cut.passing), (70, 20, 20));
}

#[test]
fn it_agrees_with_ray_casting() {
    let world = still_life();
    let clips = world.clips();
    let mut overlaps = Vec::new();
    for (from, to) in (0..6).flat_map(|from| (0..6).map(move |to| (from, to))).filter(|(a, b)| a != b) {
        for id in [1, 2] {
            let exact = world.exact(from, to, 0, id);
            if exact.area() >= 20 {
                let there = carry(&clips, (from, to), &world.mask(from, 0, id), &robust());
                overlaps.push(there.covered.iou(&exact).unwrap());
            }
        }
    }
    let mean = overlaps.iter().sum::<f64>() / overlaps.len() as f64;
    assert!(overlaps.len() > 40 && mean > 0.9, "{mean} of {}", overlaps.len());
}

#[test]
fn a_nearer_camera_sees_no_holes() {
    let mut world = still_life();
    let size = [128, 96];
    world.cameras.truncate(1);
    world.cameras.push((looking("near", DVec3::new(-0.9, -1.4, 0.5), DVec3::ZERO, size, 130.0), size));
    let clips = world.clips();
    let (mask, exact) = (world.mask(0, 0, 1), world.exact(0, 1, 0, 1));
    assert!(exact.area() > 4 * mask.area(), "the near camera enlarges");
    // Inside by more than two pixels nothing is missing, for what the far camera sees at a steep enough angle.
    let core = Mask::from_fn(128, 96, |column, row| {
        (-2..=2).all(|down| {
            (-2..=2).all(|right| {
                let place = (column.checked_add_signed(right), row.checked_add_signed(down));
                matches!(place, (Some(column), Some(row)) if exact.get(column, row))
            })
        })
    });
    let covered = carry(&clips, (0, 1), &mask, &robust()).covered;
    let holes = core.and_not_count(&covered);
    assert!(holes * 50 < core.area(), "{holes} holes in {} pixels", core.area());
}

#[test]
fn what_is_hidden_does_not_pass() {
    // A box 1 m away, 0.4 m wide: columns 20 to 60 of the left picture, those below 40 of the right one.
    let mut world = stereo();
    world.things.push(Thing {
        id: 2,
        shape: Shape::Box(DVec3::new(0.2, 0.01, 5.0)),
        centre: |_| DVec3::new(0.0, 1.0, 0.0),
    });
    let clips = world.clips();
    // The wall right of the box lands at columns 52 to 62.
    let block = Mask::from_fn(80, 60, |column, row| (62..72).contains(&column) && row == 30);
    let there = carry(&clips, (0, 1), &block, &robust());
    assert_eq!((there.in_frame, there.passing, there.covered.area()), (10, 10, 10));
    // The wall left of the box lands at columns 2 to 10, behind it.
    let left = Mask::from_fn(80, 60, |column, row| (12..20).contains(&column) && row == 30);
    let there = carry(&clips, (0, 1), &left, &robust());
    assert_eq!((there.in_frame, there.passing, there.covered.area()), (8, 0, 0));
}

#[test]
fn depths_that_are_none_project_nothing() {
    let world = stereo();
    let mask = Mask::from_fn(80, 60, |column, row| (30..40).contains(&column) && row == 30);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -2.0] {
        let mut clips = world.clips();
        clips[0].frames[0].depth.depth_m.fill(bad);
        let there = carry(&clips, (0, 1), &mask, &robust());
        assert_eq!((there.projected, there.covered.area()), (0, 0), "{bad}");
        // In the other view: nothing hides, and nothing is shown.
        let there = carry(&clips, (1, 0), &mask, &robust());
        assert_eq!((there.projected, there.passing), (10, 10), "{bad}");
    }
    for extreme in [f32::MIN_POSITIVE, f32::MAX, 1e-20, 1e20] {
        let mut clips = world.clips();
        clips[0].frames[0].depth.depth_m.fill(extreme);
        carry(&clips, (0, 1), &Mask::full(80, 60), &robust());
        carry(&clips, (1, 0), &Mask::full(80, 60), &robust());
    }
}

#[test]
fn pixels_that_are_hardly_filled_have_no_depth_in_robust_alone() {
    let mut clips = stereo().clips();
    let mask = Mask::from_fn(80, 60, |column, row| (30..40).contains(&column) && row == 30);
    for (alpha, projected) in [(0.5, 10), (0.499, 0), (f32::NAN, 0)] {
        clips[0].frames[0].depth.alpha.fill(f16::from_f32(alpha));
        assert_eq!(carry(&clips, (0, 1), &mask, &robust()).projected, projected, "{alpha}");
        let paper = ConsensusSettings::paper().reprojection;
        assert_eq!(carry(&clips, (0, 1), &mask, &paper).projected, 10);
    }
}

#[test]
fn a_wide_spread_forgives_and_not_without_end() {
    // The right camera has the wall 0.08 m too near. 2 % of 2 m do not forgive that, 5 % do.
    let mut clips = stereo().clips();
    let mask = Mask::from_fn(80, 60, |column, row| (30..40).contains(&column) && row == 30);
    let depth = &mut clips[1].frames[0].depth;
    depth.depth_m.fill(1.92);
    let (near, far): (&mut [f16], &mut [f16]) = (&mut depth.near_m, &mut depth.far_m);
    near.fill(f16::from_f32(1.92));
    far.fill(f16::from_f32(1.92));
    assert_eq!(carry(&clips, (0, 1), &mask, &robust()).passing, 0);
    assert_eq!(carry(&clips, (0, 1), &mask, &ConsensusSettings::paper().reprojection).passing, 10);
    // 0.04 m of tolerance and (2.05 - 1.85) / 2 of spread.
    clips[1].frames[0].depth.near_m.fill(f16::from_f32(1.85));
    clips[1].frames[0].depth.far_m.fill(f16::from_f32(2.05));
    assert_eq!(carry(&clips, (0, 1), &mask, &robust()).passing, 10);
    // At most 5 % of 2 m are added, and 0.2 m are more than 0.14 m.
    clips[1].frames[0].depth.depth_m.fill(1.8);
    clips[1].frames[0].depth.far_m.fill(f16::from_f32(9.0));
    assert_eq!(carry(&clips, (0, 1), &mask, &robust()).passing, 0);
    // No spread is known: that of a pixel without a far depth.
    clips[1].frames[0].depth.far_m.fill(f16::INFINITY);
    assert_eq!(carry(&clips, (0, 1), &mask, &robust()).passing, 0);
}

#[test]
fn cameras_that_look_away_see_nothing_of_it() {
    let mut world = still_life();
    let size = [64, 48];
    world.cameras.truncate(1);
    world
        .cameras
        .push((looking("away", DVec3::new(0.0, -4.0, 1.5), DVec3::new(0.0, -9.0, 1.0), size, 60.0), size));
    let clips = world.clips();
    let there = carry(&clips, (0, 1), &world.mask(0, 0, 1), &robust());
    assert!(there.projected > 100);
    assert_eq!((there.in_frame, there.passing, there.covered.area()), (0, 0, 0));
}
