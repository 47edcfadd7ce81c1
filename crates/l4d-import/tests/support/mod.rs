//! A small scene on disk whose every pixel is known in closed form, and the folders that tests look into.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::{DMat3, DMat4, DVec2, DVec3};
use half::f16;
use l4d_data::capture::{CAPTURE, Capture, Depth, MaskSet, MaskedInstance};
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::query::{Provenance, text_digest};
use l4d_data::scene::{Generator, Instance, Role, SCHEMA, Scale, Scene};
use l4d_data::store::write_atomic;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Camera, Category, Interval, Name, Profile, Query, Split, Status, Temporal, json};
use l4d_frames::drawn::encode_colour;
use l4d_frames::exr::write_frame;
use l4d_frames::truth::truth_of_scene;
use l4d_frames::{Display, Frame, Surfaces};
use l4d_import::points::{ColouredPoint, add_point, model_of_pinholes};
use l4d_masks::Mask;

pub(crate) const BALL: u32 = 1;
pub(crate) const LATE_BALL: u32 = 7;
pub(crate) const SLAB: u32 = 1001;
pub(crate) const TEST_VIEW: &str = "cam02";

/// A scene on disk, removed when dropped.
pub(crate) struct World {
    folder: tempfile::TempDir,
    pub(crate) scene: Scene,
    pub(crate) truth: Truth,
}

