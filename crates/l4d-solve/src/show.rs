//! An answer as pictures: its outline over what the model shows.
//!
//! Owns what people look at. Refuses to know how an answer came about.

use std::collections::BTreeMap;

use glam::UVec2;
use l4d_data::StageError;
use l4d_frames::closeup::Closeup;
use l4d_frames::drawn::{Rgb, RgbImage, picture_of};
use l4d_frames::moving_picture::Pages;
use l4d_frames::overlay::Mark;
use l4d_frames::text::{Style, Weight};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;
use l4d_splat::raster::Rasterizer;

use crate::clips::{PictureIndex, Plan};
use crate::lift::LiftError;
use crate::scene::SolveScene;

const PAPER: Rgb<u8> = Rgb([24, 24, 26]);
/// One of Okabe and Ito's colours, which every kind of colour vision tells from most things in a picture.
const BLUE: Rgb<u8> = Rgb([86, 180, 233]);
const OUTLINE_PX: u32 = 2;
const TEXT: Style = Style { weight: Weight::Regular, size_px: 15.0, colour: Rgb([240; 3]) };
const TITLE: Style = Style { weight: Weight::Semibold, size_px: 18.0, colour: Rgb([255; 3]) };
/// Moments on the sheet.
const COLUMNS: usize = 5;
/// Narrower pictures are enlarged, so that captions fit below them.
const TILE_PX: u32 = 256;
const GAP_PX: u32 = 6;
const CAPTION_PX: u32 = 20;
const TITLE_PX: u32 = 28;
/// A sentence may be as long as somebody likes.
const MOST_TITLE_LINES: usize = 4;

/// What is shown: an answer in a scene, from the first camera of a plan.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub(crate) rasterizer: &'a dyn Rasterizer,
    pub(crate) scene: &'a SolveScene,
    pub(crate) plan: &'a Plan,
    /// The answer in each picture of the plan.
    pub(crate) masks: &'a BTreeMap<PictureIndex, Mask>,
}

impl Shown<'_> {
    /// A page of some moments: those in which the answer is seen, if there are any.
    pub(crate) fn sheet(&self, title: &str) -> Result<RgbImage, StageError> {
        let Self { plan, masks, .. } = self;
        let all: Vec<PictureIndex> =
            (0..plan.instants.len()).map(|instant| PictureIndex { view: 0, instant }).collect();
        let seen = |index: &&PictureIndex| masks.get(*index).is_some_and(|mask| !mask.is_empty());
        let seen: Vec<PictureIndex> = all.iter().filter(seen).copied().collect();
        let from = if seen.is_empty() { &all } else { &seen };
        let moment = |place: usize| {
            let (camera, instant) = plan.of(from[place]);
            let caption = match instant.frame {
                Some(frame) => format!("{}, frame {frame}", camera.name),
                None => format!("{}, time {}", camera.name, instant.time),
            };
            Ok((caption, self.outlined(from[place], TILE_PX.div_ceil(plan.size[0].max(1)))?))
        };
        let count = COLUMNS.min(from.len());
        let places = (0..count).map(|column| column * (from.len() - 1) / (count - 1).max(1));
        let moments = places.map(moment).collect::<Result<Vec<_>, StageError>>()?;
        Ok(page(title, &moments))
    }

    /// What the camera sees, `factor` times as large, with the answer outlined.
    fn outlined(&self, index: PictureIndex, factor: u32) -> Result<RgbImage, StageError> {
        let (view, time) = (self.plan.view(index)?, self.plan.instants[index.instant].time);
        let splats = self.scene.source.model.at(time).map_err(|source| LiftError::Model { time, source })?;
        let projected = self.rasterizer.prepare(&splats, &view, &self.scene.raster);
        let drawing = projected.and_then(|projected| projected.draw()).map_err(LiftError::from)?;
        let (width, height) = (drawing.width, drawing.height);
        let picture = picture_of(width, height, &drawing.colour);
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let mask = self.masks.get(&index);
        let is_marked = |(column, row)| mask.is_some_and(|mask| mask.get(column, row));
        let ids: Vec<u32> = pixels.map(|pixel| u32::from(is_marked(pixel))).collect();
        let whole = PixelBox { first_col: 0, first_row: 0, last_col: width - 1, last_row: height - 1 };
        let mut closeup = Closeup::cut(&picture, &ids, whole, UVec2::new(width, height) * factor);
        closeup.outline(&[Mark { id: 1, number: 1, colour: BLUE, faint: false }], |_| OUTLINE_PX);
        Ok(closeup.into_picture())
    }

    /// The whole clip, at most about `widest_px` wide and enlarged by a whole number.
    pub(crate) fn pages(self, widest_px: u32) -> impl Pages {
        OverClip { shown: self, factor: (widest_px / self.plan.size[0].max(1)).clamp(1, 4) }
    }
}

struct OverClip<'a> {
    shown: Shown<'a>,
    factor: u32,
}

impl Pages for OverClip<'_> {
    fn size_px(&self) -> (u32, u32) {
        self.shown.plan.size.map(|side| side * self.factor).into()
    }

    fn page(&self, instant: usize) -> Result<RgbImage, StageError> {
        self.shown.outlined(PictureIndex { view: 0, instant }, self.factor)
    }
}

/// A page: pictures side by side, each with its caption.
fn page(title: &str, moments: &[(String, RgbImage)]) -> RgbImage {
    let Some((_, first)) = moments.first() else { return RgbImage::new(1, 1) };
    let (width, height) = first.dimensions();
    let page_width = GAP_PX + moments.len() as u32 * (width + GAP_PX);
    let mut lines = TITLE.wrap(title, (page_width - 2 * GAP_PX) as f32);
    lines.truncate(MOST_TITLE_LINES);
    let top = GAP_PX + lines.len() as u32 * TITLE_PX;
    let mut page = RgbImage::from_pixel(page_width, top + height + CAPTION_PX + GAP_PX, PAPER);
    for (number, line) in lines.iter().enumerate() {
        TITLE.write(&mut page, GAP_PX as f32, (GAP_PX + number as u32 * TITLE_PX) as f32, line);
    }
    for (place, (caption, picture)) in moments.iter().enumerate() {
        let left = GAP_PX + place as u32 * (width + GAP_PX);
        for (column, row, pixel) in picture.enumerate_pixels() {
            page.put_pixel(left + column, top + row, *pixel);
        }
        TEXT.write(&mut page, left as f32 + 2.0, (top + height) as f32 + 1.0, caption);
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_any_length_and_script_leave_room_for_the_pictures() {
        let height = |title: &str| page(title, &[("cam00".to_owned(), RgbImage::new(256, 192))]).height();
        let most = height("") + MOST_TITLE_LINES as u32 * TITLE_PX;
        for title in ["ball ".repeat(10_000), "\u{7403} \u{1f3be} \u{202e}\u{1b}[2J".to_owned()] {
            assert!(height(&title) <= most, "{title:.20}");
        }
    }
}
