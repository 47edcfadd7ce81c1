//! Frames without Blender: the committed masks of the held-out view, painted in plain colours.

use l4d_data::layout::BenchDir;
use l4d_data::scene::Instance;
use l4d_data::truth::{InstanceTruth, Truth, frame_key};
use l4d_data::{Profile, Scene, Split};
use l4d_frames::Frame;
use l4d_masks::Mask;
use l4d_testing::{camera, flat, instance, scene, write_scene};

use crate::support::Dir;

pub(crate) const SCENES: [&str; 3] = ["room_living_cats", "tabletop_mouse_cups", "room_office"];

/// A folder with a benchmark of some shipped scenes, and their pictures in `data/tiny`.
pub(crate) fn dir() -> Dir {
    let files = ["scenes/{}.json", "queries/{}.jsonl", "queries/{}.absent.jsonl", "truth/tiny/{}.json"];
    let dir = Dir::with_shipped("Three", &SCENES, &files);
    let bench = BenchDir::new(dir.path("benchmark"));
    for scene in SCENES {
        render(&dir, &Truth::read(&bench.truth(Profile::Tiny, scene)).unwrap());
    }
    dir
}

/// What the held-out camera would have seen, into `data/tiny`.
pub(crate) fn render(dir: &Dir, truth: &Truth) {
    let described =
        |seen: &InstanceTruth| Instance { category: seen.category.clone(), ..instance(seen.id, &seen.name) };
    let scene = Scene {
        scale: truth.scale,
        ..scene(
            &truth.scene,
            vec![camera(&truth.test_view, Split::Test)],
            truth.instances.iter().map(described).collect(),
        )
    };
    write_scene(&dir.path("data/tiny"), scene, |_, frame| Some(picture(truth, frame)));
}

pub(crate) fn picture(truth: &Truth, frame: u32) -> Frame {
    let seen = truth.instances.iter().filter_map(|instance| {
        let mask = instance.masks.get(&frame_key(frame))?;
        Some((instance.id, Mask::from_rle(mask, truth.width, truth.height)))
    });
    let seen: Vec<(u32, Mask)> = seen.collect();
    flat(|column, row| seen.iter().find(|(_, mask)| mask.get(column, row)).map_or(0, |(id, _)| *id))
}