impl World {
    /// A copy of the scene.
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy_folder(PRISTINE.folder.path(), folder.path());
        Self { folder, scene: PRISTINE.scene.clone(), truth: PRISTINE.truth.clone() }
    }

    pub(crate) fn dir(&self) -> SceneDir {
        SceneDir::new(&self.folder.path().join("data"), &self.scene.name)
    }

    /// Where [`Self::record`] writes.
    pub(crate) fn capture_dir(&self) -> CaptureDir {
        CaptureDir::new(&self.folder.path().join("captures"), &self.scene.name)
    }

    /// Writes the scene as somebody would have recorded it, which is there from the start: pictures, points on the ground, and masks that people drew
    /// on every picture of the first camera and of the held-out one.
    fn record(&self) {
        let dir = self.capture_dir();
        for camera in &self.scene.cameras {
            for frame in self.frames() {
                let shown = Display::new(self.scene.exposure).picture(&self.frame(&camera.name, frame));
                write_atomic(&dir.picture(&camera.name, frame), &encode_colour(&shown)).unwrap();
            }
        }
        let points = self.reconstruct(&dir.sparse());
        let capture = Capture {
            schema: l4d_data::capture::SCHEMA.to_owned(),
            name: self.scene.name.clone(),
            source: "colmap".to_owned(),
            width: self.scene.width,
            height: self.scene.height,
            cameras: self.scene.cameras.clone(),
            frames: self.frames(),
            frames_per_second: Some(2.0),
            depth: Depth::Absent,
            points,
            is_metric: false,
            unseen: BTreeMap::new(),
            substituted: Vec::new(),
            inputs: BTreeMap::new(),
            notes: Vec::new(),
        };
        json::write(&dir.root().join(CAPTURE), &capture).unwrap();
        self.draw(&["cam00", TEST_VIEW], &self.frames());
    }

    /// Writes masks of the objects in some pictures into the capture.
    pub(crate) fn draw(&self, views: &[&str], frames: &[u32]) {
        let mask = |view: &str, frame: u32, id: u32| {
            let mask = Mask::from_ids(128, 96, &self.frame(view, frame).surfaces.id, id).unwrap();
            (frame_key(frame), (!mask.is_empty()).then(|| mask.to_rle()))
        };
        let instance = |(id, drawn, label): (u32, u32, &str)| MaskedInstance {
            id,
            name: Name::new(label.replace(": ", "_")).unwrap(),
            label: label.to_owned(),
            masks: (views.iter())
                .map(|view| {
                    let masks = frames.iter().map(|&frame| mask(view, frame, drawn)).collect();
                    (Name::new(*view).unwrap(), masks)
                })
                .collect(),
        };
        let set = MaskSet {
            schema: l4d_data::capture::MASKS_SCHEMA.to_owned(),
            scene: self.scene.name.clone(),
            width: self.scene.width,
            height: self.scene.height,
            instances: [(1, LATE_BALL, "ball: late"), (2, BALL, "ball: red")].map(instance).into(),
            notes: Vec::new(),
        };
        set.write(self.capture_dir().root()).unwrap();
    }

    /// Writes a model with points of the ground that all cameras see, and says how many.
    pub(crate) fn reconstruct(&self, folder: &Path) -> usize {
        let cameras: Vec<&Camera> = self.scene.cameras.iter().collect();
        let mut model = model_of_pinholes(&cameras, 0, [128, 96]);
        for index in 0..400 {
            let position =
                DVec3::new(f64::from(index % 20) * 0.1 - 1.0, f64::from(index / 20) * 0.1 - 1.0, 0.0);
            let surface = ColouredPoint { position, rgb: [index as u8, 40, 90] };
            let sightings: Vec<(&Camera, DVec2)> =
                cameras.iter().map(|camera| (*camera, camera.project(0, position).0)).collect();
            // Every tenth point took the held-out camera to find.
            let sightings = if index % 10 == 0 { &sightings[1..3] } else { &sightings[..] };
            add_point(&mut model, surface, 0.5, sightings);
        }
        model.write(folder).unwrap();
        model.points.len()
    }

    /// A folder for what a test writes.
    pub(crate) fn out(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes `scene.json` after a change.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut Scene)) {
        change(&mut self.scene);
        json::write(&self.dir().scene(), &self.scene).unwrap();
        self.record();
    }

    pub(crate) fn training(&self) -> Vec<&Camera> {
        self.scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect()
    }

    pub(crate) fn frames(&self) -> Vec<u32> {
        self.scene.profile.frames().collect()
    }

    /// Queries of the scene: one that holds throughout, one that is gated, one with two referents.
    pub(crate) fn queries(&self) -> Vec<Query> {
        let query = |number: &str, text: &str, referents: &[&str], frames: [u32; 2], temporal| Query {
            id: format!("closed_form/{number}").parse().unwrap(),
            text: text.to_owned(),
            categories: vec![Category::Action],
            referents: referents.iter().map(|name| Name::new(*name).unwrap()).collect(),
            temporal,
            frames: vec![Interval::new(frames[0], frames[1]).unwrap()],
            predicate: None,
            text_digest: text_digest(text, None),
            provenance: Provenance { source: "author".to_owned(), note: String::new() },
            status: Status::Candidate,
        };
        vec![
            query("001", "the ball that rolls", &["ball_red"], [0, 96], Temporal::Whole),
            query("002", "the ball while it rises", &["ball_late"], [30, 80], Temporal::While),
            query("003", "the two balls", &["ball_red", "ball_late"], [0, 96], Temporal::Whole),
        ]
    }

    /// What a camera sees, as it was rendered.
    pub(crate) fn frame(&self, view: &str, frame: u32) -> Frame {
        let size = glam::UVec2::new(self.scene.width, self.scene.height);
        l4d_frames::exr::read_frame(&self.dir().frame(view, frame), size).unwrap()
    }

    fn render() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = describe();
        let dir = SceneDir::new(&folder.path().join("data"), &scene.name);
        for camera in &scene.cameras {
            for frame in scene.profile.frames() {
                let picture = render(camera, frame, scene.width, scene.height);
                write_frame(&dir.frame(&camera.name, frame), &picture).unwrap();
            }
        }
        json::write(&dir.scene(), &scene).unwrap();
        let truth = truth_of_scene(&dir, &scene).unwrap().unwrap();
        let world = Self { folder, scene, truth };
        world.record();
        world
    }
}

/// Rendered once, copied for each test.
static PRISTINE: LazyLock<World> = LazyLock::new(World::render);

fn copy_folder(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            std::fs::create_dir(&target).unwrap();
            copy_folder(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), &target).unwrap();
        }
    }
}

/// Every file below a folder with its bytes, by path.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    collect(folder, folder, &mut found);
    found
}

fn collect(root: &Path, folder: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(root, &path, found);
        } else {
            let name = path.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
            found.insert(name, std::fs::read(&path).unwrap());
        }
    }
}

