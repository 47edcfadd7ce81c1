//! The scene `ball`: one ball that rolls over a floor before a wall, or two of which one lies still.

use std::path::Path;

use glam::{DVec3, UVec2};
use half::f16;
use l4d_data::camera::looking_at;
use l4d_data::layout::SceneDir;
use l4d_data::{Camera, Category, Profile, Query, Scene, Split, json};
use l4d_frames::Frame;
use l4d_frames::exr::{read_frame, read_surfaces, write_frame};
use l4d_masks::Mask;
use l4d_testing::{Thing, World, name, query, truth, write_benchmark};

pub(crate) const SCENE: &str = "ball";

pub(crate) use l4d_testing::SIZE;

const RADIUS_M: f64 = 0.25;
const ROLLING: Thing = Thing {
    colour: light_of_ball,
    ..Thing::ball(1, "ball_a", RADIUS_M, |time| DVec3::new(-0.8 + 1.6 * time, 0.2, RADIUS_M))
};
const RESTING: Thing =
    Thing { colour: light_of_ball, ..Thing::ball(2, "ball_b", RADIUS_M, |_| DVec3::new(0.1, 1.1, RADIUS_M)) };

fn light_of_ball(at: DVec3) -> [f64; 3] {
    [0.7 + 0.2 * at.z / RADIUS_M, 0.1, 0.05]
}

/// Four training cameras on an arc and a held-out one between them.
fn world(balls: &[Thing]) -> World {
    let floor = Thing {
        colour: |at| {
            let odd = ((at.x / 0.4).floor() + (at.y / 0.4).floor()).rem_euclid(2.0) == 1.0;
            if odd { [0.6, 0.6, 0.55] } else { [0.1, 0.2, 0.3] }
        },
        ..Thing::floor()
    };
    let wall_m = DVec3::new(f64::INFINITY, 0.0, f64::INFINITY);
    let wall = Thing {
        colour: |at| [0.3, 0.3 + 0.1 * at.z, 0.2],
        ..Thing::block(0, "wall", wall_m, |_| 2.0 * DVec3::Y)
    };
    let cameras = [-0.9, -0.3, 0.3, 0.9, 0.1].into_iter().zip(0..).map(|(x, index)| {
        camera_at(&format!("cam{index:02}"), if index == 4 { Split::Test } else { Split::Train }, x)
    });
    World { name: SCENE, things: [balls, &[floor, wall]].concat(), sky: [0.0; 3], cameras: cameras.collect() }
}

/// One ball that rolls.
pub(crate) fn write_scene(data: &Path) {
    write(data, &[ROLLING]);
}

/// Where everything is in that scene, as a build writes it before it renders.
pub(crate) fn write_tracks(data: &Path) {
    json::write(&SceneDir::new(data, SCENE).tracks(), &world(&[ROLLING]).tracks()).unwrap();
}

/// The same, and its twin that lies farther back.
pub(crate) fn write_twins(data: &Path) {
    write(data, &[ROLLING, RESTING]);
}

fn write(data: &Path, balls: &[Thing]) {
    let world = world(balls);
    let scene = Scene { events: Vec::new(), ..world.scene() };
    l4d_testing::write_scene(data, scene, |camera, frame| Some(world.look(camera, frame)));
}

/// Turns off the light in all pictures of a camera.
pub(crate) fn blacken(data: &Path, camera: &str) {
    let dir = SceneDir::new(data, SCENE);
    for frame in Profile::Tiny.frames() {
        let path = dir.frame(camera, frame);
        let mut picture = read_frame(&path, UVec2::from_array(SIZE)).unwrap();
        picture.rgb.fill([f16::ZERO; 3]);
        write_frame(&path, &picture).unwrap();
    }
}

/// Gives all pixels of a camera a depth that cannot be, and other ids.
pub(crate) fn spoil_depth_and_ids(data: &Path, camera: &str) {
    let dir = SceneDir::new(data, SCENE);
    for frame in Profile::Tiny.frames() {
        let path = dir.frame(camera, frame);
        let mut picture = read_frame(&path, UVec2::from_array(SIZE)).unwrap();
        picture.surfaces.depth_m.fill(-1.0);
        picture.surfaces.id.iter_mut().for_each(|id| *id = 1 - (*id).min(1));
        write_frame(&path, &picture).unwrap();
    }
}

/// What a camera sees of the twins at a canonical frame, with ids.
pub(crate) fn twins_seen_by(camera: &Camera, frame: u32) -> Frame {
    world(&[ROLLING, RESTING]).look(camera, frame)
}

/// A camera of the twins, at x metres on the arc.
pub(crate) fn camera_at(view: &str, split: Split, x: f64) -> Camera {
    let pose = looking_at(DVec3::new(x, -3.0, 1.2), DVec3::new(0.0, 0.5, 0.2));
    Camera { split, ..Camera::new(name(view), SIZE, 140.0, pose) }
}

/// Where a view of the written scene shows an instance.
pub(crate) fn seen(data: &Path, view: &str, frame: u32, id: u32) -> Mask {
    let path = SceneDir::new(data, SCENE).frame(view, frame);
    let surfaces = read_surfaces(&path, UVec2::from_array(SIZE)).unwrap();
    Mask::from_ids(SIZE[0], SIZE[1], &surfaces.id, id).unwrap()
}

/// A benchmark about the twins: who rolls, who lies at the back, and who rolls through the middle of the clip. The
/// scene has to be written before.
pub(crate) fn write_twins_benchmark(bench: &Path, data: &Path) {
    let dir = SceneDir::new(data, SCENE);
    let scene = Scene::read(&dir.scene()).unwrap();
    let truth = truth(&scene, |camera, frame| {
        read_surfaces(&dir.frame(&camera.name, frame), UVec2::from_array(SIZE)).unwrap()
    });
    let back = query("ball/002", "The ball nearest to the wall", &["ball_b"], [0, 96]);
    let queries = vec![
        query("ball/001", "The ball that rolls", &["ball_a"], [0, 96]),
        Query { categories: vec![Category::Spatial], ..back },
        query("ball/003", "The ball while it rolls through the middle", &["ball_a"], [24, 72]),
    ];
    write_benchmark(bench, &[(truth, queries)]);
}
