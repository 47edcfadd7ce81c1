//! The reader of nerfstudio's `transforms.json`.

use std::path::Path;

use glam::{DMat4, DVec2, DVec3};
use l4d_frames::drawn::decode_depth_png;
use l4d_import::export::{Format, HeldOut};

use crate::support::{TEST_VIEW, World};
use crate::{Kind, RAY_TOLERANCE_PX, exported_as, json, matrix, png, probes, shown};

/// Where a camera with OpenGL axes sees a point.
fn seen(world_from_camera: DMat4, [fx, fy, cx, cy]: [f64; 4], point: DVec3) -> DVec2 {
    let local = world_from_camera.inverse().transform_point3(point);
    DVec2::new(fx * local.x / -local.z + cx, -fy * local.y / -local.z + cy)
}

#[test]
fn nerfstudio_has_rays_depth_and_a_split_in_every_moment() {
    let mut world = World::new();
    world.change(|scene| scene.cameras[0].cx += 2.5);
    for kind in Kind::ALL {
        let out = world.out(&format!("nerfstudio-{kind:?}"));
        exported_as(kind, &world, Format::Nerfstudio, HeldOut::Pose, &out);
        assert_nerfstudio(kind, &world, &out);
    }
}

fn assert_nerfstudio(kind: Kind, world: &World, out: &Path) {
    for frame in world.frames() {
        let folder = out.join(format!("frame_{frame:04}"));
        let document = json(&folder.join("transforms.json"));
        let entries = document["frames"].as_array().unwrap();
        assert_eq!(entries.len(), 5);
        let names = |split: &str| document[format!("{split}_filenames")].as_array().unwrap().clone();
        assert_eq!(names("train").len(), 4);
        assert_eq!(names("test"), [format!("images/{TEST_VIEW}.png")]);
        assert!(!names("train").contains(&names("test")[0]));
        for entry in entries {
            let view = entry["file_path"].as_str().unwrap().split(['/', '.']).nth(1).unwrap();
            let camera = world.scene.camera(view).unwrap();
            let intrinsics = ["fl_x", "fl_y", "cx", "cy"].map(|key| entry[key].as_f64().unwrap());
            for (point, at) in probes(camera, frame) {
                let found = seen(matrix(&entry["transform_matrix"]), intrinsics, point);
                assert!((found - at).length() < RAY_TOLERANCE_PX, "{view}: {found} for {at}");
            }
            if view != TEST_VIEW {
                let picture = png(&folder.join(entry["file_path"].as_str().unwrap()), 128, 96);
                assert_eq!(picture, shown(world, view, frame));
            }
            if kind == Kind::Captured {
                assert!(entry.get("depth_file_path").is_none() && !folder.join("depth").exists());
                continue;
            }
            let depth = std::fs::read(folder.join(entry["depth_file_path"].as_str().unwrap())).unwrap();
            let depth = decode_depth_png(&depth, 128, 96).unwrap();
            if view == TEST_VIEW {
                assert!(depth.iter().all(|depth_m| depth_m.is_infinite()), "the held-out camera shows depth");
                continue;
            }
            let truth = world.frame(view, frame).surfaces.depth_m;
            for (&stored, &depth_m) in depth.iter().zip(&truth) {
                assert!(stored == depth_m || (stored - depth_m).abs() <= 0.00051, "{stored} for {depth_m}");
            }
        }
    }
}
