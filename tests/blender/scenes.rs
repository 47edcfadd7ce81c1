//! Scenes on real Blender: one of each scale; in the slow suite all of them.

use l4d_data::{Benchmark, Name, Scale};

use crate::support::{l4d, root, succeed};

fn benchmark() -> Benchmark {
    Benchmark::open(root().join("benchmark")).unwrap()
}

#[test]
fn a_scene_of_each_scale_builds_as_shipped_and_passes_its_checks() {
    let bench = benchmark();
    let scale = |scene: &Name| bench.tracks(scene).unwrap().scale;
    let first = |wanted: Scale| bench.manifest.scenes.iter().find(|scene| scale(scene) == wanted).cloned();
    // Tracks, depth and ids: what is shipped, and what the checks read. Colour is rendered by the tests beside it.
    builds_as_shipped(&Scale::ALL.into_iter().filter_map(first).collect::<Vec<_>>(), &["--samples", "0"]);
}

#[test]
#[ignore = "slow: renders 21 scenes"]
fn all_scenes_build_as_shipped_and_pass_their_checks() {
    builds_as_shipped(&benchmark().manifest.scenes, &[]);
}

fn builds_as_shipped(scenes: &[Name], more: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let list: Vec<&str> = scenes.iter().map(Name::as_str).collect();
    let list = list.join(",");
    let at = |verb: &str| {
        let mut command = l4d(&format!("{verb} --profile tiny --scenes {list}"));
        command.arg("--data").arg(folder.path());
        command
    };
    // Without --update-benchmark any difference from the committed tracks and truth is a finding.
    succeed(at("build-scenes").args(["--jobs", "2"]).args(more));
    succeed(&mut at("check-scenes"));
}
