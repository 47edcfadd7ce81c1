//! What an annotator may know of a scene that others recorded: pictures, and objects as far as people drew them.

use std::path::Path;

use glam::UVec2;
use l4d_data::capture::{Capture, MaskSet};
use l4d_data::layout::CaptureDir;
use l4d_data::{Camera, DataError, Name};
use l4d_votes::Round;

use super::{SceneInfo, chosen_views, numbered};

/// Reads the capture `<data>/<scene>`. Moments are those that the held-out view saw, and views those that saw all of
/// them.
pub(super) fn card(
    data: &Path,
    scene: &Name,
    round: &Round,
    annotator: &Name,
) -> Result<SceneInfo, DataError> {
    let dir = CaptureDir::new(data, scene);
    let refuse = |place: &str, message: &str, hint: &str| {
        Err(DataError::invalid(dir.root(), place, message.to_owned(), hint.to_owned()))
    };
    let capture = Capture::read(dir.root())?;
    let drawn = MaskSet::read(dir.root())?;
    let Some(held_out) = capture.held_out().next() else {
        return refuse("capture.json", "holds no view out", "import the scene with --held-out");
    };
    let frames: Vec<u32> =
        capture.frames.iter().copied().filter(|frame| capture.saw(&held_out.name, *frame)).collect();
    let is_drawn = |frame: u32| drawn.instances.iter().any(|one| one.mask(&held_out.name, frame).is_some());
    let Some(opening) = frames.iter().position(|frame| is_drawn(*frame)) else {
        return refuse("masks.json", "nothing is drawn on the held-out view", "draw objects on its pictures");
    };
    let sees_all = |camera: &&Camera| frames.iter().all(|frame| capture.saw(&camera.name, *frame));
    let cameras: Vec<Camera> = capture.cameras.iter().filter(sees_all).cloned().collect();
    let views = chosen_views(&cameras, round.views);
    let pictures = views.iter().flat_map(|view| frames.iter().map(move |frame| (view, *frame)));
    let missing = pictures.filter(|(view, frame)| !dir.picture(view, *frame).is_file());
    let missing = missing.count();
    if missing > 0 {
        return refuse("frames", &format!("lacks {missing} pictures"), "run `l4d import-scene` again");
    }
    let objects = drawn.instances.iter().map(|one| (one.id, one.name.clone())).collect();
    Ok(SceneInfo {
        size: UVec2::new(capture.width, capture.height),
        exposure: 1.0,
        views,
        frames,
        opening,
        frames_per_second: capture.frames_per_second,
        is_capture: true,
        objects: numbered(objects, scene, round.seed, annotator),
    })
}
