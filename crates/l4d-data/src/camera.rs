//! Pinhole cameras in OpenCV axes (x right, y down, z forward).
//!
//! The centre of pixel (column, row) is (column + 0.5, row + 0.5); `u = fx * x / z + cx`.

use glam::{DMat4, DVec2, DVec3, DVec4};
use serde::{Deserialize, Serialize};

use crate::name::Name;

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

impl Camera {
    /// Pose at a canonical frame.
    pub fn world_from_camera(&self, frame: u32) -> DMat4 {
        let index = if self.world_from_camera.len() == 1 { 0 } else { frame as usize };
        DMat4::from_cols_array(&self.world_from_camera[index]).transpose()
    }

    /// Inverse pose at a canonical frame (rigid: the transpose of the rotation).
    pub fn camera_from_world(&self, frame: u32) -> DMat4 {
        self.world_from_camera(frame).inverse()
    }

    /// World point (metres) of the pixel position `(u, v)` at planar depth `depth_m`.
    pub fn unproject(&self, frame: u32, position: DVec2, depth_m: f64) -> DVec3 {
        let point = DVec4::new(
            (position.x - self.cx) / self.fx * depth_m,
            (position.y - self.cy) / self.fy * depth_m,
            depth_m,
            1.0,
        );
        (self.world_from_camera(frame) * point).truncate()
    }

    /// Pixel position and planar depth (metres, negative behind the camera) of a world point.
    pub fn project(&self, frame: u32, point_world: DVec3) -> (DVec2, f64) {
        let point = self.camera_from_world(frame) * point_world.extend(1.0);
        let position =
            DVec2::new(self.fx * point.x / point.z + self.cx, self.fy * point.y / point.z + self.cy);
        (position, point.z)
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
        self.world_from_camera.iter().enumerate().find_map(|(index, pose)| rigid_problem(index, pose))
    }
}

fn rigid_problem(index: usize, pose: &[f64; 16]) -> Option<String> {
    let matrix = DMat4::from_cols_array(pose).transpose();
    if !matrix.is_finite() {
        return Some(format!("field `world_from_camera[{index}]` holds a number that is not finite"));
    }
    let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec4::truncate);
    let orthonormal =
        (0..3).all(|i| (0..3).all(|j| (axes[i].dot(axes[j]) - f64::from(u8::from(i == j))).abs() < 1e-4));
    let right_handed = axes[0].cross(axes[1]).dot(axes[2]) > 0.0;
    let affine = pose[12..] == [0.0, 0.0, 0.0, 1.0];
    (!(orthonormal && right_handed && affine)).then(|| {
        format!("field `world_from_camera[{index}]` is not a rigid motion (rotation and translation)")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        // Looks along world +X from (1, 2, 3): camera x = world -Y, camera y = world -Z.
        let pose = [0., 0., 1., 1., -1., 0., 0., 2., 0., -1., 0., 3., 0., 0., 0., 1.];
        Camera {
            name: Name::new("cam00").unwrap(),
            split: Split::Train,
            fx: 200.0,
            fy: 100.0,
            cx: 64.0,
            cy: 48.0,
            world_from_camera: vec![pose],
        }
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
        let mut mirrored = camera();
        mirrored.world_from_camera[0][2] = -1.0;
        assert!(mirrored.problem().unwrap().contains("rigid"));
        let mut flat = camera();
        flat.fx = 0.0;
        assert!(flat.problem().unwrap().contains("fx"));
        assert_eq!(camera().problem(), None);
    }
}
