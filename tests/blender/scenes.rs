//! Scenes on real Blender: one of each scale; in the slow suite all of them, and random variants.

use std::path::Path;

use l4d_data::{Benchmark, Name, Profile, Scale};
use serde_json::Value;

use crate::support::{l4d, root, succeed};

/// A scene of each scale, and draws of it that no one looked at while the recipe was written.
const DRAWN: [&str; 3] = ["outdoor_farm_buckets", "room_living_cats", "tabletop_mouse_cups"];
const VARIANTS: [u32; 3] = [11, 23, 37];

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

#[test]
#[ignore = "slow: renders nine drawn scenes"]
fn random_variants_pass_their_checks_with_their_own_queries() {
    for variant in VARIANTS {
        let folder = tempfile::tempdir().unwrap();
        let (bench, data) = (folder.path().join("drawn"), folder.path().join("data"));
        let mut draw = l4d(&format!("draw-variant {variant} --scenes {} --json", DRAWN.join(",")));
        let output = draw.arg("--out").arg(&bench).arg("--data").arg(&data).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        for scene in document["scenes"].as_array().unwrap() {
            let grounded = scene["grounded"].as_u64().unwrap();
            assert!(grounded >= 5, "only {grounded} sentences still mean one thing: {scene:#}");
        }
        check_variant(&bench, &data, variant);
    }
}

/// Depth and ids suffice: the gates of visibility and the geometry across views do not look at colour.
fn check_variant(bench: &Path, data: &Path, variant: u32) {
    let at = |verb: &str| {
        let mut command = l4d(&format!("{verb} --profile small"));
        command.arg("--bench").arg(bench);
        command
    };
    succeed(at("build-scenes").args(["--samples", "0", "--jobs", "2", "--data"]).arg(data));
    succeed(at("check-scenes").arg("--data").arg(data));
    succeed(&mut at("check-queries"));
    let drawn = Benchmark::open(bench).unwrap();
    let shipped = Benchmark::open(root().join("benchmark")).unwrap();
    for scene in DRAWN {
        let scene = Name::new(scene).unwrap();
        assert_eq!(drawn.tracks(&scene).unwrap().variant, variant);
        let truth = drawn.truth(Profile::Small, &scene).unwrap();
        assert_ne!(
            truth,
            shipped.truth(Profile::Small, &scene).unwrap(),
            "the variant is the benchmark again"
        );
    }
}
