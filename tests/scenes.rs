//! Scenes on real Blender: one of each scale always, all of them and random variants with `L4D_SLOW=1`.

use std::path::Path;

use l4d_data::{Benchmark, Name, Profile, Scale};
use serde_json::Value;

use crate::support::{is_slow, l4d, root, succeed};

/// Draws of the recipes that nobody looked at while they were written.
const VARIANTS: [(&str, u32); 3] =
    [("outdoor_farm_buckets", 11), ("room_living_cats", 23), ("tabletop_mouse_cups", 37)];

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
    succeed(&mut at("build-scenes"));
    succeed(&mut at("check-scenes"));
}

#[test]
fn random_variants_pass_their_checks_with_their_own_queries() {
    if !is_slow() {
        return;
    }
    for (scene, variant) in VARIANTS {
        let folder = tempfile::tempdir().unwrap();
        let (bench, data) = (folder.path().join("drawn"), folder.path().join("data"));
        let mut draw = l4d(&["draw-variant", &variant.to_string(), "--scenes", scene, "--json"]);
        let output = draw.arg("--out").arg(&bench).arg("--data").arg(&data).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let grounded = document["scenes"][0]["grounded"].as_u64().unwrap();
        assert!(grounded >= 5, "only {grounded} sentences still mean one thing: {document:#}");
        check_variant(&bench, &data, &Name::new(scene).unwrap(), variant);
    }
}

fn check_variant(bench: &Path, data: &Path, scene: &Name, variant: u32) {
    let at = |verb: &str| {
        let mut command = l4d(&[verb, "--profile", "tiny"]);
        command.arg("--bench").arg(bench);
        command
    };
    succeed(at("build-scenes").arg("--data").arg(data));
    succeed(at("check-scenes").arg("--data").arg(data));
    succeed(&mut at("check-queries"));
    let drawn = Benchmark::open(bench).unwrap();
    assert_eq!(drawn.tracks(scene).unwrap().variant, variant);
    let shipped = Benchmark::open(root().join("benchmark")).unwrap();
    let truth = drawn.truth(Profile::Tiny, scene).unwrap();
    assert_ne!(truth, shipped.truth(Profile::Tiny, scene).unwrap(), "the variant is the benchmark again");
}
