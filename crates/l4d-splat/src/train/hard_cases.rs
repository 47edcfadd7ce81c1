//! Cases in which comparing pictures misleads, each a made-up world with a stated answer: how close a model that was
//! learned from colour alone comes to a camera that it has not seen.
//!
//! All worlds have a wall at z = 4 m and a floor at y = 0.8 m (y points down), and cameras that look along z.

use glam::DVec3;
use l4d_data::Camera;

use super::quality::{Quality, Region, measure};
use super::test_world::{camera_at, grain, taken};
use super::views::TrainingViews;
use super::{InitialPoints, Motion, Settings, Stage, Trainer};
use crate::raster::Cpu;

const SIZE: [u32; 2] = [72, 54];
const FOCAL_PX: f64 = 60.0;
const MOMENTS: usize = 8;
/// Training cameras, metres.
const PLACES_M: [[f64; 2]; 6] = [[-0.5, 0.0], [0.5, 0.1], [0.0, -0.2], [-0.2, 0.2], [0.25, -0.1], [0.0, 0.1]];
const HELD_OUT_M: [f64; 2] = [0.1, 0.0];

const WALL_M: f64 = 4.0;
const FLOOR_M: f64 = 0.8;

/// Planar depth, metres, and display colour, 0 to 1.
type Hit = (f64, [f64; 3]);

struct Ray {
    from: DVec3,
    /// Its z is 1.
    along: DVec3,
}

impl Ray {
    fn at(&self, depth_m: f64) -> DVec3 {
        self.from + depth_m * self.along
    }

    fn wall(&self, colour: impl Fn(DVec3) -> [f64; 3]) -> Hit {
        let depth_m = WALL_M - self.from.z;
        (depth_m, colour(self.at(depth_m)))
    }

    fn floor(&self, colour: impl Fn(DVec3) -> [f64; 3]) -> Option<Hit> {
        let depth_m = (FLOOR_M - self.from.y) / self.along.y;
        (self.along.y > 0.0).then(|| (depth_m, colour(self.at(depth_m))))
    }

    /// A square that faces the cameras, its grain moving with it.
    fn card(&self, centre: DVec3, half_m: f64, tint: [f64; 3]) -> Option<Hit> {
        let depth_m = centre.z - self.from.z;
        let offset = self.at(depth_m) - centre;
        let is_on = offset.x.abs() < half_m && offset.y.abs() < half_m;
        is_on.then(|| (depth_m, shaded(tint, grain(2.0 * offset))))
    }
}

fn shaded(tint: [f64; 3], grain: f64) -> [f64; 3] {
    tint.map(|value| value * (1.0 + 0.4 * grain))
}

fn papered(at: DVec3) -> [f64; 3] {
    shaded([0.35, 0.45, 0.6], grain(at))
}

fn boarded(at: DVec3) -> [f64; 3] {
    shaded([0.55, 0.4, 0.3], grain(DVec3::new(at.x, at.z, 0.0)))
}

fn room(ray: &Ray) -> Hit {
    nearest(ray.wall(papered), [ray.floor(boarded)])
}

fn nearest<const N: usize>(far: Hit, others: [Option<Hit>; N]) -> Hit {
    others.into_iter().flatten().fold(far, |near, hit| if hit.0 < near.0 { hit } else { near })
}

/// What a ray meets at a moment.
type World = dyn Fn(&Ray, usize) -> Hit + Sync;

/// What cameras at such places see, each with its own factor of exposure.
fn seen(world: &World, places_m: &[[f64; 2]], exposures: &[f64]) -> TrainingViews {
    let places: Vec<DVec3> = places_m.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
    let cameras: Vec<Camera> =
        places.iter().enumerate().map(|(index, from)| camera_at(index, *from, SIZE, FOCAL_PX)).collect();
    taken(&cameras, SIZE, MOMENTS, |camera, at, moment| {
        let from = places[camera];
        let ray = Ray { from, along: cameras[camera].unproject(0, at, 1.0) - from };
        let (depth_m, colour) = world(&ray, moment);
        let exposure = exposures.get(camera).copied().unwrap_or(1.0);
        (depth_m, colour.map(|value| (255.0 * exposure * value) as u8))
    })
}

fn settings() -> Settings {
    Settings {
        gaussians: 2000,
        coarse: 150,
        unfold: 10,
        fine: 300,
        resolution: 16,
        width: 32,
        patience: 0,
        ..Settings::default()
    }
}

/// How close a model comes to the held-out camera.
fn learned(world: &World, views: &TrainingViews, initial: &InitialPoints) -> Quality {
    let cpu = Cpu::new();
    let mut trainer = Trainer::new(views, settings(), initial, &cpu).unwrap();
    while trainer.stage() != Stage::Done {
        trainer.step().unwrap();
    }
    let truth = seen(world, &[HELD_OUT_M], &[]);
    let motion = Motion::of(&truth, 0.01);
    let region = |camera: usize, moment: usize| {
        let moving: Vec<bool> =
            (0..truth.pixel_count()).map(|pixel| motion.moves(&truth, camera, moment, pixel)).collect();
        Region { depth: vec![true; moving.len()], moving, structure: false }
    };
    let picks: Vec<(usize, usize)> = (0..MOMENTS).map(|moment| (0, moment)).collect();
    measure(trainer.model(), &cpu, &truth, &picks, &region).unwrap()
}

/// From colour alone, and, where the figures are wanted, with depth beside it.
fn from_colour(case: &str, world: &World, places_m: &[[f64; 2]], exposures: &[f64]) -> Quality {
    let views = seen(world, places_m, exposures);
    let found = learned(world, &views.of_colour(), &InitialPoints::Surfaces);
    println!("{case}: {}", told(found));
    if std::env::var_os("L4D_WITH_DEPTH").is_some() {
        println!("{case}, with depth: {}", told(learned(world, &views, &InitialPoints::Surfaces)));
    }
    found
}

