//! What the tests of proposals share: shipped scenes with made-up pictures, and queries that a model could propose.

use half::f16;
use l4d_data::layout::SceneDir;
use l4d_data::tracks::Tracks;
use l4d_data::{Profile, json};
use l4d_frames::exr::write_frame;
use l4d_frames::{Frame, Surfaces};
use serde_json::{Value, json};

use super::scripted::Server;
use crate::support::{Dir, Run};

pub(super) const CUPS: &str = "tabletop_mouse_cups";
pub(super) const CATS: &str = "room_living_cats";
/// Folder of what is proposed.
pub(super) const PROPOSALS: &str = "work/tiny/proposals";

/// A folder with a benchmark of shipped scenes, each without its first `whole` and its first `while` query, and with
/// two grey pictures of each; the queries left out come back.
pub(super) fn stage(scenes: &[&str]) -> (Dir, Vec<Value>) {
    let dir =
        Dir::with_shipped("Some", scenes, &["scenes/{}.json", "truth/tiny/{}.json", "queries/{}.jsonl"]);
    let mut left_out = Vec::new();
    for scene in scenes {
        let file = format!("benchmark/queries/{scene}.jsonl");
        let mut queries = dir.lines(&file);
        for temporal in ["whole", "while"] {
            let first = queries.iter().position(|query| query["temporal"] == temporal).unwrap();
            left_out.push(queries.remove(first));
        }
        dir.write(&file, queries.iter().map(|query| format!("{query}\n")).collect::<String>());
        render(&dir, scene);
    }
    (dir, left_out)
}

fn tracks(dir: &Dir, scene: &str) -> Tracks {
    json::read(&dir.path(format!("benchmark/scenes/{scene}.json"))).unwrap()
}

/// Grey pictures of the held-out view at the first and last frame, and the description of the scene.
pub(super) fn render(dir: &Dir, name: &str) {
    let tracks = tracks(dir, name);
    let described = tracks.scene(Profile::Tiny, l4d_testing::generator());
    let place = SceneDir::new(&dir.path("data/tiny"), name);
    let surfaces = Surfaces::empty(Profile::Tiny.width(), Profile::Tiny.height());
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
    let tracks = tracks(dir, scene);
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

pub(super) const PROMPTS: &str =
    "propose-prompts --profile tiny --endpoint endpoint.toml --frames 2 --view-count 0";

pub(super) fn prompts(dir: &Dir, more: &str) -> Run {
    dir.run(format!("{PROMPTS} {more}"))
}

/// A file of proposals.
pub(super) fn lines(dir: &Dir, file: &str) -> Vec<Value> {
    dir.lines(&format!("{PROPOSALS}/{file}"))
}

pub(super) fn codes(failed: &Value) -> Vec<&str> {
    failed["reasons"].as_array().unwrap().iter().map(|reason| reason["code"].as_str().unwrap()).collect()
}
