//! Made-up scenes for the tests of all crates: descriptions from a few words, pictures whose every pixel is known in
//! closed form, and both of them on disk as `l4d build-scenes` would have left them. Only for tests: it panics where
//! something is wrong.
#![expect(clippy::unwrap_used, reason = "a test that cannot make its scene has failed")]

mod dataset;
pub mod foreign;
mod world;

use std::collections::BTreeMap;
use std::path::Path;

use glam::DMat4;
use half::f16;
use l4d_data::layout::BenchDir;
use l4d_data::query::{Provenance, Source, text_digest};
use l4d_data::scene::{Generator, Instance, LANDMARK_IDS, Role, SCHEMA};
use l4d_data::store::write_atomic;
use l4d_data::truth::Truth;
use l4d_data::{
    Benchmark, Camera, Category, Interval, Name, Profile, Query, Scale, Scene, Split, Status, Temporal, json,
};
use l4d_frames::truth::{Observation, TruthBuilder};
use l4d_frames::{Frame, Surfaces};
use rustix::fs::{StatVfsMountFlags, statvfs};
use tempfile::TempDir;

pub use dataset::{Dataset, copy_folder, write_scene};
pub use world::{Shape, Thing, World};

/// Size of the pictures, pixels: that of profile `tiny`.
pub const SIZE: [u32; 2] = [128, 96];

/// A new folder: in memory where the system offers that, since many tests write thousands of small files.
pub fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    let is_roomy = statvfs(memory).is_ok_and(|memory| {
        memory.f_bavail * memory.f_frsize > 4 << 30 && !memory.f_flag.contains(StatVfsMountFlags::NOEXEC)
    });
    if is_roomy { tempfile::tempdir_in(memory).unwrap() } else { tempfile::tempdir().unwrap() }
}

/// Text that is a name.
pub fn name(text: impl Into<String>) -> Name {
    Name::new(text).unwrap()
}

/// A camera in the origin that looks along world +Z; for others `Camera { world_from_camera: ..., ..camera(...) }`, or
/// [`Camera::new`].
pub fn camera(view: &str, split: Split) -> Camera {
    Camera { split, ..Camera::new(name(view), SIZE, f64::from(SIZE[0]), DMat4::IDENTITY) }
}

/// An instance whose category is its name up to the first `_`; ids above 1000 are landmarks.
pub fn instance(id: u32, label: &str) -> Instance {
    Instance {
        id,
        name: name(label),
        role: if LANDMARK_IDS.contains(&id) { Role::Landmark } else { Role::Object },
        category: label.split('_').next().unwrap_or_default().to_owned(),
        attributes: BTreeMap::new(),
        front: None,
    }
}

/// A room of profile `tiny`, without events and digests.
pub fn scene(label: &str, cameras: Vec<Camera>, instances: Vec<Instance>) -> Scene {
    let profile = Profile::Tiny;
    Scene {
        schema: SCHEMA.to_owned(),
        name: name(label),
        scale: Scale::Room,
        variant: 0,
        seed: 0,
        profile,
        stride: profile.stride(),
        width: profile.width(),
        height: profile.height(),
        exposure: 1.0,
        generator: generator(),
        cameras,
        instances,
        events: Vec::new(),
        digests: BTreeMap::new(),
    }
}

/// Nothing made it.
pub fn generator() -> Generator {
    Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) }
}

/// A candidate of category action without a predicate; `whole` if it holds in all 97 frames.
pub fn query(id: &str, text: &str, referents: &[&str], [first, last]: [u32; 2]) -> Query {
    let frames = Interval::new(first, last).unwrap();
    Query {
        id: id.parse().unwrap(),
        text: text.to_owned(),
        categories: vec![Category::Action],
        referents: referents.iter().map(|referent| name(*referent)).collect(),
        temporal: if frames == Interval::WHOLE { Temporal::Whole } else { Temporal::While },
        frames: vec![frames],
        predicate: None,
        text_digest: text_digest(text, None),
        provenance: Provenance { source: Source::Author, note: String::new() },
        status: Status::Candidate,
    }
}

/// What the cameras of a scene see of its instances.
pub fn truth(scene: &Scene, look: impl Fn(&Camera, u32) -> Surfaces) -> Truth {
    let mut builder = TruthBuilder::new(scene).unwrap();
    for camera in &scene.cameras {
        for frame in scene.profile.frames() {
            let seen = Observation::of(&look(camera, frame), builder.wants_masks(&camera.name));
            builder.insert(&camera.name, frame, seen);
        }
    }
    builder.finish()
}

/// A picture of things that are all 1 m away, an id a pixel, each id in a colour of its own.
pub fn flat(id_at: impl Fn(u32, u32) -> u32) -> Frame {
    let pixels = (0..SIZE[1]).flat_map(|row| (0..SIZE[0]).map(move |column| (column, row)));
    let id: Vec<u32> = pixels.map(|(column, row)| id_at(column, row)).collect();
    let shade =
        |id: u32, channel: u32| 0.08 + 0.12 * f32::from((id.wrapping_mul(37 + 29 * channel) % 7) as u8);
    let rgb = id.iter().map(|&id| [0, 1, 2].map(|channel| f16::from_f32(shade(id, channel)))).collect();
    let surfaces = Surfaces { width: SIZE[0], height: SIZE[1], depth_m: vec![1.0; id.len()], id };
    Frame { surfaces, rgb }
}

/// A benchmark of these scenes with their queries.
pub fn write_benchmark(root: &Path, scenes: &[(Truth, Vec<Query>)]) -> Benchmark {
    let bench = BenchDir::new(root);
    for (truth, queries) in scenes {
        json::write_compact(&bench.truth(truth.profile, &truth.scene), truth).unwrap();
        json::write_lines(&bench.queries(&truth.scene), queries).unwrap();
    }
    let names: Vec<&str> = scenes.iter().map(|(truth, _)| truth.scene.as_str()).collect();
    write_manifest(root, &names);
    Benchmark::open(root).unwrap()
}

/// The manifest of a benchmark of these scenes, version 0.1.0.
pub fn write_manifest(root: &Path, scenes: &[&str]) {
    let text =
        format!("name = \"Made up\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = {scenes:?}\n");
    write_atomic(&BenchDir::new(root).manifest(), text.as_bytes()).unwrap();
}
