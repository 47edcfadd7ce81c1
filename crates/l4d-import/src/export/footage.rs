//! The pictures and cameras of a scene, with the held-out camera behind a gate.
//!
//! Every layout gets its pictures here, so that none can show what the order forbids.

use std::path::{Path, PathBuf};

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Split};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_frames::exr::read_frame;
use l4d_frames::{Display, Frame};
use rayon::prelude::*;

use super::{HeldOut, Order};

/// What stands in for a picture that must not be shown.
const PLACEHOLDER: Rgb<u8> = Rgb([128; 3]);

/// A scene and what may be seen of it.
pub(super) struct Footage {
    dir: SceneDir,
    scene: Scene,
    frames: Vec<u32>,
    shown: HeldOut,
    display: Display,
}

/// One picture to be written.
pub(super) struct Shot<'a> {
    pub(super) camera: &'a Camera,
    pub(super) frame: u32,
    pub(super) path: PathBuf,
}

impl Footage {
    pub(super) fn open(order: &Order<'_>) -> Result<Self, DataError> {
        let path = order.scene.scene();
        let scene = Scene::read(&path)?;
        let rendered: Vec<u32> = scene.profile.frames().collect();
        if let Some(frame) = order.frames.iter().find(|frame| !rendered.contains(frame)) {
            let message = format!("frame {frame} is not rendered in profile {}", scene.profile);
            let remedy = format!("choose from 0, {}, ..., 96", scene.stride);
            return Err(DataError::invalid(&path, "field `stride`", message, remedy));
        }
        let mut frames = if order.frames.is_empty() { rendered } else { order.frames.to_vec() };
        frames.sort_unstable();
        frames.dedup();
        let display = Display::new(scene.exposure);
        Ok(Self { dir: order.scene.clone(), scene, frames, shown: order.held_out, display })
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) fn scene_path(&self) -> PathBuf {
        self.dir.scene()
    }

    /// Canonical frames, ascending.
    pub(super) fn frames(&self) -> &[u32] {
        &self.frames
    }

    /// Cameras that methods may train on.
    pub(super) fn training(&self) -> Vec<&Camera> {
        self.scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect()
    }

    /// The held-out camera, unless not even its pose may be shown.
    pub(super) fn held_out(&self) -> Option<&Camera> {
        self.scene.test_camera().filter(|_| self.shown != HeldOut::Nothing)
    }

    /// The cameras of a test split that may not be empty: the held-out one, or else a training camera once more.
    pub(super) fn test_split(&self) -> Vec<&Camera> {
        self.held_out().into_iter().chain(self.training()).take(1).collect()
    }

    /// Whether the true pictures of the held-out camera may be shown.
    pub(super) fn shows_held_out_pictures(&self) -> bool {
        self.shown == HeldOut::Pictures
    }

    /// Sees what a camera saw: colour, depth, ids. The held-out camera only if its pictures are allowed.
    pub(super) fn frame(&self, camera: &Camera, frame: u32) -> Result<Frame, DataError> {
        let path = self.dir.frame(&camera.name, frame);
        if camera.split == Split::Test && !self.shows_held_out_pictures() {
            let message = "is of the held-out camera, which this export must not show";
            return Err(DataError::invalid(
                &path,
                "picture",
                message,
                "ask for the pictures with `--held-out pictures`",
            ));
        }
        Ok(read_frame(&path, UVec2::new(self.scene.width, self.scene.height))?)
    }

    /// Display colours of a frame.
    pub(super) fn shown(&self, frame: &Frame) -> RgbImage {
        self.display.picture(frame)
    }

    /// Display colours of what a camera saw; grey for the held-out camera unless its pictures are allowed.
    pub(super) fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, DataError> {
        if camera.split == Split::Test && !self.shows_held_out_pictures() {
            return Ok(RgbImage::from_pixel(self.scene.width, self.scene.height, PLACEHOLDER));
        }
        Ok(self.shown(&self.frame(camera, frame)?))
    }

    /// Writes pictures as PNG, several at once.
    pub(super) fn write_png(&self, shots: &[Shot<'_>], tick: &(dyn Fn() + Sync)) -> Result<(), DataError> {
        shots.par_iter().try_for_each(|shot| {
            write_png(&shot.path, &self.picture(shot.camera, shot.frame)?)?;
            tick();
            Ok(())
        })
    }
}

/// Writes one picture as PNG.
pub(super) fn write_png(path: &Path, picture: &RgbImage) -> Result<(), DataError> {
    write_atomic(path, &encode_colour(picture))
}
