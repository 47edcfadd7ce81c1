//! The pictures of a question.

use l4d_endpoint::{EndpointError, Image};
use l4d_frames::overlay::{Mark, annotated, encode_jpeg, enlarge, object_colour};

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
        let ids = ids(sent, candidates, seen.frame);
        Image::new(encode_jpeg(&annotated(&seen.colour, &ids, sent.factor, &marks)))
    };
    frames.map(draw).collect()
}

/// The candidates as ids, row by row. Where they overlap, the smaller one is seen.
fn ids(sent: &SentFrames<'_>, candidates: &Candidates, frame: u32) -> Vec<u32> {
    let (width, height) = (sent.clip.width, sent.clip.height);
    let mut ids = vec![0; width as usize * height as usize];
    let mut masks: Vec<_> = candidates.objects.iter().zip(1..).collect();
    let area = |object: &crate::worker::Object| object.masks.get(&frame).map_or(0, l4d_masks::Mask::area);
    masks.sort_by_key(|(object, number)| (std::cmp::Reverse(area(object)), *number));
    for (object, number) in masks {
        let pixels = object.masks.get(&frame).into_iter().flat_map(|mask| mask.pixels());
        for (column, row) in pixels {
            ids[row as usize * width as usize + column as usize] = number;
        }
    }
    ids
}
