//! Scenes on real Blender: one of each scale always, all of them and random variants with `L4D_SLOW=1`.

use std::path::Path;

use l4d_data::{Benchmark, Name, Profile, Scale};
use serde_json::Value;

use crate::support::{is_slow, l4d, root, succeed};

/// A scene of each scale, and draws of it that nobody looked at while the recipe was written.
const DRAWN: [&str; 3] = ["outdoor_farm_buckets", "room_living_cats", "tabletop_mouse_cups"];
const VARIANTS: [u32; 3] = [11, 23, 37];

/// Scenes of the shipped benchmark: all of them, or the first of each scale.
fn chosen() -> Vec<Name> {
    let bench = Benchmark::open(root().join("benchmark")).unwrap();
    let scenes = bench.manifest.scenes.clone();
    if is_slow() {
        return scenes;
    }
    let scale = |scene: &Name| bench.tracks(scene).unwrap().scale;
    let first = |wanted: Scale| scenes.iter().find(|scene| scale(scene) == wanted).cloned();
    Scale::ALL.into_iter().filter_map(first).collect()
}

#[test]
fn scenes_build_as_shipped_and_pass_their_checks() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = chosen();
    let list: Vec<&str> = scenes.iter().map(Name::as_str).collect();
    let list = list.join(",");
    let at = |verb: &str| {
        let mut command = l4d(&[verb, "--profile", "tiny", "--scenes", &list]);
        command.arg("--data").arg(folder.path());
        command
    };
    // Without --update-benchmark any difference from the committed tracks and truth is a finding.
    succeed(at("build-scenes").args(["--jobs", "2"]));
    succeed(&mut at("check-scenes"));
}

#[test]
fn random_variants_pass_their_checks_with_their_own_queries() {
    if !is_slow() {
        return;
    }
    for variant in VARIANTS {
        let folder = tempfile::tempdir().unwrap();
        let (bench, data) = (folder.path().join("drawn"), folder.path().join("data"));
        let mut draw = l4d(&["draw-variant", &variant.to_string(), "--scenes", &DRAWN.join(","), "--json"]);
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
        let mut command = l4d(&[verb, "--profile", "small"]);
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
