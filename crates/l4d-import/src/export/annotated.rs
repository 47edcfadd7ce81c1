//! Which cameras an export of annotations shows, and what has to be said of masks that a method could learn from.

use l4d_data::{Camera, DataError};

use super::manifest::Manifest;
use super::views::SceneViews;

/// Training cameras with masks, and held-out ones if their pictures are allowed: masks are pictures.
pub(super) fn cameras(views: &SceneViews) -> Result<Vec<&Camera>, DataError> {
    let held_out = views.held_out();
    let shown = held_out.iter().copied().filter(|_| views.shows_held_out_pictures());
    let is_annotated = |camera: &Camera| views.frames.iter().any(|&frame| views.is_annotated(camera, frame));
    let cameras: Vec<&Camera> =
        views.training().into_iter().chain(shown).filter(|camera| is_annotated(camera)).collect();
    if !cameras.is_empty() {
        return Ok(cameras);
    }
    let (message, hint) = match held_out.into_iter().any(is_annotated) {
        true => (
            "masks are there for the held-out view alone, and they are the truth",
            "draw on pictures of training views, or show the truth with `--held-out pictures`",
        ),
        false => (
            "no one drew masks on these pictures",
            "bring them in with `l4d import-scene --masks ... --masks-format ...`",
        ),
    };
    Err(views.wrong("masks", message.to_owned(), hint))
}

/// Says what such an export is.
pub(super) fn note(manifest: &mut Manifest, views: &SceneViews) {
    let origin =
        if views.has_depth() { "ids are those of the render" } else { "masks are those that people drew" };
    manifest
        .note(format!("{origin}: a method that learns from them has to say `ground_truth` in method.json"));
    if !views.shows_held_out_pictures() {
        manifest.note("the held-out camera is left out: its ids are the truth that results are judged by");
    }
}
