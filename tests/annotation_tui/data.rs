//! Frames without Blender: the committed masks of the held-out view, painted in plain colours.

use std::collections::BTreeMap;

use half::f16;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::scene::{Generator, Instance, SCHEMA, Scene};
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Camera, Profile, Split, json};
use l4d_frames::exr::write_frame;
use l4d_frames::{Frame, Surfaces};
use l4d_masks::Mask;

use crate::support::{Dir, root};

pub(super) const SCENES: [&str; 3] = ["room_living_cats", "tabletop_mouse_cups", "room_office"];
const PROFILE: Profile = Profile::Tiny;

/// A folder with a benchmark of some shipped scenes, and their pictures in `data/tiny`.
pub(super) fn dir() -> Dir {
    let dir = Dir::new();
    for scene in SCENES {
        for file in ["scenes/{}.json", "queries/{}.jsonl", "queries/{}.absent.jsonl", "truth/tiny/{}.json"] {
            let file = format!("benchmark/{}", file.replace("{}", scene));
            dir.write(&file, std::fs::read(root().join(&file)).unwrap());
        }
        let bench = BenchDir::new(root().join("benchmark"));
        render(&dir, &Truth::read(&bench.truth(PROFILE, scene)).unwrap());
    }
    let scenes = SCENES.map(|scene| format!("\"{scene}\"")).join(", ");
    let manifest =
        format!("name = \"Three\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\nscenes = [{scenes}]\n");
    dir.write("benchmark/panoptic-l4d.toml", manifest);
    dir
}

/// What the held-out camera would have seen, into `data/tiny`.
pub(crate) fn render(dir: &Dir, truth: &Truth) {
    let to = SceneDir::new(&dir.path("data/tiny"), &truth.scene);
    json::write(&to.scene(), &description(truth)).unwrap();
    for &frame in &truth.frames {
        write_frame(&to.frame(&truth.test_view, frame), &picture(truth, frame)).unwrap();
    }
}

fn description(truth: &Truth) -> Scene {
    let instance = |instance: &l4d_data::truth::InstanceTruth| Instance {
        id: instance.id,
        name: instance.name.clone(),
        role: instance.role,
        category: instance.category.clone(),
        attributes: BTreeMap::new(),
        front: None,
    };
    let mut pose = [0.0; 16];
    [0, 5, 10, 15].into_iter().for_each(|diagonal| pose[diagonal] = 1.0);
    let width = f64::from(truth.width);
    let camera = Camera {
        name: truth.test_view.clone(),
        split: Split::Test,
        fx: width,
        fy: width,
        cx: width / 2.0,
        cy: f64::from(truth.height) / 2.0,
        world_from_camera: vec![pose],
    };
    Scene {
        schema: SCHEMA.to_owned(),
        name: truth.scene.clone(),
        scale: truth.scale,
        variant: 0,
        seed: 0,
        profile: truth.profile,
        stride: truth.profile.stride(),
        width: truth.width,
        height: truth.height,
        exposure: 1.0,
        generator: Generator { bpy: "none".to_owned(), scripts_sha256: "0".repeat(64) },
        cameras: vec![camera],
        instances: truth.instances.iter().map(instance).collect(),
        events: Vec::new(),
        digests: BTreeMap::new(),
    }
}

pub(crate) fn picture(truth: &Truth, frame: u32) -> Frame {
    let mut surfaces = Surfaces::empty(truth.width, truth.height);
    surfaces.depth_m.fill(1.0);
    for instance in &truth.instances {
        let Some(mask) = instance.masks.get(&frame_key(frame)) else { continue };
        let mask = Mask::from_rle(mask, truth.width, truth.height);
        for (column, row) in mask.pixels() {
            let index = surfaces.index(column, row);
            surfaces.id[index] = instance.id;
        }
    }
    let shade =
        |id: u32, channel: u32| 0.08 + 0.12 * f32::from((id.wrapping_mul(37 + 29 * channel) % 7) as u8);
    let rgb =
        surfaces.id.iter().map(|&id| [0, 1, 2].map(|channel| f16::from_f32(shade(id, channel)))).collect();
    Frame { surfaces, rgb }
}
