//! A small scene on disk whose every pixel is known in closed form, and the folders that tests look into.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::{DVec2, DVec3};
use l4d_data::camera::looking_at;
use l4d_data::capture::{CAPTURE, Capture, Depth, MaskSet, MaskedInstance};
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::store::write_atomic;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Camera, Name, Query, Scene, Split, json};
use l4d_frames::drawn::encode_colour;
use l4d_frames::{Display, Frame};
use l4d_import::points::{ColouredPoint, add_point, model_of_pinholes};
use l4d_masks::Mask;
use l4d_testing::{SIZE, Thing, copy_folder, name, query, truth, write_scene};

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
        let folder = l4d_testing::folder();
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
        set.write(self.capture_dir().root(), true).unwrap();
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
        vec![
            query("closed_form/001", "the ball that rolls", &["ball_red"], [0, 96]),
            query("closed_form/002", "the ball while it rises", &["ball_late"], [30, 80]),
            query("closed_form/003", "the two balls", &["ball_red", "ball_late"], [0, 96]),
        ]
    }

    /// What a camera sees, as it was rendered.
    pub(crate) fn frame(&self, view: &str, frame: u32) -> Frame {
        let size = glam::UVec2::new(self.scene.width, self.scene.height);
        l4d_frames::exr::read_frame(&self.dir().frame(view, frame), size).unwrap()
    }

    fn render() -> Self {
        let folder = l4d_testing::folder();
        let (data, world) = (folder.path().join("data"), closed_form());
        let described = Scene { exposure: 1.5, events: Vec::new(), ..world.scene() };
        let scene = write_scene(&data, described, |camera, frame| Some(world.look(camera, frame)));
        let truth = truth(&scene, |camera, frame| world.look(camera, frame).surfaces);
        let world = Self { folder, scene, truth };
        world.record();
        world
    }
}

/// Rendered once, copied for each test.
static PRISTINE: LazyLock<World> = LazyLock::new(World::render);

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

/// A ball that rolls over a slab, one that is hidden below the ground at first, and cameras on an arc that do not aim at
/// one point.
fn closed_form() -> l4d_testing::World {
    let ground = Thing {
        colour: |at| {
            [0.2 + 0.2 * f64::from(((at.x * 3.0).floor() + (at.y * 3.0).floor()) as i64 as u8 & 1); 3]
        },
        ..Thing::block(0, "ground", DVec3::new(50.0, 50.0, 0.0), |_| DVec3::ZERO)
    };
    let slab = Thing {
        colour: ground.colour,
        ..Thing::block(SLAB, "slab", DVec3::new(2.0, 1.6, 0.0), |_| DVec3::ZERO)
    };
    let ball = Thing {
        colour: |at| [0.6, 0.17 + 0.2 * at.z, 0.1],
        ..Thing::ball(BALL, "ball_red", 0.35, |time| DVec3::new(0.8 - 1.6 * time, 0.1, 0.35))
    };
    let late = Thing {
        colour: |_| [0.1, 0.5, 0.2],
        ..Thing::ball(LATE_BALL, "ball_late", 0.2, |time| DVec3::new(-0.6, -0.5, -0.3 + 0.6 * time))
    };
    let camera = |index: u32| {
        let (number, azimuth) = (f64::from(index), -1.57 + 0.3 * (f64::from(index) - 2.0));
        let eye = DVec3::new(3.1 * azimuth.cos(), 3.1 * azimuth.sin() + 0.3, 1.1 + 0.2 * (number % 2.0));
        let pose = looking_at(eye, DVec3::new(0.2 * (number - 1.5), 0.1, 0.3 + 0.05 * number));
        let split = if index == 2 { Split::Test } else { Split::Train };
        Camera { split, ..Camera::new(name(format!("cam{index:02}")), SIZE, 140.25, pose) }
    };
    l4d_testing::World {
        name: "closed_form",
        things: vec![ball, late, slab, ground],
        sky: [0.2, 0.4, 0.9],
        cameras: (0..5).map(camera).collect(),
    }
}
