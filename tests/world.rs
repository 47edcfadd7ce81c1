//! Scenes that are drawn by tracing a few surfaces: exact depth, known motion, no renderer needed.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DVec2, DVec3, UVec2};
use half::f16;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::query::text_digest;
use l4d_data::scene::{Generator, Instance, Role, SCHEMA, Scale, Scene};
use l4d_data::truth::{InstanceTruth, Truth, frame_key};
use l4d_data::{Camera, Name, Profile, Split, json};
use l4d_frames::exr::{read_frame, read_surfaces, write_frame};
use l4d_frames::{Frame, Surfaces};
use l4d_masks::Mask;

pub(crate) const SCENE: &str = "ball";

pub(crate) const SIZE: [u32; 2] = [128, 96];
const RADIUS_M: f64 = 0.25;

/// A ball on the floor.
#[derive(Clone, Copy)]
struct Ball {
    id: u32,
    name: &'static str,
    /// Where it touches the floor, metres: start and end of a straight roll.
    path: [[f64; 2]; 2],
    colour: [f64; 3],
}

const ROLLING: Ball =
    Ball { id: 1, name: "ball_a", path: [[-0.8, 0.2], [0.8, 0.2]], colour: [0.7, 0.1, 0.05] };
const RESTING: Ball =
    Ball { id: 2, name: "ball_b", path: [[0.1, 1.1], [0.1, 1.1]], colour: [0.7, 0.1, 0.05] };

impl Ball {
    fn centre(&self, frame: u32) -> DVec3 {
        let [from, to] = self.path.map(|[x, y]| DVec3::new(x, y, RADIUS_M));
        from.lerp(to, f64::from(frame) / 96.0)
    }
}

/// One ball that rolls.
pub(crate) fn write_scene(data: &Path) {
    write(data, &[ROLLING]);
}

/// The same, and its twin that lies farther back.
pub(crate) fn write_twins(data: &Path) {
    write(data, &[ROLLING, RESTING]);
}

