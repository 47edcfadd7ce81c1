//! What the tests of proposals share: shipped scenes with made-up pictures, and queries that a model could propose.

use std::path::{Path, PathBuf};

use half::f16;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::scene::{Generator, SCHEMA, Scene};
use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::{Camera, Profile, json};
use l4d_frames::exr::write_frame;
use l4d_frames::{Frame, Surfaces};
use serde_json::{Value, json};

use super::scripted::Server;
use crate::support::{Dir, Run, root};

pub(super) const CUPS: &str = "tabletop_mouse_cups";
pub(super) const CATS: &str = "room_living_cats";

/// A folder with a benchmark of shipped scenes, each without its first `whole` and its first `while` query, and with
/// two grey pictures of each; the queries left out come back.
pub(super) fn stage(scenes: &[&str]) -> (Dir, Vec<Value>) {
    let dir = Dir::new();
    let shipped = BenchDir::new(root().join("benchmark"));
    let own = BenchDir::new(dir.path("benchmark"));
    let names: Vec<String> = scenes.iter().map(|scene| format!("\"{scene}\"")).collect();
    let manifest = format!(
        "name = \"Some\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = [{}]\n",
        names.join(", ")
    );
    dir.write("benchmark/panoptic-l4d.toml", manifest);
    let copy = |from: PathBuf, to: PathBuf| dir.write(to.to_str().unwrap(), std::fs::read(from).unwrap());
    copy(shipped.vocabulary(), own.vocabulary());
    let mut left_out = Vec::new();
    for scene in scenes {
        copy(shipped.tracks(scene), own.tracks(scene));
        copy(shipped.truth(Profile::Tiny, scene), own.truth(Profile::Tiny, scene));
        let text = std::fs::read_to_string(shipped.queries(scene)).unwrap();
        let mut queries: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        for temporal in ["whole", "while"] {
            let first = queries.iter().position(|query| query["temporal"] == temporal).unwrap();
            left_out.push(queries.remove(first));
        }
        let lines: String = queries.iter().map(|query| format!("{query}\n")).collect();
        dir.write(own.queries(scene).to_str().unwrap(), lines);
        render(&dir, scene);
    }
    (dir, left_out)
}

/// Grey pictures of the held-out view at the first and last frame, and the description of the scene.
pub(super) fn render(dir: &Dir, scene: &str) {
    let tracks: Tracks = json::read(&BenchDir::new(dir.path("benchmark")).tracks(scene)).unwrap();
    let profile = Profile::Tiny;
    let width = f64::from(profile.width());
    let cameras = tracks.views(profile).map(|camera| Camera {
        name: camera.name.clone(),
        split: camera.split,
        fx: camera.focal_over_width * width,
        fy: camera.focal_over_width * width,
        cx: width / 2.0,
        cy: width / 4.0 * 3.0 / 2.0,
        world_from_camera: camera.world_from_camera.clone(),
    });
    let described = Scene {
        schema: SCHEMA.to_owned(),
        name: tracks.scene.clone(),
        scale: tracks.scale,
        variant: tracks.variant,
        seed: tracks.seed,
        profile,
        stride: profile.stride(),
        width: profile.width(),
        height: profile.height(),
        exposure: tracks.exposure,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: cameras.collect(),
        instances: tracks.instances.iter().map(TrackedInstance::instance).collect(),
        events: tracks.events.clone(),
        digests: Default::default(),
    };
    let place = SceneDir::new(&dir.path("data/tiny"), scene);
    let surfaces = Surfaces::empty(profile.width(), profile.height());
    let rgb = vec![[f16::from_f32(0.25); 3]; surfaces.id.len()];
    let grey = Frame { surfaces, rgb };
    let held_out = described.test_camera().unwrap().name.clone();
    json::write(&place.scene(), &described).unwrap();
    for frame in [0, 96] {
        write_frame(&place.frame(&held_out, frame), &grey).unwrap();
    }
}

/// The proposal that asks for what a query asks for.
pub(super) fn proposal(dir: &Dir, query: &Value) -> Value {
    let scene = query["id"].as_str().unwrap().split('/').next().unwrap();
    let tracks: Tracks = json::read(&BenchDir::new(dir.path("benchmark")).tracks(scene)).unwrap();
    let referent = query["referents"][0].as_str().unwrap();
    let number = tracks.instances.iter().position(|found| found.name.as_str() == referent).unwrap() + 1;
    let frames = if query["temporal"] == "while" { query["frames"].clone() } else { json!([]) };
    json!({
        "category": query["categories"][0], "text": query["text"], "referents": [number],
        "temporal": query["temporal"], "frames": frames, "predicate": query["predicate"].to_string(),
    })
}

pub(super) fn answer(items: &[Value]) -> String {
    json!({ "proposals": items }).to_string()
}

/// Writes the description of a scripted server; one try, no long pauses.
pub(super) fn endpoint(dir: &Dir, server: &Server, more: &str) {
    let text = format!(
        "base_url = \"{}\"\nmodel = \"tiny\"\n{more}\n[retry]\ntries = 1\nfirst_pause_seconds = 0.01\n",
        server.url()
    );
    dir.write("endpoint.toml", text);
}

pub(super) const PROMPTS: [&str; 9] = [
    "propose-prompts",
    "--profile",
    "tiny",
    "--endpoint",
    "endpoint.toml",
    "--frames",
    "2",
    "--training-views",
    "0",
];

pub(super) fn prompts(dir: &Dir, more: &[&str]) -> Run {
    dir.run(&[&PROMPTS, more].concat())
}

pub(super) fn document(run: &Run) -> Value {
    serde_json::from_str(&run.stdout)
        .unwrap_or_else(|error| panic!("{error}\n{}\n{}", run.stdout, run.stderr))
}

pub(super) fn lines(dir: &Dir, file: &str) -> Vec<Value> {
    let text = dir.read(&format!("work/tiny/proposals/{file}"));
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

pub(super) fn codes(failed: &Value) -> Vec<&str> {
    failed["reasons"].as_array().unwrap().iter().map(|reason| reason["code"].as_str().unwrap()).collect()
}

/// Every file below a folder with its bytes.
pub(super) fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(files(&path)),
            false => found.push((path.clone(), std::fs::read(&path).unwrap())),
        }
    }
    found.sort();
    found
}
