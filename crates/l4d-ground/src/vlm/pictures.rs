//! The pictures of a question.

use l4d_endpoint::{EndpointError, Image};
use l4d_frames::Surfaces;
use l4d_frames::overlay::{Mark, encode_jpeg, enlarge, object_colour, outline};

use super::pick::Candidates;
use super::request::SentFrames;

/// The frames as they are.
pub(super) fn plain(sent: &SentFrames<'_>) -> Result<Vec<Image>, EndpointError> {
    let frames = sent.frames();
    frames.map(|seen| Image::new(encode_jpeg(&enlarge(&seen.colour, sent.factor)))).collect()
}

/// The frames with all candidates outlined and numbered.
pub(super) fn marked(sent: &SentFrames<'_>, candidates: &Candidates) -> Result<Vec<Image>, EndpointError> {
    let marks: Vec<Mark> = (0..candidates.objects.len())
        .map(|place| Mark {
            id: place as u32 + 1,
            number: place + 1,
            colour: object_colour(place),
            faint: false,
        })
        .collect();
    let frames = sent.frames();
    let draw = |seen: &crate::clip::ClipFrame| {
        let mut picture = enlarge(&seen.colour, sent.factor);
        let surfaces = surfaces(sent, candidates, seen.frame);
        outline(&mut picture, &surfaces, sent.factor, &marks);
        Image::new(encode_jpeg(&picture))
    };
    frames.map(draw).collect()
}

/// The candidates as an id picture. Where they overlap, the smaller one is seen.
fn surfaces(sent: &SentFrames<'_>, candidates: &Candidates, frame: u32) -> Surfaces {
    let (width, height) = (sent.clip.width, sent.clip.height);
    let pixels = width as usize * height as usize;
    let mut id = vec![0; pixels];
    let mut masks: Vec<_> = candidates.objects.iter().zip(1..).collect();
    let area = |object: &crate::worker::Object| object.masks.get(&frame).map_or(0, l4d_masks::Mask::area);
    masks.sort_by_key(|(object, number)| (std::cmp::Reverse(area(object)), *number));
    for (object, number) in masks {
        let pixels = object.masks.get(&frame).into_iter().flat_map(|mask| mask.pixels());
        for (column, row) in pixels {
            id[row as usize * width as usize + column as usize] = number;
        }
    }
    Surfaces { width, height, depth_m: vec![f32::INFINITY; pixels], id }
}
