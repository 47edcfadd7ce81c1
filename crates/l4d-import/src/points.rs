//! Points of surfaces: as PLY, and in COLMAP models of our cameras.

use glam::{DVec2, DVec3};
use l4d_data::Camera;
use l4d_formats::colmap::{CameraModel, Model, ModelCamera, ModelImage, ModelPoint, Observation};
use l4d_formats::ply;

use crate::pose;

const SUFFIX: &str = ".png";

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColouredPoint {
    /// World, metres.
    pub position: DVec3,
    /// Display colour.
    pub rgb: [u8; 3],
}

/// The bytes of a PLY file. Normals are zero: no reader uses them, and 3DGS readers fail without.
pub fn encode_ply(points: &[ColouredPoint]) -> Vec<u8> {
    let floats = ["x", "y", "z", "nx", "ny", "nz"].map(|name| (name, "float"));
    let bytes = ["red", "green", "blue"].map(|name| (name, "uchar"));
    let mut body = Vec::with_capacity(points.len() * 27);
    for point in points {
        for value in point.position.to_array().into_iter().chain([0.0; 3]) {
            body.extend((value as f32).to_le_bytes());
        }
        body.extend(point.rgb);
    }
    ply::encode(points.len(), floats.into_iter().chain(bytes), &body)
}

/// A model of cameras as they are at a frame, an image per camera, called like its view. Numbers begin with 1, as
/// COLMAP's do.
pub fn model_of_pinholes(cameras: &[&Camera], frame: u32, [width, height]: [u32; 2]) -> Model {
    let mut model = Model::default();
    for (id, camera) in (1..).zip(cameras) {
        let (rotation, translation) = pose::quaternion_and_translation(camera.camera_from_world(frame));
        model.cameras.push(ModelCamera {
            id,
            model: CameraModel::Pinhole,
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

/// Adds a point, and an observation of it to the images of the cameras that see it, at the positions given.
pub fn add_point(model: &mut Model, surface: ColouredPoint, error_px: f64, sightings: &[(&Camera, DVec2)]) {
    let id = model.points.len() as u64 + 1;
    let mut track = Vec::with_capacity(sightings.len());
    for (camera, position) in sightings {
        let is_its = |image: &&mut ModelImage| image.name.strip_suffix(SUFFIX) == Some(&camera.name);
        let Some(image) = model.images.iter_mut().find(is_its) else { continue };
        track.push((image.id, image.observations.len() as u32));
        image.observations.push(Observation { position: position.to_array(), point: Some(id) });
    }
    let ColouredPoint { position, rgb } = surface;
    model.points.push(ModelPoint { id, position, rgb, error_px, track });
}

/// The picture of a view in a model of ours.
pub fn picture_name(view: &str) -> String {
    format!("{view}{SUFFIX}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_27_bytes_after_the_header() {
        let point = ColouredPoint { position: DVec3::new(1.0, -2.0, 0.5), rgb: [1, 2, 255] };
        let bytes = encode_ply(&[point, point]);
        let header = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        assert_eq!(bytes.len() - header, 2 * 27);
        assert_eq!(bytes[header..header + 4], 1.0_f32.to_le_bytes());
        assert_eq!(bytes[header + 24..header + 27], [1, 2, 255]);
    }
}
