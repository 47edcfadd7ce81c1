//! A small scene whose every pixel is known in closed form, written to disk as a whole dataset.
//!
//! A textured ground (scenery), a table (landmark), a ball that rolls behind a box, and a box that turns; five
//! cameras on an arc, profile `tiny`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use glam::{DMat3, DMat4, DVec2, DVec3, UVec2};
use half::f16;
use l4d_data::digest::sha256_file;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::name::Name;
use l4d_data::scene::{Event, FrameDigest, Generator, Role, SCHEMA as SCENE_SCHEMA, Scale, Scene};
use l4d_data::timeline::{FPS, FRAME_COUNT, LAST_FRAME};
use l4d_data::tracks::{SCHEMA as TRACKS_SCHEMA, Track, TrackedCamera, TrackedInstance, Tracks};
use l4d_data::truth::frame_key;
use l4d_data::{Camera, Interval, Profile, Split, json};

use crate::exr::write_frame;
use crate::frame::{Frame, Surfaces};
use crate::truth::truth_of_scene;

/// Id of the ball.
pub(crate) const BALL: u32 = 1;
/// Id of the box.
pub(crate) const BOX: u32 = 2;
/// Id of the table.
pub(crate) const TABLE: u32 = 1001;
const PROFILE: Profile = Profile::Tiny;

/// A solid at one frame.
enum Solid {
    Ball { centre: DVec3, radius_m: f64 },
    Block { centre: DVec3, axes: DMat3, extents: DVec3 },
}

impl Solid {
    /// Smallest positive parameter of the ray that hits the surface.
    fn hit(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        match *self {
            Self::Ball { centre, radius_m } => {
                let from_centre = origin - centre;
                let (a, b) = (direction.length_squared(), direction.dot(from_centre));
                let discriminant = b * b - a * (from_centre.length_squared() - radius_m * radius_m);
                (discriminant > 0.0).then(|| (-b - discriminant.sqrt()) / a).filter(|&t| t > 0.0)
            }
            Self::Block { centre, axes, extents } => {
                let origin = axes.transpose() * (origin - centre);
                let direction = axes.transpose() * direction;
                let (one, other) =
                    ((-extents / 2.0 - origin) / direction, (extents / 2.0 - origin) / direction);
                let (enter, leave) = (one.min(other).max_element(), one.max(other).min_element());
                (enter < leave && enter > 0.0).then_some(enter)
            }
        }
    }

    fn placement(&self) -> (DVec3, DMat3, DVec3) {
        match *self {
            Self::Ball { centre, radius_m } => (centre, DMat3::IDENTITY, DVec3::splat(2.0 * radius_m)),
            Self::Block { centre, axes, extents } => (centre, axes, extents),
        }
    }
}

fn solids(frame: u32) -> [(u32, Solid); 3] {
    let t = f64::from(frame) / f64::from(LAST_FRAME);
    let radius_m = 0.25;
    let ball = Solid::Ball { centre: DVec3::new(0.6 - 1.2 * t, 0.55, radius_m), radius_m };
    let extents = DVec3::new(0.5, 0.3, 0.4);
    let axes = DMat3::from_rotation_z(0.3 + t);
    let block = Solid::Block { centre: DVec3::new(-0.1, -0.2, 0.2), axes, extents };
    let centre = DVec3::new(-0.2, 1.3, 0.3);
    let table = Solid::Block { centre, axes: DMat3::IDENTITY, extents: DVec3::new(1.2, 0.5, 0.6) };
    [(BALL, ball), (BOX, block), (TABLE, table)]
}

fn camera_pose(index: usize) -> DMat4 {
    let azimuth = -1.57 + 0.25 * (index as f64 - 2.0);
    let position = DVec3::new(3.2 * azimuth.cos(), 3.2 * azimuth.sin(), 1.3 + 0.1 * (index % 2) as f64);
    let forward = (DVec3::new(0.0, 0.2, 0.2) - position).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let rotation = DMat3::from_cols(right, forward.cross(right), forward);
    DMat4::from_mat3_translation(rotation, position)
}

fn name(text: &str) -> Name {
    Name::new(text).unwrap()
}

