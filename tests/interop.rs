//! `l4d export` and `l4d import-scene`, run as users run them. What the files hold is tested in `l4d-import`.

use glam::{DMat4, DVec3};
use l4d_data::{Camera, Split};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_masks::ids;
use l4d_testing::{SIZE, flat, name, scene, write_scene};
use serde_json::json;

use crate::support::Dir;

const EXPORT: &str = "export wall --profile tiny --out out --format";

/// [`wall`] with cameras a metre apart.
pub(crate) fn folder() -> Dir {
    wall(|number| number * DVec3::X)
}

/// A folder with the scene `wall` in profile tiny: three cameras before a wall, the second is held out.
pub(crate) fn wall(place: impl Fn(f64) -> DVec3) -> Dir {
    let dir = Dir::new();
    let camera = |number: u32| {
        let split = if number == 1 { Split::Test } else { Split::Train };
        let pose = DMat4::from_translation(place(number.into()));
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

#[test]
fn export_prints_where_the_manifest_is_and_says_what_a_reader_must_know() {
    let dir = folder();
    let run = dir.succeed(format!("{EXPORT} 4dgaussians"));
    assert_eq!(run.stdout.trim(), "out/l4d-export.json");
    run.says(0, &["pose of cam01 with grey pictures"]);
    assert!(dir.path("out/ims/2/000008.png").is_file());
    let manifest = dir.json(format!("{EXPORT} 4dgaussians"));
    assert_eq!(manifest["complete"], true);
    assert_eq!(manifest["cameras"][2], json!({"name": "cam01", "held_out": true, "called": "ims/2"}));
}

#[test]
fn exports_that_cannot_be_made_are_refused() {
    let dir = folder();
    for (format, reason) in [
        ("blender", "4dgaussians-dynerf"),
        ("colmap --frames 13", "frame 13 is not rendered"),
        ("colmap --held-out pictures", "cam01"),
        ("lerf-ovs", "truth/tiny/wall.json"),
    ] {
        dir.run(format!("{EXPORT} {format}")).says(2, &[reason]);
    }
}

pub(crate) const IMPORT: &str =
    "import-scene nerfstudio shelf --masks ids --masks-format png --held-out right";

/// A capture of two pictures, with masks.
pub(crate) fn shelf() -> Dir {
    let dir = Dir::new();
    let picture = RgbImage::from_pixel(32, 24, Rgb([9, 99, 199]));
    let frame = |name: &str| json!({"file_path": format!("images/{name}.png"), "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]});
    dir.write("shelf/images/left.png", encode_colour(&picture));
    dir.write("shelf/images/right.png", encode_colour(&picture));
    let document = json!({"w": 32, "h": 24, "fl_x": 30.0, "frames": [frame("left"), frame("right")]});
    dir.write("shelf/transforms.json", document.to_string());
    dir.write("ids/right/0.png", ids::encode_palette(32, 24, &[3; 32 * 24]));
    dir
}

#[test]
fn a_capture_comes_in_with_the_masks_that_people_drew() {
    let dir = shelf();
    let run = dir.json(IMPORT);
    let masks = json!("data/captures/shelf/masks.json");
    assert_eq!([&run["views"], &run["depth"], &run["masks"]], [&json!(2), &json!("absent"), &masks]);
    let masks = dir.value("data/captures/shelf/masks.json");
    assert_eq!(masks["instances"][0]["name"], "object_3");
    assert_eq!(dir.value("data/captures/shelf/capture.json")["cameras"][1]["split"], "test");

    let colmap = "import-scene colmap shelf --out elsewhere";
    dir.refuses(colmap, &["hint: give the folder that holds `sparse` and `images`"]);
    assert_eq!(dir.run("import-scene nerfstudio shelf --masks ids").code, 2, "masks without their format");
}
