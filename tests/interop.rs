//! `l4d export` and `l4d import-scene`, run as users run them. What the files hold is tested in `l4d-import`.

use glam::{DMat4, DVec3};
use l4d_data::{Camera, Split};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_masks::ids;
use l4d_testing::{SIZE, flat, name, scene, write_scene};
use serde_json::json;

use crate::support::Dir;

/// A folder with the scene `wall` in profile tiny: three cameras before a wall, the second is held out.
fn folder() -> Dir {
    let dir = Dir::new();
    let camera = |number: u32| {
        let split = if number == 1 { Split::Test } else { Split::Train };
        let pose = DMat4::from_translation(f64::from(number) * DVec3::X);
        Camera { split, ..Camera::new(name(format!("cam{number:02}")), SIZE, 140.0, pose) }
    };
    let scene = scene("wall", (0..3).map(camera).collect(), Vec::new());
    // The held-out pictures are not there, and are not needed.
    write_scene(&dir.path("data/tiny"), scene, |camera, _| {
        let mut picture = flat(|_, _| 0);
        picture.surfaces.depth_m.fill(2.0);
        (camera.split == Split::Train).then_some(picture)
    });
    dir
}

fn export(format: &str, out: &str) -> Vec<String> {
    let words = ["export", "wall", "--profile", "tiny", "--format", format, "--out", out];
    words.map(str::to_owned).to_vec()
}

#[test]
fn export_prints_where_the_manifest_stands_and_says_what_a_reader_must_know() {
    let dir = folder();
    let arguments = export("4dgaussians", "out");
    let run = dir.run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(run.stdout.trim(), "out/l4d-export.json");
    assert!(run.stderr.contains("pose of cam01 with grey pictures"), "{}", run.stderr);
    assert!(dir.path("out/ims/2/000008.png").is_file());
    let manifest = dir.json(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(manifest["complete"], true);
    assert_eq!(manifest["cameras"][2], json!({"name": "cam01", "held_out": true, "called": "ims/2"}));
}

#[test]
fn export_refuses_with_exit_code_2_and_a_hint() {
    let dir = folder();
    let refused = |format: &str, more: &[&str], said: &str| {
        let arguments = export(format, "refused");
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).chain(more.iter().copied()).collect();
        let run = dir.run(&arguments);
        assert_eq!(run.code, 2, "{}", run.stdout);
        assert!(run.stderr.contains(said), "`{said}` is not in: {}", run.stderr);
    };
    refused("blender", &[], "4dgaussians-dynerf");
    refused("colmap", &["--frames", "13"], "frame 13 is not rendered");
    refused("colmap", &["--held-out", "pictures"], "cam01");
    refused("lerf-ovs", &[], "truth/tiny/wall.json");
}

#[test]
fn a_capture_comes_in_with_the_masks_that_people_drew() {
    let dir = Dir::new();
    let picture = RgbImage::from_pixel(32, 24, Rgb([9, 99, 199]));
    let frame = |name: &str| json!({"file_path": format!("images/{name}.png"), "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]});
    dir.write("shelf/images/left.png", encode_colour(&picture));
    dir.write("shelf/images/right.png", encode_colour(&picture));
    let document = json!({"w": 32, "h": 24, "fl_x": 30.0, "frames": [frame("left"), frame("right")]});
    dir.write("shelf/transforms.json", document.to_string());
    dir.write("ids/right/0.png", ids::encode_palette(32, 24, &[3; 32 * 24]));
    let run = dir.json(&[
        "import-scene",
        "nerfstudio",
        "shelf",
        "--held-out",
        "right",
        "--masks",
        "ids",
        "--masks-format",
        "png",
    ]);
    assert_eq!(run["views"], 2);
    assert_eq!(run["depth"], "absent");
    assert_eq!(run["masks"], "data/captures/shelf/masks.json");
    let masks: serde_json::Value = serde_json::from_str(&dir.read("data/captures/shelf/masks.json")).unwrap();
    assert_eq!(masks["instances"][0]["name"], "object_3");
    let capture: serde_json::Value =
        serde_json::from_str(&dir.read("data/captures/shelf/capture.json")).unwrap();
    assert_eq!(capture["cameras"][1]["split"], "test");

    let run = dir.run(&["import-scene", "colmap", "shelf", "--out", "elsewhere"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("hint: give the folder that holds `sparse` and `images`"), "{}", run.stderr);
    let run = dir.run(&["import-scene", "nerfstudio", "shelf", "--masks", "ids"]);
    assert_eq!(run.code, 2, "masks without their format");
}