/// Renders a view exactly; `tints` gives each id a colour.
fn render(camera: &Camera, frame: u32, size: UVec2) -> Frame {
    let solids = solids(frame);
    let mut surfaces = Surfaces::empty(size.x, size.y);
    let mut rgb = vec![[f16::from_f32(0.4), f16::from_f32(0.6), f16::from_f32(0.9)]; surfaces.id.len()];
    let pose = camera.world_from_camera(frame);
    for row in 0..size.y {
        for column in 0..size.x {
            let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let origin = pose.w_axis.truncate();
            // A point at depth 1: the ray parameter is then the planar depth.
            let direction = camera.unproject(frame, centre, 1.0) - origin;
            let ground = (direction.z < 0.0).then(|| (0, -origin.z / direction.z));
            let hits = solids.iter().filter_map(|(id, solid)| Some((*id, solid.hit(origin, direction)?)));
            let Some((id, depth_m)) = ground.into_iter().chain(hits).min_by(|a, b| a.1.total_cmp(&b.1))
            else {
                continue;
            };
            let index = surfaces.index(column, row);
            surfaces.depth_m[index] = depth_m as f32;
            surfaces.id[index] = id;
            rgb[index] = tint(id, origin + direction * depth_m);
        }
    }
    Frame { surfaces, rgb }
}

fn tint(id: u32, point: DVec3) -> [f16; 3] {
    let checker = ((point.x * 2.0).floor() + (point.y * 2.0).floor()) as i64 & 1;
    let colour = match id {
        BALL => [0.7, 0.1, 0.1],
        BOX => [0.1, 0.2, 0.7],
        TABLE => [0.35, 0.2, 0.1],
        _ => [0.3 + 0.1 * checker as f32; 3],
    };
    colour.map(f16::from_f32)
}

/// A dataset and a benchmark on disk, removed when dropped.
#[derive(Debug)]
pub(crate) struct FakeScene {
    folder: tempfile::TempDir,
    /// `scene.json`.
    pub(crate) scene: Scene,
    /// `benchmark/scenes/fake_yard.json`.
    pub(crate) tracks: Tracks,
}

/// Rendered once, copied for each test.
static PRISTINE: LazyLock<FakeScene> = LazyLock::new(FakeScene::render);

impl FakeScene {
    /// A scene on disk; all of it agrees.
    pub(crate) fn write() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy_folder(PRISTINE.folder.path(), folder.path());
        Self { folder, scene: PRISTINE.scene.clone(), tracks: PRISTINE.tracks.clone() }
    }

    fn render() -> Self {
        let (scene, tracks) = describe();
        let mut fake = Self { folder: tempfile::tempdir().unwrap(), scene, tracks };
        let size = UVec2::new(fake.scene.width, fake.scene.height);
        for camera in fake.scene.cameras.clone() {
            let mut digests = BTreeMap::new();
            for frame in PROFILE.frames() {
                let picture = render(&camera, frame, size);
                write_frame(&fake.dir().frame(&camera.name, frame), &picture).unwrap();
                digests.insert(frame_key(frame), picture.surfaces.digest());
            }
            json::write(&fake.dir().view_card(&camera.name), &camera).unwrap();
            fake.scene.digests.insert(camera.name, digests);
        }
        fake.save_descriptions();
        fake.save_truth();
        fake.save_checksums();
        fake
    }

    /// The folder of scenes.
    pub(crate) fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// The benchmark.
    pub(crate) fn bench(&self) -> BenchDir {
        BenchDir::new(self.folder.path().join("benchmark"))
    }

    /// The folder of the scene.
    pub(crate) fn dir(&self) -> SceneDir {
        SceneDir::new(&self.data(), &self.scene.name)
    }

    /// Writes scene.json and the tracks as they are in memory now.
    pub(crate) fn save_descriptions(&self) {
        json::write(&self.dir().scene(), &self.scene).unwrap();
        json::write(&self.bench().tracks(&self.scene.name), &self.tracks).unwrap();
        json::write(&self.dir().tracks(), &self.tracks).unwrap();
    }

    /// Writes the truth of the frames on disk.
    pub(crate) fn save_truth(&self) {
        let truth = truth_of_scene(&self.dir(), &self.scene).unwrap().unwrap();
        json::write_compact(&self.bench().truth(PROFILE, &self.scene.name), &truth).unwrap();
    }

    /// Writes SHA256SUMS of what is on disk now.
    pub(crate) fn save_checksums(&self) {
        let mut lines = String::new();
        let mut add = |relative: String| {
            let digest = sha256_file(&self.dir().root().join(&relative)).unwrap();
            lines.push_str(&format!("{digest}  {relative}\n"));
        };
        for camera in &self.scene.cameras {
            for frame in PROFILE.frames() {
                add(format!("frames/{}/{}.exr", camera.name, frame_key(frame)));
            }
        }
        add("scene.json".to_owned());
        std::fs::write(self.dir().checksums(), lines).unwrap();
    }

    /// Rewrites one frame after `change`, and everything that states its digest: only the content is wrong.
    pub(crate) fn change_frame(&mut self, view: &str, frame: u32, change: impl FnOnce(&mut Surfaces)) {
        let path = self.dir().frame(view, frame);
        let mut picture =
            crate::exr::read_frame(&path, UVec2::new(self.scene.width, self.scene.height)).unwrap();
        change(&mut picture.surfaces);
        write_frame(&path, &picture).unwrap();
        let digests = self.scene.digests.get_mut(view).unwrap();
        let digest: &mut FrameDigest = digests.get_mut(&frame_key(frame)).unwrap();
        *digest = picture.surfaces.digest();
        self.save_descriptions();
        self.save_checksums();
    }
}

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