fn describe() -> Scene {
    let profile = Profile::Tiny;
    let camera = |index: usize| Camera {
        name: Name::new(format!("cam{index:02}")).unwrap(),
        split: if index == 2 { Split::Test } else { Split::Train },
        fx: 140.25,
        fy: 140.25,
        cx: f64::from(profile.width()) / 2.0,
        cy: f64::from(profile.height()) / 2.0,
        world_from_camera: vec![pose(index).transpose().to_cols_array()],
    };
    let instance = |id: u32, name: &str, role, category: &str| Instance {
        id,
        name: Name::new(name).unwrap(),
        role,
        category: category.to_owned(),
        attributes: BTreeMap::new(),
        front: None,
    };
    Scene {
        schema: SCHEMA.to_owned(),
        name: Name::new("closed_form").unwrap(),
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        profile,
        stride: profile.stride(),
        width: profile.width(),
        height: profile.height(),
        exposure: 1.5,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: (0..5).map(camera).collect(),
        instances: vec![
            instance(BALL, "ball_red", Role::Object, "ball"),
            instance(LATE_BALL, "ball_late", Role::Object, "ball"),
            instance(SLAB, "slab", Role::Landmark, "slab"),
        ],
        events: Vec::new(),
        digests: BTreeMap::new(),
    }
}

/// Cameras on an arc that do not aim at one point.
fn pose(index: usize) -> DMat4 {
    let azimuth = -1.57 + 0.3 * (index as f64 - 2.0);
    let position = DVec3::new(3.1 * azimuth.cos(), 3.1 * azimuth.sin() + 0.3, 1.1 + 0.2 * (index % 2) as f64);
    let aim = DVec3::new(0.2 * (index as f64 - 1.5), 0.1, 0.3 + 0.05 * index as f64);
    let forward = (aim - position).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    DMat4::from_mat3_translation(DMat3::from_cols(right, forward.cross(right), forward), position)
}

fn ball(frame: u32) -> (DVec3, f64) {
    (DVec3::new(0.8 - 1.6 * f64::from(frame) / 96.0, 0.1, 0.35), 0.35)
}

/// Hidden below the ground at first.
fn late_ball(frame: u32) -> (DVec3, f64) {
    (DVec3::new(-0.6, -0.5, -0.3 + 0.6 * f64::from(frame) / 96.0), 0.2)
}

fn render(camera: &Camera, frame: u32, width: u32, height: u32) -> Frame {
    let mut surfaces = Surfaces::empty(width, height);
    let mut rgb = vec![[0.2, 0.4, 0.9].map(f16::from_f32); surfaces.id.len()];
    let origin = camera.world_from_camera(frame).w_axis.truncate();
    for row in 0..height {
        for column in 0..width {
            let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            // A point at depth 1, so that the ray parameter is the planar depth.
            let direction = camera.unproject(frame, centre, 1.0) - origin;
            let Some((depth_m, id)) = hit(origin, direction, frame) else { continue };
            let index = surfaces.index(column, row);
            surfaces.depth_m[index] = depth_m as f32;
            surfaces.id[index] = id;
            rgb[index] = paint(id, origin + direction * depth_m).map(f16::from_f32);
        }
    }
    Frame { surfaces, rgb }
}

fn hit(origin: DVec3, direction: DVec3, frame: u32) -> Option<(f64, u32)> {
    let sphere = |id: u32, (centre, radius_m): (DVec3, f64)| {
        let offset = origin - centre;
        let (a, b) = (direction.length_squared(), direction.dot(offset));
        let discriminant = b * b - a * (offset.length_squared() - radius_m * radius_m);
        let depth_m = (-b - discriminant.sqrt()) / a;
        (discriminant > 0.0 && depth_m > 0.0).then_some((depth_m, id))
    };
    let ground = (direction.z < 0.0).then(|| -origin.z / direction.z).map(|depth_m| {
        let point = origin + direction * depth_m;
        (depth_m, if point.x.abs() < 1.0 && point.y.abs() < 0.8 { SLAB } else { 0 })
    });
    let hits = [sphere(BALL, ball(frame)), sphere(LATE_BALL, late_ball(frame)), ground];
    hits.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|hit| hit.0 < 30.0)
}

fn paint(id: u32, point: DVec3) -> [f32; 3] {
    let checker = ((point.x * 3.0).floor() + (point.y * 3.0).floor()) as i64 & 1;
    match id {
        BALL => [0.6, 0.1 + 0.2 * point.z as f32, 0.1],
        LATE_BALL => [0.1, 0.5, 0.2],
        _ => [0.2 + 0.2 * checker as f32; 3],
    }
}
