//! Clips and questions for the tests of grounders that ask others.

use l4d_data::{Camera, Name, Split, Timeline};
use l4d_frames::drawn::{DepthMap, RgbImage};
use l4d_ground::{ClipFrame, Grounding, Question, ViewClip};

/// A clip whose frames differ in colour.
pub(crate) fn clip(width: u32, height: u32, frames: &[u32]) -> ViewClip {
    let pose = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let (fx, fy, cx, cy) =
        (f64::from(width), f64::from(width), f64::from(width) / 2.0, f64::from(height) / 2.0);
    let name = Name::new("cam01").unwrap();
    let camera = Camera { name, split: Split::Train, fx, fy, cx, cy, world_from_camera: vec![pose] };
    let frames = frames.iter().map(|&frame| {
        let mut colour = RgbImage::new(width, height);
        colour.pixels_mut().for_each(|pixel| pixel.0 = [90, frame as u8, 60]);
        ClipFrame { frame, colour, depth: DepthMap::empty(width, height) }
    });
    ViewClip { camera, width, height, timeline: Timeline::CANONICAL, frames: frames.collect() }
}

/// A sentence of the user's own.
pub(crate) fn question(text: &str) -> Question {
    Question { scene: Name::new("tabletop_cups").unwrap(), number: None, text: text.to_owned(), range: None }
}

/// Frames that have a mask.
pub(crate) fn frames_of(grounding: &Grounding) -> Vec<u32> {
    grounding.masks.keys().copied().collect()
}