fn describe() -> (Scene, Tracks) {
    let scene_name = name("fake_yard");
    let mut instances = Vec::new();
    for (position, (id, label, role, category)) in [
        (BALL, "ball_red", Role::Object, "ball"),
        (BOX, "box_blue", Role::Object, "box"),
        (TABLE, "table", Role::Landmark, "table"),
    ]
    .into_iter()
    .enumerate()
    {
        let placements = (0..FRAME_COUNT).map(|frame| solids(frame)[position].1.placement());
        let mut track = Track { centre: Vec::new(), axes: Vec::new(), extents: Vec::new() };
        for (centre, axes, extents) in placements {
            track.centre.push(centre.to_array());
            track.axes.push(axes.transpose().to_cols_array());
            track.extents.push(extents.to_array());
        }
        let attributes = BTreeMap::from([("colour".to_owned(), label.to_owned())]);
        let (category, front) = (category.to_owned(), None);
        instances.push(TrackedInstance { id, name: name(label), role, category, attributes, front, track });
    }
    let focal_over_width = 1.0;
    let size = DVec2::new(f64::from(PROFILE.width()), f64::from(PROFILE.height()));
    let views: Vec<(Name, Split, [f64; 16])> = (0..5)
        .map(|index| {
            let split = if index == 2 { Split::Test } else { Split::Train };
            (name(&format!("cam{index:02}")), split, camera_pose(index).transpose().to_cols_array())
        })
        .collect();
    let cameras = views.iter().map(|(name, split, pose)| Camera {
        name: name.clone(),
        split: *split,
        fx: focal_over_width * size.x,
        fy: focal_over_width * size.x,
        cx: size.x / 2.0,
        cy: size.y / 2.0,
        world_from_camera: vec![*pose],
    });
    let tracked_cameras = views.iter().map(|(name, split, pose)| TrackedCamera {
        name: name.clone(),
        split: *split,
        profiles: Profile::ALL.to_vec(),
        focal_over_width,
        world_from_camera: vec![*pose],
    });
    let roll =
        Event { subject: name("ball_red"), verb: "roll".to_owned(), object: None, frames: Interval::WHOLE };
    let scene = Scene {
        schema: SCENE_SCHEMA.to_owned(),
        name: scene_name.clone(),
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        profile: PROFILE,
        stride: PROFILE.stride(),
        width: PROFILE.width(),
        height: PROFILE.height(),
        exposure: 1.0,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: cameras.collect(),
        instances: instances.iter().map(TrackedInstance::instance).collect(),
        events: vec![roll.clone()],
        digests: BTreeMap::new(),
    };
    let tracks = Tracks {
        schema: TRACKS_SCHEMA.to_owned(),
        scene: scene_name,
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        fps: FPS,
        frame_count: FRAME_COUNT,
        exposure: 1.0,
        description: "A ball rolls behind a box.".to_owned(),
        instances,
        events: vec![roll],
        pair_reach_m: 0.5,
        pairs: Vec::new(),
        cameras: tracked_cameras.collect(),
    };
    (scene, tracks)
}
