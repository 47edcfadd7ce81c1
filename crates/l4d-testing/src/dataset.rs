//! Scenes on disk.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::{DVec3, UVec2};
use l4d_data::camera::ViewCard;
use l4d_data::camera::looking_at;
use l4d_data::digest::sha256_file;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::store::write_atomic;
use l4d_data::tracks::Tracks;
use l4d_data::truth::frame_key;
use l4d_data::{Camera, Scene, Split, json, sums};
use l4d_frames::exr::{read_frame, write_frame};
use l4d_frames::{Frame, Surfaces};

use crate::{SIZE, Thing, World, name, truth, write_manifest};

/// Writes pictures, cards of the views, `scene.json` and `SHA256SUMS` below `data`; `look` gives none for a picture that
/// is to be missing. Gives the scene with its digests.
pub fn write_scene(data: &Path, mut scene: Scene, look: impl Fn(&Camera, u32) -> Option<Frame>) -> Scene {
    let dir = SceneDir::new(data, &scene.name);
    for camera in &scene.cameras {
        let card = ViewCard::new(camera.clone(), [scene.width, scene.height]);
        json::write(&dir.view_card(&camera.name), &card).unwrap();
        for frame in scene.profile.frames() {
            let Some(picture) = look(camera, frame) else { continue };
            write_frame(&dir.frame(&camera.name, frame), &picture).unwrap();
            let digests = scene.digests.entry(camera.name.clone()).or_default();
            digests.insert(frame_key(frame), picture.surfaces.digest());
        }
    }
    json::write(&dir.scene(), &scene).unwrap();
    write_sums(&dir, &scene);
    scene
}

fn write_sums(dir: &SceneDir, scene: &Scene) {
    let pictures = scene
        .digests
        .iter()
        .flat_map(|(view, frames)| frames.keys().map(move |frame| format!("frames/{view}/{frame}.exr")));
    let files = pictures.chain(["scene.json".to_owned()]);
    let sums: BTreeMap<String, String> =
        files.map(|file| (file.clone(), sha256_file(&dir.root().join(file)).unwrap())).collect();
    write_atomic(&dir.checksums(), sums::to_text(&sums).as_bytes()).unwrap();
}

/// Copies all files of a folder into one that exists.
pub fn copy_folder(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            fs::create_dir(&target).unwrap();
            copy_folder(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), &target).unwrap();
        }
    }
}

/// The scene `yard` and a benchmark about it, removed when dropped: a ball that rolls behind a box, a box that turns, a
/// table, on a floor; five cameras on an arc, of which `cam02` is held out. All of it agrees until a test changes it.
#[derive(Debug)]
pub struct Dataset {
    folder: tempfile::TempDir,
    /// `scene.json`.
    pub scene: Scene,
    /// The tracks, here and in the benchmark.
    pub tracks: Tracks,
}

/// Drawn once, copied for each test.
static PRISTINE: LazyLock<Dataset> = LazyLock::new(Dataset::draw);

impl Dataset {
    /// Id of the ball, `ball_red`.
    pub const BALL: u32 = 1;
    /// Id of the box, `box_blue`.
    pub const BOX: u32 = 2;
    /// Id of the table, a landmark.
    pub const TABLE: u32 = 1001;

    /// A copy of its own.
    pub fn new() -> Self {
        let folder = crate::folder();
        copy_folder(PRISTINE.folder.path(), folder.path());
        Self { folder, scene: PRISTINE.scene.clone(), tracks: PRISTINE.tracks.clone() }
    }

    /// What is there.
    pub fn world() -> World {
        let ball = Thing {
            colour: |_| [0.7, 0.1, 0.1],
            ..Thing::ball(Self::BALL, "ball_red", 0.25, |time| DVec3::new(0.6 - 1.2 * time, 0.55, 0.25))
        };
        let block = Thing {
            turn: |time| 0.3 + time,
            colour: |_| [0.1, 0.2, 0.7],
            ..Thing::block(Self::BOX, "box_blue", DVec3::new(0.5, 0.3, 0.4), |_| DVec3::new(-0.1, -0.2, 0.2))
        };
        let table = Thing {
            colour: |_| [0.35, 0.2, 0.1],
            ..Thing::block(Self::TABLE, "table", DVec3::new(1.2, 0.5, 0.6), |_| DVec3::new(-0.2, 1.3, 0.3))
        };
        let camera = |index: u32| {
            let azimuth = -1.57 + 0.25 * (f64::from(index) - 2.0);
            let eye = DVec3::new(3.2 * azimuth.cos(), 3.2 * azimuth.sin(), 1.3 + 0.1 * f64::from(index % 2));
            let split = if index == 2 { Split::Test } else { Split::Train };
            let pose = looking_at(eye, DVec3::new(0.0, 0.2, 0.2));
            Camera { split, ..Camera::new(name(format!("cam{index:02}")), SIZE, 128.0, pose) }
        };
        let things = vec![ball, block, table, Thing::floor()];
        World { name: "yard", things, sky: [0.4, 0.6, 0.9], cameras: (0..5).map(camera).collect() }
    }

    fn draw() -> Self {
        let world = Self::world();
        let folder = crate::folder();
        let data = folder.path().join("data");
        let scene = write_scene(&data, world.scene(), |camera, frame| Some(world.look(camera, frame)));
        let dataset = Self { folder, scene, tracks: world.tracks() };
        dataset.save();
        dataset.save_truth();
        write_manifest(dataset.bench().root(), &[world.name]);
        dataset
    }

    /// The folder of scenes.
    pub fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    pub fn bench(&self) -> BenchDir {
        BenchDir::new(self.folder.path().join("benchmark"))
    }

    /// The folder of the scene.
    pub fn dir(&self) -> SceneDir {
        SceneDir::new(&self.data(), &self.scene.name)
    }

    /// Writes `scene.json`, `SHA256SUMS` and the tracks as they are in memory now.
    pub fn save(&self) {
        json::write(&self.dir().scene(), &self.scene).unwrap();
        json::write(&self.bench().tracks(&self.scene.name), &self.tracks).unwrap();
        json::write(&self.dir().tracks(), &self.tracks).unwrap();
        write_sums(&self.dir(), &self.scene);
    }

    /// Writes the truth of the pictures on disk.
    pub fn save_truth(&self) {
        let truth = truth(&self.scene, |camera, frame| self.frame(&camera.name, frame).surfaces);
        json::write_compact(&self.bench().truth(truth.profile, &truth.scene), &truth).unwrap();
    }

    /// A picture as it is on disk.
    pub fn frame(&self, view: &str, frame: u32) -> Frame {
        read_frame(&self.dir().frame(view, frame), UVec2::from_array(SIZE)).unwrap()
    }

    /// Rewrites one picture after `change`, and everything that states its digest: only the content is wrong.
    pub fn change_frame(&mut self, view: &str, frame: u32, change: impl FnOnce(&mut Surfaces)) {
        let mut picture = self.frame(view, frame);
        change(&mut picture.surfaces);
        write_frame(&self.dir().frame(view, frame), &picture).unwrap();
        let digests = self.scene.digests.get_mut(view).unwrap();
        digests.insert(frame_key(frame), picture.surfaces.digest());
        self.save();
    }
}

impl Default for Dataset {
    fn default() -> Self {
        Self::new()
    }
}
