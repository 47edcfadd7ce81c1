//! What participants of a private test see of a scene: cameras, and the pictures of the training views, as a capture.
//!
//! A capture has no place for ids, depth, instances, events or seeds, and whatever takes captures takes it.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::capture::{CAPTURE, Capture, Depth, SCHEMA};
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::store::write_atomic;
use l4d_data::timeline::FPS;
use l4d_data::{Camera, DataError, Scene, Split, json};
use l4d_frames::Display;
use l4d_frames::drawn::encode_colour;
use l4d_frames::exr::read_frame;
use rayon::prelude::*;

/// Writes a rendered scene into a folder of captures; `source` says whose it is.
///
/// # Errors
/// A scene that is torn, and what the disk refuses.
pub fn write(rendering: &SceneDir, source: &str, data: &Path) -> Result<(), DataError> {
    let scene = Scene::read(&rendering.scene())?;
    let out = CaptureDir::new(data, &scene.name);
    let display = Display::new(scene.exposure);
    let frames: Vec<u32> = scene.profile.frames().collect();
    let (training, held_out): (Vec<&Camera>, Vec<&Camera>) =
        scene.cameras.iter().partition(|camera| camera.split == Split::Train);
    training
        .par_iter()
        .flat_map(|camera| frames.par_iter().map(move |&frame| (camera, frame)))
        .try_for_each(|(camera, frame)| {
            let seen = read_frame(&rendering.frame(&camera.name, frame), [scene.width, scene.height].into())?;
            write_atomic(&out.picture(&camera.name, frame), &encode_colour(&display.picture(&seen)))
        })?;
    let capture = Capture {
        schema: SCHEMA.to_owned(),
        name: scene.name.clone(),
        source: source.to_owned(),
        width: scene.width,
        height: scene.height,
        cameras: scene.cameras.clone(),
        frames: frames.clone(),
        frames_per_second: Some(FPS),
        depth: Depth::Absent,
        points: 0,
        is_metric: true,
        unseen: held_out.iter().map(|camera| (camera.name.clone(), frames.clone())).collect(),
        substituted: Vec::new(),
        inputs: BTreeMap::new(),
        notes: held_out
            .iter()
            .map(|camera| format!("the pictures of {} are held out", camera.name))
            .collect(),
    };
    json::write(&out.root().join(CAPTURE), &capture)
}
