//! What one camera shows over a clip: colour and depth, and from where.
//!
//! What drew it, and what only the truth knows, is not part of it.

use glam::{DVec2, DVec3};
use l4d_data::digest::sha256_hex;
use l4d_data::{Camera, Timeline};
use l4d_frames::drawn::{DepthMap, RgbImage};

/// A view over a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewClip {
    /// From where; its numbers belong to pictures of `width` x `height`.
    pub camera: Camera,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// When its frames were.
    pub timeline: Timeline,
    /// What is seen, by ascending frame.
    pub frames: Vec<ClipFrame>,
}

/// A view at a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct ClipFrame {
    /// Number on the timeline.
    pub frame: u32,
    /// Display colour.
    pub colour: RgbImage,
    /// Planar depth, metres, with how sure it is.
    pub depth: DepthMap,
}

impl ViewClip {
    /// The frames, ascending.
    pub fn frame_numbers(&self) -> impl ExactSizeIterator<Item = u32> {
        self.frames.iter().map(|frame| frame.frame)
    }

    /// What is seen at a frame.
    pub fn at(&self, frame: u32) -> Option<&ClipFrame> {
        let index = self.frames.binary_search_by_key(&frame, |seen| seen.frame).ok()?;
        self.frames.get(index)
    }

    /// World point (metres) that the centre of a pixel shows; none where there is no depth or it is not finite.
    pub fn point_world(&self, seen: &ClipFrame, column: u32, row: u32) -> Option<DVec3> {
        let depth_m = *seen.depth.depth_m.get(row as usize * self.width as usize + column as usize)?;
        let position = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let has_depth = depth_m.is_finite() && depth_m > 0.0;
        has_depth.then(|| self.camera.unproject(seen.frame, position, f64::from(depth_m)))
    }

    /// Digest of everything that can be seen.
    pub(crate) fn digest(&self) -> String {
        let mut bytes = Vec::new();
        bytes.extend(self.width.to_le_bytes());
        bytes.extend(self.height.to_le_bytes());
        let camera = &self.camera;
        let numbers = [camera.fx, camera.fy, camera.cx, camera.cy];
        let poses = camera.world_from_camera.iter().flatten();
        bytes.extend(numbers.iter().chain(poses).flat_map(|number| number.to_le_bytes()));
        bytes.extend(self.timeline.duration_s().to_le_bytes());
        for seen in &self.frames {
            bytes.extend(seen.frame.to_le_bytes());
            bytes.extend(seen.colour.as_raw());
            bytes.extend(seen.depth.depth_m.iter().flat_map(|depth_m| depth_m.to_le_bytes()));
            bytes.extend(seen.depth.alpha.iter().flat_map(|alpha| alpha.to_le_bytes()));
        }
        sha256_hex(&bytes)
    }
}
