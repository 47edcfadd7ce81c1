//! Scenes that were rendered here: everything about them is known.

use std::path::PathBuf;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Instance, Scene};
use l4d_data::{Camera, DataError};
use l4d_frames::drawn::RgbImage;
use l4d_frames::exr::read_frame;
use l4d_frames::{Display, Frame};
use l4d_masks::Mask;
use rayon::prelude::*;

use crate::export::cloud::{Cloud, View};

pub(super) struct Rendering {
    dir: SceneDir,
    scene: Scene,
    display: Display,
}

impl Rendering {
    pub(super) fn open(dir: &SceneDir) -> Result<Self, DataError> {
        let scene = Scene::read(&dir.scene())?;
        let display = Display::new(scene.exposure);
        Ok(Self { dir: dir.clone(), scene, display })
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) fn path(&self) -> PathBuf {
        self.dir.scene()
    }

    /// Colour, depth and ids.
    pub(super) fn frame(&self, camera: &Camera, frame: u32) -> Result<Frame, DataError> {
        let size = UVec2::new(self.scene.width, self.scene.height);
        Ok(read_frame(&self.dir.frame(&camera.name, frame), size)?)
    }

    /// Display colours of a frame.
    pub(super) fn shown(&self, frame: &Frame) -> RgbImage {
        self.display.picture(frame)
    }

    pub(super) fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, DataError> {
        Ok(self.shown(&self.frame(camera, frame)?))
    }

    pub(super) fn masks(&self, camera: &Camera, frame: u32) -> Result<Vec<(&Instance, Mask)>, DataError> {
        let surfaces = self.frame(camera, frame)?.surfaces;
        let visible: Vec<u32> = surfaces.visible().into_iter().map(|(id, _)| id).collect();
        let mask = |instance: &Instance| {
            let inside = |column, row| surfaces.id[surfaces.index(column, row)] == instance.id;
            Mask::from_fn(surfaces.width, surfaces.height, inside)
        };
        let instances = self.scene.instances.iter().filter(|instance| visible.contains(&instance.id));
        Ok(instances.map(|instance| (instance, mask(instance))).collect())
    }

    pub(super) fn cloud<'a>(&self, training: &[&'a Camera], frame: u32) -> Result<Cloud<'a>, DataError> {
        let views = training.par_iter().map(|camera| {
            let seen = self.frame(camera, frame)?;
            Ok(View::new(camera, self.shown(&seen), seen.surfaces))
        });
        Ok(Cloud::seen(views.collect::<Result<_, DataError>>()?, frame))
    }
}
