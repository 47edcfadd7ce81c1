//! Pinhole cameras in OpenCV axes (x right, y down, z forward).
//!
//! The centre of pixel (column, row) is (column + 0.5, row + 0.5); `u = fx * x / z + cx`.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};

use crate::json::Document;
use crate::name::Name;
use crate::timeline::{FRAME_COUNT, is_per_clip};

/// Schema tag of `view.json`.
const VIEW_SCHEMA: &str = "l4d/view/1";

/// Whether a method may train on a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// Methods may use it.
    Train,
    /// Held out: only the judge looks at it.
    Test,
}

/// One view: intrinsics in pixels and the pose at each frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// View name, also the folder of its frames.
    pub name: Name,
    /// Training or held out.
    pub split: Split,
    /// Focal length along columns, pixels.
    pub fx: f64,
    /// Focal length along rows, pixels.
    pub fy: f64,
    /// Principal point, column, pixels.
    pub cx: f64,
    /// Principal point, row, pixels.
    pub cy: f64,
    /// Row-major 4x4 poses, metres: one (static camera) or one per canonical frame.
    pub world_from_camera: Vec<[f64; 16]>,
}

/// `view.json`: what the frames beside it were rendered with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ViewCard {
    /// [`VIEW_SCHEMA`].
    pub schema: String,
    /// Columns of the pictures, pixels.
    pub width: u32,
    /// Rows of the pictures, pixels.
    pub height: u32,
    #[serde(flatten)]
    pub camera: Camera,
}

impl ViewCard {
    /// That of a camera, for pictures of `[width, height]`.
    pub fn new(camera: Camera, [width, height]: [u32; 2]) -> Self {
        Self { schema: VIEW_SCHEMA.to_owned(), width, height, camera }
    }
}

impl Document for ViewCard {
    const SCHEMA: &'static str = VIEW_SCHEMA;
    const HINT: &'static str = "remove the frames of the view and run `l4d build-scenes` again";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        Some((format!("camera {}", self.camera.name), self.camera.problem()?))
    }
}

impl Camera {
    /// A training view with square pixels, the principal point in the middle of pictures of `[width, height]`, that
    /// stands still.
    pub fn new(name: Name, size: [u32; 2], focal_px: f64, world_from_camera: DMat4) -> Self {
        let [cx, cy] = size.map(|side| f64::from(side) / 2.0);
        let world_from_camera = vec![rows(world_from_camera)];
        Self { name, split: Split::Train, fx: focal_px, fy: focal_px, cx, cy, world_from_camera }
    }

    /// Pose at a canonical frame.
    pub fn world_from_camera(&self, frame: u32) -> DMat4 {
        let index = if self.world_from_camera.len() == 1 { 0 } else { frame as usize };
        from_rows(&self.world_from_camera[index])
    }

    /// Inverse pose at a canonical frame (rigid: the transpose of the rotation).
    pub fn camera_from_world(&self, frame: u32) -> DMat4 {
        self.world_from_camera(frame).inverse()
    }

    /// The point at planar depth 1 that is seen at pixel position `(u, v)`, camera axes.
    pub fn ray(&self, position: DVec2) -> DVec3 {
        DVec3::new((position.x - self.cx) / self.fx, (position.y - self.cy) / self.fy, 1.0)
    }

    /// The pixel position of a point in camera axes.
    pub fn position(&self, point_camera: DVec3) -> DVec2 {
        let DVec3 { x, y, z } = point_camera;
        DVec2::new(self.fx * x / z + self.cx, self.fy * y / z + self.cy)
    }

    /// World point (metres) of the pixel position `(u, v)` at planar depth `depth_m`.
    pub fn unproject(&self, frame: u32, position: DVec2, depth_m: f64) -> DVec3 {
        (self.world_from_camera(frame) * (self.ray(position) * depth_m).extend(1.0)).truncate()
    }

    /// Pixel position and planar depth (metres, negative behind the camera) of a world point.
    pub fn project(&self, frame: u32, point_world: DVec3) -> (DVec2, f64) {
        let point = (self.camera_from_world(frame) * point_world.extend(1.0)).truncate();
        (self.position(point), point.z)
    }

    /// The same camera for pictures of another size; the numbers here belong to pictures of `from` (width, height).
    pub fn resized(&self, from: [u32; 2], to: [u32; 2]) -> Self {
        let [x, y] = [0, 1].map(|axis| f64::from(to[axis]) / f64::from(from[axis]));
        Self { fx: self.fx * x, fy: self.fy * y, cx: self.cx * x, cy: self.cy * y, ..self.clone() }
    }

    /// What makes this camera unusable, if anything.
    pub fn problem(&self) -> Option<String> {
        for (field, value) in [("fx", self.fx), ("fy", self.fy)] {
            if !(value.is_finite() && value > 0.0) {
                return Some(format!("field `{field}` is {value}, but a focal length is positive"));
            }
        }
        if !(self.cx.is_finite() && self.cy.is_finite()) {
            return Some("fields `cx`, `cy` must be finite".to_owned());
        }
        if self.world_from_camera.is_empty() {
            return Some("field `world_from_camera` is empty".to_owned());
        }
        self.world_from_camera.iter().enumerate().find_map(|(index, pose)| {
            (!is_rigid(&from_rows(pose))).then(|| {
                format!("field `world_from_camera[{index}]` is not a rigid motion (rotation and translation)")
            })
        })
    }
}

