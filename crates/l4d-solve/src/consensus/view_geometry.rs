//! One view at a frame, as re-projection needs it: where the camera stands, and how far every pixel is.
//!
//! Owns which depths count as depths. Refuses to know masks and votes.

use glam::{DMat3, DMat4, DVec2, DVec3};
use half::f16;
use l4d_frames::drawn::DepthMap;
use l4d_ground::ViewClip;

use super::settings::ReprojectionSettings;

/// A view at a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewGeometry<'a> {
    depth: &'a DepthMap,
    /// None where it does not matter.
    min_alpha: Option<f16>,
    /// From camera axes to homogeneous pixels.
    pixels_from_camera: DMat3,
    camera_from_world: DMat4,
    world_from_camera: DMat4,
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Surface {
    /// Planar depth, metres.
    pub(super) depth_m: f64,
    index: usize,
}

/// From pixels and depths of one view to pixels and depths of another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Warp {
    turn: DMat3,
    shift: DVec3,
}

impl<'a> ViewGeometry<'a> {
    /// What `clip` shows at a canonical frame; none if it has no such frame, or its camera no pose there.
    pub(super) fn of_clip(clip: &'a ViewClip, frame: u32, settings: &ReprojectionSettings) -> Option<Self> {
        let camera = &clip.camera;
        let has_pose =
            camera.world_from_camera.len() == 1 || (frame as usize) < camera.world_from_camera.len();
        let depth = has_pose.then(|| clip.at(frame)).flatten().map(|seen| &seen.depth)?;
        let world_from_camera = camera.world_from_camera(frame);
        Some(Self {
            depth,
            min_alpha: (settings.min_alpha > 0.0).then(|| f16::from_f64(settings.min_alpha)),
            pixels_from_camera: DMat3::from_cols(
                DVec3::new(camera.fx, 0.0, 0.0),
                DVec3::new(0.0, camera.fy, 0.0),
                DVec3::new(camera.cx, camera.cy, 1.0),
            ),
            camera_from_world: world_from_camera.inverse(),
            world_from_camera,
        })
    }

    /// `(width, height)`, pixels.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.depth.width, self.depth.height)
    }

    /// What a pixel shows, if it has a depth.
    pub(super) fn surface(&self, column: u32, row: u32) -> Option<Surface> {
        let index = row as usize * self.depth.width as usize + column as usize;
        let depth_m = f64::from(*self.depth.depth_m.get(index)?);
        if !(depth_m.is_finite() && depth_m > 0.0) {
            return None;
        }
        // Comparisons with NaN are false: what is not known to be filled is not.
        let is_filled = match self.min_alpha {
            None => true,
            Some(least) => *self.depth.alpha.get(index)? >= least,
        };
        is_filled.then_some(Surface { depth_m, index })
    }

    /// How far the truth may be from what a pixel shows, metres: half of what lies between near and far.
    pub(super) fn spread_m(&self, surface: Surface) -> f64 {
        let [near, far] = [&self.depth.near_m, &self.depth.far_m]
            .map(|list| list.get(surface.index).map_or(f64::NAN, |depth_m| f64::from(*depth_m)));
        let half = (far - near) / 2.0;
        if half.is_finite() { half.max(0.0) } else { 0.0 }
    }

    /// The way from this view's pixels to those of another.
    pub(super) fn warp_to(&self, other: &Self) -> Warp {
        let camera_from_camera = other.camera_from_world * self.world_from_camera;
        let rotation = DMat3::from_mat4(camera_from_camera);
        let shift = other.pixels_from_camera * camera_from_camera.w_axis.truncate();
        Warp { turn: other.pixels_from_camera * rotation * self.pixels_from_camera.inverse(), shift }
    }
}

impl Warp {
    /// Position (pixels) and planar depth (metres) of the point that lies at a depth behind a position; none behind
    /// the other camera.
    pub(super) fn apply(&self, position: DVec2, depth_m: f64) -> Option<(DVec2, f64)> {
        let point = self.turn * position.extend(1.0) * depth_m + self.shift;
        (point.z > 0.0).then(|| (DVec2::new(point.x, point.y) / point.z, point.z))
    }
}

/// Middle of a pixel.
pub(super) fn centre(column: u32, row: u32) -> DVec2 {
    DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5)
}

/// The pixel of a picture that holds a position.
pub(super) fn pixel_at((width, height): (u32, u32), position: DVec2) -> Option<(u32, u32)> {
    let inside = position.x >= 0.0
        && position.y >= 0.0
        && position.x < f64::from(width)
        && position.y < f64::from(height);
    inside.then_some((position.x as u32, position.y as u32))
}
