//! A model of our cameras, and points with the pictures that show them.

use glam::DVec2;
use l4d_data::Camera;

use super::{Lens, Model, ModelCamera, ModelImage, ModelPoint, Observation};
use crate::ply::ColouredPoint;
use crate::pose;

const SUFFIX: &str = ".png";

impl Model {
    /// Cameras as they stand at a frame, a picture each, called like its view. Numbers begin with 1, as COLMAP's do.
    pub fn of_pinholes(cameras: &[&Camera], frame: u32, [width, height]: [u32; 2]) -> Self {
        let mut model = Self::default();
        for (id, camera) in (1..).zip(cameras) {
            let (rotation, translation) = pose::quaternion_and_translation(camera.camera_from_world(frame));
            model.cameras.push(ModelCamera {
                id,
                lens: Lens::Pinhole,
                width: width.into(),
                height: height.into(),
                parameters: vec![camera.fx, camera.fy, camera.cx, camera.cy],
            });
            model.images.push(ModelImage {
                id,
                rotation,
                translation,
                camera: id,
                name: picture_name(&camera.name),
                observations: Vec::new(),
            });
        }
        model
    }

    /// Adds a point and notes it in the pictures of the cameras that see it, at the positions given.
    pub fn add_point(&mut self, surface: ColouredPoint, error_px: f64, sightings: &[(&Camera, DVec2)]) {
        let id = self.points.len() as u64 + 1;
        let mut track = Vec::with_capacity(sightings.len());
        for (camera, position) in sightings {
            let is_its = |image: &&mut ModelImage| image.name.strip_suffix(SUFFIX) == Some(&camera.name);
            let Some(image) = self.images.iter_mut().find(is_its) else { continue };
            track.push((image.id, image.observations.len() as u32));
            image.observations.push(Observation { position: position.to_array(), point: Some(id) });
        }
        let ColouredPoint { position, rgb } = surface;
        self.points.push(ModelPoint { id, position, rgb, error_px, track });
    }
}

/// The picture of a view in a model of ours.
pub fn picture_name(view: &str) -> String {
    format!("{view}{SUFFIX}")
}
