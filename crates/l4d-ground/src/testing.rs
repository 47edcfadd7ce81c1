//! Clips and questions for tests.

use l4d_data::{Camera, Interval, Name, Split, Timeline};
use l4d_frames::drawn::{DepthMap, RgbImage};

use crate::clip::{ClipFrame, ViewClip};
use crate::grounder::Question;

/// A clip without depth, whose frames differ in colour.
pub(crate) fn blank_clip(view: &str, width: u32, height: u32, frames: &[u32]) -> ViewClip {
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let camera = Camera {
        name: Name::new(view).unwrap(),
        split: Split::Train,
        fx: f64::from(width),
        fy: f64::from(width),
        cx: f64::from(width) / 2.0,
        cy: f64::from(height) / 2.0,
        world_from_camera: vec![identity],
    };
    let frame = |&frame: &u32| ClipFrame {
        frame,
        colour: RgbImage::from_pixel(width, height, [90, frame as u8, 60].into()),
        depth: DepthMap::empty(width, height),
    };
    ViewClip {
        camera,
        width,
        height,
        timeline: Timeline::CANONICAL,
        frames: frames.iter().map(frame).collect(),
    }
}

/// The same of the view `cam01`.
pub(crate) fn clip(width: u32, height: u32, frames: &[u32]) -> ViewClip {
    blank_clip("cam01", width, height, frames)
}

/// A sentence of the user's own.
pub(crate) fn sentence(text: &str) -> Question {
    Question { number: None, text: text.to_owned(), ..question("tabletop_cups", "001") }
}

/// A query of the benchmark.
pub(crate) fn question(scene: &str, number: &str) -> Question {
    Question {
        scene: Name::new(scene).unwrap(),
        number: Some(Name::new(number).unwrap()),
        text: "the cup".to_owned(),
        range: None,
    }
}

/// The same, asked about some frames alone.
pub(crate) fn asked_from(question: Question, first: u32, last: u32) -> Question {
    Question { range: Some(Interval::new(first, last).unwrap()), ..question }
}