fn told(quality: Quality) -> String {
    let Quality { psnr_db, psnr_moving_db, depth_error_m, .. } = quality;
    format!("{psnr_db:.1} dB, moving {psnr_moving_db:.1?} dB, depth {depth_error_m:.3?} m")
}

/// Share of the clip that is over.
fn along(moment: usize) -> f64 {
    moment as f64 / (MOMENTS - 1) as f64
}

#[test]
fn a_white_wall_is_where_its_edges_say() {
    let world = |ray: &Ray, _: usize| nearest(ray.wall(|_| [0.85; 3]), [ray.floor(boarded)]);
    let found = from_colour("white wall", &world, &PLACES_M, &[]);
    assert!(found.psnr_db > 29.0 && found.depth_error_m.unwrap() < 0.4, "{found:?}");
}

#[test]
fn a_floor_like_a_mirror_is_no_hole() {
    let world = |ray: &Ray, _: usize| {
        let mirrored = |at: DVec3| {
            let along = DVec3::new(ray.along.x, -ray.along.y, 1.0);
            let reflected = Ray { from: at, along }.wall(papered).1;
            std::array::from_fn(|channel| 0.5 * boarded(at)[channel] + 0.5 * reflected[channel])
        };
        nearest(ray.wall(papered), [ray.floor(mirrored)])
    };
    let found = from_colour("mirror", &world, &PLACES_M, &[]);
    assert!(found.psnr_db > 27.0 && found.depth_error_m.unwrap() < 0.04, "{found:?}");
}

#[test]
fn what_enters_in_mid_clip_is_not_there_before() {
    let world = |ray: &Ray, moment: usize| {
        let centre = DVec3::new(1.4 - 2.0 * (along(moment) - 0.5), 0.3, 2.5);
        let card = ray.card(centre, 0.35, [0.8, 0.2, 0.15]).filter(|_| along(moment) > 0.5);
        nearest(room(ray), [card])
    };
    let found = from_colour("enters", &world, &PLACES_M, &[]);
    assert!(found.psnr_db > 25.0 && found.psnr_moving_db.unwrap() > 18.5, "{found:?}");
}

#[test]
fn two_things_that_touch_and_part_stay_two() {
    let world = |ray: &Ray, moment: usize| {
        let apart = 0.3 + 0.6 * (2.0 * along(moment) - 1.0).abs();
        let card = |x: f64, tint| ray.card(DVec3::new(x, 0.2, 2.5), 0.3, tint);
        nearest(room(ray), [card(-apart, [0.8, 0.2, 0.15]), card(apart, [0.15, 0.7, 0.2])])
    };
    let found = from_colour("touch and part", &world, &PLACES_M, &[]);
    assert!(found.psnr_db > 24.0 && found.psnr_moving_db.unwrap() > 21.0, "{found:?}");
}

#[test]
fn one_wrong_exposure_of_six_is_outvoted() {
    let world = |ray: &Ray, _: usize| room(ray);
    let right = from_colour("exposures right", &world, &PLACES_M, &[]);
    let found = from_colour("one exposure a third too high", &world, &PLACES_M, &[1.0, 1.33]);
    assert!(found.psnr_db > right.psnr_db - 3.5 && found.depth_error_m.unwrap() < 0.04, "{found:?}");
}

#[test]
fn two_cameras_are_enough_and_four_no_worse() {
    let world = |ray: &Ray, moment: usize| {
        let centre = DVec3::new(0.8 - 1.6 * along(moment), 0.2, 2.5);
        nearest(room(ray), [ray.card(centre, 0.3, [0.8, 0.2, 0.15])])
    };
    let [two, three, four] =
        [2, 3, 4].map(|count| from_colour(&format!("{count} cameras"), &world, &PLACES_M[..count], &[]));
    for found in [two, three, four] {
        assert!(found.psnr_db > 22.0 && found.psnr_moving_db.unwrap() > 16.5, "{found:?}");
        assert!(found.depth_error_m.unwrap() < 0.06, "{found:?}");
    }
    assert!(four.psnr_db > two.psnr_db - 0.5 && four.psnr_moving_db > two.psnr_moving_db);
}

#[test]
fn where_sparse_points_lack_pictures_are_enough() {
    let world = |ray: &Ray, _: usize| room(ray);
    let views = seen(&world, &PLACES_M, &[]).of_colour();
    // All points that there are lie on one spot of the wall.
    let poor = InitialPoints::Points((0..4).map(|x| ([0.1 * x as f32, 0.0, 4.0], [0.5; 3])).collect());
    let with_points = learned(&world, &views, &poor);
    let without = learned(&world, &views, &InitialPoints::Surfaces);
    println!("four points: {}", told(with_points));
    println!("no points: {}", told(without));
    assert!(
        without.psnr_db > 26.5 && without.psnr_db > with_points.psnr_db + 3.0,
        "{without:?} {with_points:?}"
    );
}

#[test]
fn where_everything_moves_the_clip_is_still_learned() {
    let world = |ray: &Ray, moment: usize| {
        let shift = DVec3::X * 0.6 * along(moment);
        nearest(ray.wall(|at| papered(at - shift)), [ray.floor(|at| boarded(at - shift))])
    };
    let found = from_colour("everything moves", &world, &PLACES_M, &[]);
    assert!(found.psnr_db > 22.5 && found.depth_error_m.unwrap() < 0.06, "{found:?}");
}
