//! Which cameras an export of annotations shows, and what has to be said of ids that nobody has in a real scene.

use l4d_data::Camera;

use super::footage::Footage;
use super::manifest::Manifest;

/// Training cameras, and the held-out one if its pictures are allowed: ids are pictures.
pub(super) fn cameras(footage: &Footage) -> Vec<&Camera> {
    let held_out = footage.held_out().filter(|_| footage.shows_held_out_pictures());
    footage.training().into_iter().chain(held_out).collect()
}

/// Says what such an export is.
pub(super) fn note(manifest: &mut Manifest, footage: &Footage) {
    manifest.note("ids are those of the render: a method that learns from them has to say `ground_truth` in method.json");
    if !footage.shows_held_out_pictures() {
        manifest.note("the held-out camera is left out: its ids are the truth that results are judged by");
    }
}
