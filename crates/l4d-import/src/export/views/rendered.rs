//! Scenes that were rendered here: everything about them is known.

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Instance, Scene};
use l4d_data::{Camera, DataError};
use l4d_frames::drawn::RgbImage;
use l4d_frames::exr::read_frame;
use l4d_frames::{Display, Frame};
use l4d_masks::Mask;
use rayon::prelude::*;

use super::{Material, SceneViews};
use crate::export::HeldOut;
use crate::export::cloud::{Cloud, SeenFrame, View};

pub(super) struct Rendering {
    dir: SceneDir,
    size: UVec2,
    display: Display,
}

impl Rendering {
    pub(super) fn open(dir: &SceneDir, shows: HeldOut) -> Result<SceneViews, DataError> {
        let scene = Scene::read(&dir.scene())?;
        let size = [scene.width, scene.height];
        let rendering = Self { dir: dir.clone(), size: size.into(), display: Display::new(scene.exposure) };
        Ok(SceneViews {
            name: scene.name,
            profile: scene.profile,
            path: dir.scene(),
            masks_path: None,
            size,
            instances: scene.instances,
            frames: scene.profile.frames().collect(),
            notes: Vec::new(),
            cameras: scene.cameras,
            material: Material::Rendered(rendering),
            shows,
            reconstruction: None,
        })
    }

    /// Colour, depth and ids.
    pub(super) fn frame(&self, camera: &Camera, frame: u32) -> Result<Frame, DataError> {
        Ok(read_frame(&self.dir.frame(&camera.name, frame), self.size)?)
    }

    /// Display colours of a frame.
    pub(super) fn shown(&self, frame: &Frame) -> RgbImage {
        self.display.picture(frame)
    }

    pub(super) fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, DataError> {
        Ok(self.shown(&self.frame(camera, frame)?))
    }

    /// What a picture shows of some instances, leaving out those that it does not show.
    pub(super) fn masks<'i>(
        &self,
        instances: &'i [Instance],
        camera: &Camera,
        frame: u32,
    ) -> Result<Vec<(&'i Instance, Mask)>, DataError> {
        let surfaces = self.frame(camera, frame)?.surfaces;
        let visible: Vec<u32> = surfaces.visible().into_iter().map(|(id, _)| id).collect();
        let mask = |instance: &Instance| {
            let inside = |column, row| surfaces.id[surfaces.index(column, row)] == instance.id;
            Mask::from_fn(surfaces.width, surfaces.height, inside)
        };
        let instances = instances.iter().filter(|instance| visible.contains(&instance.id));
        Ok(instances.map(|instance| (instance, mask(instance))).collect())
    }

    pub(super) fn cloud<'a>(&self, training: &[&'a Camera], frame: u32) -> Result<Cloud<'a>, DataError> {
        let views = training.par_iter().map(|camera| {
            let seen = self.frame(camera, frame)?;
            Ok(View::new(camera, self.shown(&seen), seen.surfaces))
        });
        Ok(Cloud::Depth(SeenFrame::new(views.collect::<Result<_, DataError>>()?, frame)))
    }
}
