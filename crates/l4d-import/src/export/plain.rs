//! PNG pictures and the cameras as they are: for whoever writes a reader of his own.

use l4d_data::{Camera, DataError, json};
use serde::Serialize;

use super::Job;
use super::footage::Shot;
use super::manifest::{Called, Manifest};

/// `cameras.json`. Its first three fields are what l4d itself takes wherever it takes cameras.
#[derive(Debug, Serialize)]
struct Cameras<'a> {
    width: u32,
    height: u32,
    cameras: Vec<&'a Camera>,
    /// Null where nobody says.
    frames_per_second: Option<f64>,
    times: Vec<Time>,
}

#[derive(Debug, Serialize)]
struct Time {
    /// Number in the scene, also the stem of its pictures.
    frame: u32,
    seconds: Option<f64>,
    /// From 0 to 1 over the whole clip.
    time: f64,
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, tick } = job;
    let mut cameras = footage.training();
    cameras.extend(footage.held_out());
    cameras.sort_by_key(|camera| &camera.name);
    let mut shots = Vec::new();
    for camera in &cameras {
        let called = format!("images/{}", camera.name);
        let is_seen = camera.split == l4d_data::Split::Train || footage.shows_held_out_pictures();
        for &frame in footage.frames().iter().filter(|frame| is_seen && footage.saw(camera, **frame)) {
            let path = order.out.join(&called).join(format!("{frame:04}.png"));
            shots.push(Shot { camera, frame, path, depth: None });
        }
        manifest.cameras.push(Called::camera(camera, called));
    }
    footage.write_png(&shots, *tick)?;
    let time = |&frame: &u32| Time { frame, seconds: footage.seconds(frame), time: footage.share(frame) };
    let document = Cameras {
        width: footage.size()[0],
        height: footage.size()[1],
        cameras,
        frames_per_second: footage.frames_per_second(),
        times: footage.frames().iter().map(time).collect(),
    };
    json::write(&order.out.join("cameras.json"), &document)?;
    manifest.note("poses are world_from_camera, row by row, in OpenCV axes; pixel centres lie at halves");
    for camera in footage.held_out().into_iter().filter(|_| !footage.shows_held_out_pictures()) {
        manifest.note(format!("{} is held out: its pose is there, its pictures are not", camera.name));
    }
    Ok(manifest)
}
