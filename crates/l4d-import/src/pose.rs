//! Axes of cameras: what the tools of others call x, y and z.
//!
//! Ours are OpenCV's (x right, y down, z forward). Rotations in files of others are quaternions or 3x4 matrices; this
//! module turns one into the other and knows no file.

use glam::{DMat3, DMat4, DQuat, DVec3};

/// The pose in OpenGL's camera axes (x right, y up, z backward) of one in OpenCV's, or the other way round.
pub fn flipped(world_from_camera: DMat4) -> DMat4 {
    world_from_camera * DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0))
}

/// A pose as 16 numbers, row by row.
pub fn rows(pose: DMat4) -> [f64; 16] {
    pose.transpose().to_cols_array()
}

/// A pose as four rows of four numbers.
pub fn nested_rows(pose: DMat4) -> [[f64; 4]; 4] {
    pose.transpose().to_cols_array_2d()
}

/// The rotation next to a matrix that is one up to rounding: files keep few digits, quaternions allow no slack.
pub fn nearest_rotation(matrix: DMat3) -> DMat3 {
    // Newton's iteration for the polar decomposition doubles the digits; rounded rotations need two or three.
    (0..8).fold(matrix, |rotation, _| (rotation + rotation.inverse().transpose()) * 0.5)
}

/// Rotation and translation of `camera_from_world`, the rotation as a unit quaternion with positive real part.
pub fn quaternion_and_translation(camera_from_world: DMat4) -> (DQuat, DVec3) {
    let quaternion = DQuat::from_mat3(&nearest_rotation(DMat3::from_mat4(camera_from_world))).normalize();
    let quaternion = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    (quaternion, camera_from_world.w_axis.truncate())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flipping_twice_changes_nothing_and_once_turns_up_and_back() {
        let pose = DMat4::from_rotation_translation(
            DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(1.0),
            DVec3::new(1.0, 2.0, 3.0),
        );
        assert!(flipped(flipped(pose)).abs_diff_eq(pose, 1e-15));
        assert_eq!(flipped(pose).y_axis, -pose.y_axis);
        assert_eq!(flipped(pose).z_axis, -pose.z_axis);
        assert_eq!(flipped(pose).w_axis, pose.w_axis);
        assert_eq!(rows(pose)[3], 1.0);
        assert_eq!(nested_rows(pose)[0][3], 1.0);
    }

    #[test]
    fn a_rounded_rotation_becomes_one() {
        let exact = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(-0.3);
        let rounded = exact.to_cols_array().map(|value| (value * 1e6).round() / 1e6);
        let mended = nearest_rotation(DMat3::from_cols_array(&rounded));
        assert!((mended.transpose() * mended).abs_diff_eq(DMat3::IDENTITY, 1e-14));
        assert!(mended.abs_diff_eq(exact, 1e-6));
    }

    #[test]
    fn quaternions_have_one_sign() {
        let turned = DMat4::from_rotation_z(-3.0);
        let (quaternion, _) = quaternion_and_translation(turned);
        assert!(quaternion.w > 0.0);
        assert!(DMat3::from_quat(quaternion).abs_diff_eq(DMat3::from_mat4(turned), 1e-12));
    }
}
