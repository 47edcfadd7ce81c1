//! The masks of one scene as the page carries them: every distinct one once, as COCO text, small enough to look at.
//!
//! Masks are for the eye: no number of the page comes from them. A mask is only shown where it has the pixels that
//! were counted when the method was scored, so that a picture never contradicts the numbers beside it.

use std::collections::HashMap;

use l4d_data::{Query, Report};
use l4d_masks::Mask;
use l4d_score::judge::Answer;
use l4d_score::reading::SceneReader;
use l4d_score::truth::SceneTruth;

use crate::board::{Answer as Counted, BoardScene};

/// The page shows a frame of every so many canonical ones: no interval of a query is shorter than 13, so each is seen.
const STEP: u32 = 8;
/// Longest side of masks and pictures on the page, pixels.
pub const LONGEST_SIDE_PX: u32 = 320;

/// In the place of a mask without a pixel.
pub(crate) const NOTHING: i64 = -1;
pub(crate) const MISSING: i64 = -2;

/// Frames of a clip that the page shows, ascending: the annotated ones nearest to every [`STEP`]th, the last included.
pub(crate) fn shown_frames(scene: &BoardScene) -> Vec<u32> {
    let is_asked = |frame: &u32| !scene.unannotated.contains(frame);
    let asked: Vec<u32> = scene.clip.iter().copied().filter(is_asked).collect();
    let (Some(&first), Some(&last)) = (asked.first(), asked.last()) else { return Vec::new() };
    let wanted = (first..=last).step_by(STEP as usize).chain([last]);
    let mut shown: Vec<u32> =
        wanted.filter_map(|frame| asked.iter().copied().min_by_key(|other| other.abs_diff(frame))).collect();
    shown.dedup();
    shown
}

/// Size of masks on the page: that of the truth, or smaller by the same factor on both sides.
pub(crate) fn shown_size((width, height): (u32, u32)) -> (u32, u32) {
    let longest = width.max(height).max(1);
    if longest <= LONGEST_SIDE_PX {
        return (width, height);
    }
    let scaled = |side: u32| ((side * LONGEST_SIDE_PX + longest / 2) / longest).max(1);
    (scaled(width), scaled(height))
}

/// Distinct masks of one size.
#[derive(Debug)]
pub(crate) struct Pool {
    size: (u32, u32),
    places: HashMap<String, i64>,
}

impl Pool {
    /// Empty, for masks of this size.
    pub(crate) fn new(size: (u32, u32)) -> Self {
        Self { size, places: HashMap::new() }
    }

    /// The place of a mask, or [`NOTHING`] if it has no pixel.
    pub(crate) fn place(&mut self, mask: &Mask) -> i64 {
        let (width, height) = self.size;
        let text = match mask.size() == self.size {
            true => mask.to_rle().counts(),
            false => mask.resized_nearest(width, height).to_rle().counts(),
        };
        if mask.is_empty() {
            return NOTHING;
        }
        let next = self.places.len() as i64;
        *self.places.entry(text).or_insert(next)
    }

    /// The masks in the order of their places.
    pub(crate) fn into_texts(self) -> Vec<String> {
        let mut texts: Vec<(i64, String)> =
            self.places.into_iter().map(|(text, place)| (place, text)).collect();
        texts.sort_unstable();
        texts.into_iter().map(|(_, text)| text).collect()
    }
}

/// What a query asks to find, at each shown frame.
pub(crate) fn target_places(
    pool: &mut Pool,
    truth: &SceneTruth,
    query: &Query,
    referents: &[usize],
    shown: &[u32],
) -> Vec<i64> {
    let place = |&frame: &u32| {
        let target = truth.target(query, referents, truth.position(frame)?)?;
        Some(pool.place(target.mask()))
    };
    shown.iter().map(place).map(|place| place.unwrap_or(NOTHING)).collect()
}

/// The answers of a method to a query at the shown frames; none if they are not there, or not those that were counted.
/// What is wrong with them is reported.
pub(crate) fn answer_places(
    pool: &mut Pool,
    reader: &SceneReader<'_>,
    query: &Query,
    (scene, shown): (&BoardScene, &[u32]),
    counted: &Counted,
    wrong: &mut Report,
) -> Option<Vec<i64>> {
    if !reader.has(&query.id) {
        return None;
    }
    let size = (scene.width, scene.height);
    let answers = reader.read(query, wrong);
    let is_counted = |(&frame, answer): (&u32, &Answer)| {
        let area = answer.mask(size).map_or(0, |mask| mask.area());
        let position = scene.clip.binary_search(&frame).ok();
        position.and_then(|position| counted.predicted.get(position)) == Some(&area)
    };
    if !shown.iter().zip(&answers).all(is_counted) {
        return None;
    }
    let place = |answer: &Answer| match answer.mask(size) {
        Some(mask) => pool.place(&mask),
        None if *answer == Answer::Missing => MISSING,
        None => NOTHING,
    };
    Some(answers.iter().map(place).collect())
}
