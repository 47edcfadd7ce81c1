//! A scene that is drawn by tracing its three surfaces: exact depth, known motion, no renderer needed.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec2, DVec3, UVec2};
use half::f16;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Generator, Instance, Role, SCHEMA, Scale, Scene};
use l4d_data::{Camera, Name, Profile, Split, json};
use l4d_frames::exr::{read_frame, write_frame};
use l4d_frames::{Frame, Surfaces};

pub(super) const SCENE: &str = "ball";

const SIZE: [u32; 2] = [128, 96];
const RADIUS_M: f64 = 0.25;

/// Four training cameras on an arc and a held-out one between them.
pub(super) fn write_scene(data: &Path) {
    let dir = SceneDir::new(data, SCENE);
    let cameras: Vec<Camera> = [-0.9, -0.3, 0.3, 0.9, 0.1]
        .into_iter()
        .enumerate()
        .map(|(index, x)| Camera {
            name: Name::new(format!("cam{index:02}")).unwrap(),
            split: if index == 4 { Split::Test } else { Split::Train },
            fx: 140.0,
            fy: 140.0,
            cx: 64.0,
            cy: 48.0,
            world_from_camera: vec![looking_at(DVec3::new(x, -3.0, 1.2), DVec3::new(0.0, 0.5, 0.2))],
        })
        .collect();
    for camera in &cameras {
        for frame in Profile::Tiny.frames() {
            write_frame(&dir.frame(&camera.name, frame), &drawn(camera, frame)).unwrap();
        }
    }
    let scene = Scene {
        schema: SCHEMA.to_owned(),
        name: Name::new(SCENE).unwrap(),
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        profile: Profile::Tiny,
        stride: Profile::Tiny.stride(),
        width: SIZE[0],
        height: SIZE[1],
        exposure: 1.0,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: String::new() },
        cameras,
        instances: vec![Instance {
            id: 1,
            name: Name::new("ball_a").unwrap(),
            role: Role::Object,
            category: "ball".to_owned(),
            attributes: BTreeMap::new(),
            front: None,
        }],
        events: Vec::new(),
        digests: BTreeMap::new(),
    };
    json::write(&dir.scene(), &scene).unwrap();
}

/// Turns off the light in all pictures of a camera.
pub(super) fn blacken(data: &Path, camera: &str) {
    let dir = SceneDir::new(data, SCENE);
    for frame in Profile::Tiny.frames() {
        let path = dir.frame(camera, frame);
        let mut picture = read_frame(&path, UVec2::from_array(SIZE)).unwrap();
        picture.rgb.fill([f16::ZERO; 3]);
        write_frame(&path, &picture).unwrap();
    }
}

fn drawn(camera: &Camera, frame: u32) -> Frame {
    let mut surfaces = Surfaces::empty(SIZE[0], SIZE[1]);
    let mut rgb = Vec::new();
    let centre = camera.world_from_camera(frame).transform_point3(DVec3::ZERO);
    let ball = DVec3::new(-0.8 + 1.6 * f64::from(frame) / 96.0, 0.2, RADIUS_M);
    for row in 0..SIZE[1] {
        for column in 0..SIZE[0] {
            let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            // Per metre of planar depth.
            let ray = camera.unproject(frame, at, 1.0) - centre;
            let (depth_m, id, colour) = traced(centre, ray, ball);
            let pixel = surfaces.index(column, row);
            surfaces.depth_m[pixel] = depth_m as f32;
            surfaces.id[pixel] = id;
            rgb.push(colour.map(f16::from_f64));
        }
    }
    Frame { surfaces, rgb }
}

/// Depth, instance and light of the first surface on a ray: ball, floor (z = 0), wall (y = 2).
fn traced(from: DVec3, ray: DVec3, ball: DVec3) -> (f64, u32, [f64; 3]) {
    let offset = from - ball;
    let (a, b, c) = (ray.dot(ray), offset.dot(ray), offset.dot(offset) - RADIUS_M * RADIUS_M);
    let discriminant = b * b - a * c;
    if discriminant > 0.0 {
        let depth_m = (-b - discriminant.sqrt()) / a;
        let up = ((from + ray * depth_m - ball) / RADIUS_M).z;
        return (depth_m, 1, [0.7 + 0.2 * up, 0.1, 0.05]);
    }
    let (floor_m, wall_m) = (-from.z / ray.z, (2.0 - from.y) / ray.y);
    if ray.z < 0.0 && floor_m < wall_m {
        let point = from + ray * floor_m;
        let odd = ((point.x / 0.4).floor() + (point.y / 0.4).floor()).rem_euclid(2.0) == 1.0;
        return (floor_m, 0, if odd { [0.6, 0.6, 0.55] } else { [0.1, 0.2, 0.3] });
    }
    let height = (from + ray * wall_m).z;
    (wall_m, 0, [0.3, 0.3 + 0.1 * height, 0.2])
}

/// Row-major pose of a camera in OpenCV axes.
fn looking_at(from: DVec3, to: DVec3) -> [f64; 16] {
    let ahead = (to - from).normalize();
    let right = ahead.cross(DVec3::Z).normalize();
    let down = ahead.cross(right);
    let pose = DMat4::from_cols(right.extend(0.0), down.extend(0.0), ahead.extend(0.0), from.extend(1.0));
    pose.transpose().to_cols_array()
}