/// What makes a list of cameras unusable, if anything: where, and why.
pub(crate) fn cameras_problem(cameras: &[Camera]) -> Option<(String, String)> {
    let mut names = BTreeSet::new();
    cameras.iter().find_map(|camera| {
        let twice = !names.insert(&camera.name);
        let problem = camera.problem().or_else(|| twice.then(|| "the name occurs twice".to_owned()))?;
        Some((format!("camera {}", camera.name), problem))
    })
}

/// The same for the views of a rendered scene, of which one is held out.
pub(crate) fn rendered_problem(cameras: &[Camera]) -> Option<(String, String)> {
    let tests = cameras.iter().filter(|camera| camera.split == Split::Test).count();
    let restless = cameras.iter().find(|camera| !is_per_clip(&camera.world_from_camera));
    cameras_problem(cameras)
        .or_else(|| {
            let message = format!("{tests} views are held out, but exactly one is");
            (tests != 1).then(|| ("field `cameras`".to_owned(), message))
        })
        .or_else(|| {
            let message = format!("field `world_from_camera` has neither 1 pose nor {FRAME_COUNT}");
            restless.map(|camera| (format!("camera {}", camera.name), message))
        })
}

/// The pose of a camera at `eye` that looks at `target`, world +Z up in the picture.
pub fn looking_at(eye: DVec3, target: DVec3) -> DMat4 {
    looking_at_with_up(eye, target, DVec3::Z)
}

/// The same with another direction up in the picture.
pub fn looking_at_with_up(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let forward = (target - eye).normalize_or(DVec3::X);
    let right = forward.cross(up).normalize_or(up.any_orthonormal_vector());
    DMat4::from_mat3_translation(DMat3::from_cols(right, forward.cross(right), forward), eye)
}

/// A pose as 16 numbers, row by row.
pub fn rows(pose: DMat4) -> [f64; 16] {
    pose.transpose().to_cols_array()
}

/// The pose of 16 numbers, row by row.
pub fn from_rows(numbers: &[f64; 16]) -> DMat4 {
    DMat4::from_cols_array(numbers).transpose()
}

/// Whether a pose is a rotation and a translation: neither mirrored nor scaled, and finite.
pub fn is_rigid(pose: &DMat4) -> bool {
    pose.is_finite() && is_rotation(&DMat3::from_mat4(*pose)) && pose.row(3) == DVec4::W
}

/// Whether a matrix is a rotation: neither mirrored nor scaled, and finite.
pub fn is_rotation(matrix: &DMat3) -> bool {
    (matrix.transpose() * *matrix).abs_diff_eq(DMat3::IDENTITY, 1e-4) && matrix.determinant() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        // Looks along world +X from (1, 2, 3): camera x = world -Y, camera y = world -Z.
        let pose = from_rows(&[0., 0., 1., 1., -1., 0., 0., 2., 0., -1., 0., 3., 0., 0., 0., 1.]);
        Camera { fy: 100.0, ..Camera::new(Name::new("cam00").unwrap(), [128, 96], 200.0, pose) }
    }

    #[test]
    fn intrinsics_follow_the_size_of_the_picture() {
        let resized = camera().resized([128, 96], [256, 48]);
        assert_eq!([resized.fx, resized.fy, resized.cx, resized.cy], [400.0, 50.0, 128.0, 24.0]);
        assert_eq!(resized.world_from_camera, camera().world_from_camera);
    }

    #[test]
    fn a_point_ahead_projects_by_hand() {
        let (position, depth_m) = camera().project(0, DVec3::new(5.0, 1.0, 1.0));
        assert_eq!(depth_m, 4.0);
        assert!((position - DVec2::new(200.0 / 4.0 + 64.0, 100.0 * 2.0 / 4.0 + 48.0)).length() < 1e-12);
    }

    #[test]
    fn unproject_inverts_project() {
        let camera = camera();
        let point = DVec3::new(7.5, 0.25, 3.5);
        let (position, depth_m) = camera.project(3, point);
        assert!((camera.unproject(3, position, depth_m) - point).length() < 1e-12);
    }

    #[test]
    fn mirrored_or_scaled_poses_are_problems() {
        // An axis mirrored, one scaled, a number that is none, a last row that no motion has.
        for (place, value) in [(2, -1.0), (2, 1.1), (3, f64::NAN), (15, 2.0)] {
            let mut bent = camera();
            bent.world_from_camera[0][place] = value;
            assert!(bent.problem().unwrap().contains("rigid"), "{place}");
        }
        let mut flat = camera();
        flat.fx = 0.0;
        assert!(flat.problem().unwrap().contains("fx"));
        assert_eq!(camera().problem(), None);
    }
}