/// Four training cameras on an arc and a held-out one between them.
fn write(data: &Path, balls: &[Ball]) {
    let dir = SceneDir::new(data, SCENE);
    let cameras: Vec<Camera> = [-0.9, -0.3, 0.3, 0.9, 0.1]
        .into_iter()
        .enumerate()
        .map(|(index, x)| {
            camera_at(&format!("cam{index:02}"), if index == 4 { Split::Test } else { Split::Train }, x)
        })
        .collect();
    for camera in &cameras {
        for frame in Profile::Tiny.frames() {
            write_frame(&dir.frame(&camera.name, frame), &drawn(camera, frame, balls)).unwrap();
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
        instances: balls.iter().map(instance).collect(),
        events: Vec::new(),
        digests: BTreeMap::new(),
    };
    json::write(&dir.scene(), &scene).unwrap();
}

fn instance(ball: &Ball) -> Instance {
    Instance {
        id: ball.id,
        name: Name::new(ball.name).unwrap(),
        role: Role::Object,
        category: "ball".to_owned(),
        attributes: BTreeMap::new(),
        front: None,
    }
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

/// What a camera sees of the twins at a canonical frame, with ids.
pub(crate) fn twins_seen_by(camera: &Camera, frame: u32) -> Frame {
    drawn(camera, frame, &[ROLLING, RESTING])
}

/// A camera of the twins, at x metres on the arc.
pub(crate) fn camera_at(name: &str, split: Split, x: f64) -> Camera {
    Camera {
        name: Name::new(name).unwrap(),
        split,
        fx: 140.0,
        fy: 140.0,
        cx: 64.0,
        cy: 48.0,
        world_from_camera: vec![looking_at(DVec3::new(x, -3.0, 1.2), DVec3::new(0.0, 0.5, 0.2))],
    }
}

fn drawn(camera: &Camera, frame: u32, balls: &[Ball]) -> Frame {
    let mut surfaces = Surfaces::empty(SIZE[0], SIZE[1]);
    let mut rgb = Vec::new();
    let centre = camera.world_from_camera(frame).transform_point3(DVec3::ZERO);
    for row in 0..SIZE[1] {
        for column in 0..SIZE[0] {
            let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            // Per metre of planar depth.
            let ray = camera.unproject(frame, at, 1.0) - centre;
            let (depth_m, id, colour) = traced(centre, ray, frame, balls);
            let pixel = surfaces.index(column, row);
            surfaces.depth_m[pixel] = depth_m as f32;
            surfaces.id[pixel] = id;
            rgb.push(colour.map(f16::from_f64));
        }
    }
    Frame { surfaces, rgb }
}

/// Depth, instance and light of the first surface on a ray: balls, floor (z = 0), wall (y = 2).
fn traced(from: DVec3, ray: DVec3, frame: u32, balls: &[Ball]) -> (f64, u32, [f64; 3]) {
    let hits = balls.iter().filter_map(|ball| {
        let offset = from - ball.centre(frame);
        let (a, b, c) = (ray.dot(ray), offset.dot(ray), offset.dot(offset) - RADIUS_M * RADIUS_M);
        let discriminant = b * b - a * c;
        (discriminant > 0.0).then(|| ((-b - discriminant.sqrt()) / a, ball))
    });
    if let Some((depth_m, ball)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) {
        let up = ((from + ray * depth_m - ball.centre(frame)) / RADIUS_M).z;
        let [red, green, blue] = ball.colour;
        return (depth_m, ball.id, [red + 0.2 * up, green, blue]);
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

/// A benchmark about the twins: who rolls, who lies at the back, and who rolls through the middle of the clip. The
/// scene has to be written before.
pub(crate) fn write_twins_benchmark(bench: &Path, data: &Path) {
    let (bench, scene_dir) = (BenchDir::new(bench), SceneDir::new(data, SCENE));
    let manifest =
        format!("name = \"Twins\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = [\"{SCENE}\"]\n");
    std::fs::create_dir_all(bench.root()).unwrap();
    std::fs::write(bench.manifest(), manifest).unwrap();
    let scene = Scene::read(&scene_dir.scene()).unwrap();
    let frames: Vec<u32> = Profile::Tiny.frames().collect();
    let instance = |instance: &Instance| {
        let mask = |frame: u32| {
            let surfaces = read_surfaces(&scene_dir.frame("cam04", frame), UVec2::from_array(SIZE)).unwrap();
            Mask::from_ids(SIZE[0], SIZE[1], &surfaces.id, instance.id).unwrap()
        };
        let masks = frames.iter().map(|&frame| (frame_key(frame), mask(frame)));
        InstanceTruth {
            name: instance.name.clone(),
            id: instance.id,
            role: instance.role,
            category: instance.category.clone(),
            masks: masks
                .filter(|(_, mask)| !mask.is_empty())
                .map(|(key, mask)| (key, mask.to_rle()))
                .collect(),
        }
    };
    let truth = Truth {
        unannotated: Vec::new(),
        schema: l4d_data::truth::SCHEMA.to_owned(),
        scene: scene.name.clone(),
        scale: scene.scale,
        variant: 0,
        profile: Profile::Tiny,
        width: SIZE[0],
        height: SIZE[1],
        test_view: Name::new("cam04").unwrap(),
        instances: scene.instances.iter().map(instance).collect(),
        frames: frames.clone(),
        visible: BTreeMap::new(),
    };
    json::write_compact(&bench.truth(Profile::Tiny, SCENE), &truth).unwrap();
    let query = |number: &str, category: &str, text: &str, referent: &str, frames: [u32; 2]| {
        serde_json::json!({
            "id": format!("{SCENE}/{number}"),
            "text": text,
            "categories": [category],
            "referents": [referent],
            "temporal": if frames == [0, 96] { "whole" } else { "while" },
            "frames": [frames],
            "predicate": null,
            "text_digest": text_digest(text, None),
            "provenance": { "source": "author" },
            "status": "candidate",
        })
    };
    let queries = [
        query("001", "action", "The ball that rolls", "ball_a", [0, 96]),
        query("002", "spatial", "The ball nearest to the wall", "ball_b", [0, 96]),
        query("003", "action", "The ball while it rolls through the middle", "ball_a", [24, 72]),
    ];
    json::write_lines(&bench.queries(SCENE), &queries).unwrap();
}
