//! An answer as pictures: its outline over what the model shows, and the scene with the answer highlighted, alone,
//! and taken away.
//!
//! Owns what people look at. Refuses to know how an answer came about.

use std::collections::BTreeMap;

use glam::UVec2;
use l4d_data::StageError;
use l4d_frames::closeup::Closeup;
use l4d_frames::drawn::{Rgb, RgbImage, picture_of};
use l4d_frames::moving_picture::Pages;
use l4d_frames::overlay::{Mark, enlarge};
use l4d_frames::text::{Style, Weight};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;
use l4d_splat::model::ModelError;
use l4d_splat::raster::Rasterizer;
use l4d_splat::splats::{SplatError, Splats};
use l4d_splat::view::View;

use crate::clips::{Plan, Shot};
use crate::lift::edit::{extract, highlight, remove};
use crate::lift::{Answer, LiftError};
use crate::scene::SolveScene;

const PAPER: Rgb<u8> = Rgb([24, 24, 26]);
/// One of Okabe and Ito's colours, which every kind of colour vision tells from most things in a picture.
const BLUE: Rgb<u8> = Rgb([86, 180, 233]);
/// The same as display colour, 0 to 1.
const HIGHLIGHT: [f32; 3] = [86.0 / 255.0, 180.0 / 255.0, 233.0 / 255.0];
const HIGHLIGHT_SHARE: f32 = 0.65;
const OUTLINE_PX: u32 = 2;
const TEXT: Style = Style { weight: Weight::Regular, size_px: 15.0, colour: Rgb([240; 3]) };
const TITLE: Style = Style { weight: Weight::Semibold, size_px: 18.0, colour: Rgb([255; 3]) };
/// Moments on the sheet.
const COLUMNS: usize = 5;
const ROWS: [&str; 4] = ["outlined", "highlighted", "alone", "taken away"];
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
    pub(crate) answer: Option<&'a Answer>,
    pub(crate) plan: &'a Plan,
    /// The answer in each picture of the plan.
    pub(crate) masks: &'a BTreeMap<Shot, Mask>,
}

impl Shown<'_> {
    /// A page of some moments: those in which the answer is seen, if there are any.
    pub(crate) fn sheet(&self, title: &str) -> Result<RgbImage, StageError> {
        let Self { plan, masks, .. } = self;
        let all: Vec<Shot> = (0..plan.instants.len()).map(|instant| Shot { view: 0, instant }).collect();
        let seen = |shot: &&Shot| masks.get(*shot).is_some_and(|mask| !mask.is_empty());
        let seen: Vec<Shot> = all.iter().filter(seen).copied().collect();
        let from = if seen.is_empty() { &all } else { &seen };
        let moment = |place: usize| {
            let (camera, instant) = plan.of(from[place]);
            let caption = match instant.frame {
                Some(frame) => format!("{}, frame {frame}", camera.name),
                None => format!("{}, time {}", camera.name, instant.time),
            };
            Ok((caption, self.pictures(from[place])?))
        };
        let count = COLUMNS.min(from.len());
        let places = (0..count).map(|column| column * (from.len() - 1) / (count - 1).max(1));
        let moments = places.map(moment).collect::<Result<Vec<_>, StageError>>()?;
        Ok(page(title, &moments))
    }

    /// One moment, a picture for each of the rows of the sheet.
    fn pictures(&self, shot: Shot) -> Result<[RgbImage; 4], StageError> {
        let time = self.plan.instants[shot.instant].time;
        let view = self.plan.view(shot)?;
        let model = &self.scene.source.model;
        let splats = self.splats(time)?;
        let layer = self.answer.map(|answer| answer.layer_at(model, time)).transpose()?;
        let members = layer.map_or_else(|| vec![false; splats.len()], |layer| layer.members);
        let factor = TILE_PX.div_ceil(view.width().max(1));
        let edited = |result: Result<Splats, SplatError>| -> Result<RgbImage, LiftError> {
            let splats =
                result.map_err(|source| LiftError::Model { time, source: ModelError::Splat(source) })?;
            Ok(enlarge(&self.picture(&splats, &view)?, factor))
        };
        Ok([
            self.outlined(shot, &splats, factor)?,
            edited(highlight(&splats, &members, HIGHLIGHT, HIGHLIGHT_SHARE))?,
            edited(extract(&splats, &members))?,
            edited(remove(&splats, &members))?,
        ])
    }

    fn splats(&self, time: f32) -> Result<Splats, LiftError> {
        self.scene.source.model.at(time).map_err(|source| LiftError::Model { time, source })
    }

    fn picture(&self, splats: &Splats, view: &View) -> Result<RgbImage, LiftError> {
        let drawing = self.rasterizer.prepare(splats, view, &self.scene.raster)?.draw()?;
        Ok(picture_of(drawing.width, drawing.height, &drawing.colour))
    }

    /// What the camera sees, `factor` times as large, with the answer outlined.
    fn outlined(&self, shot: Shot, splats: &Splats, factor: u32) -> Result<RgbImage, StageError> {
        let picture = self.picture(splats, &self.plan.view(shot)?)?;
        let (width, height) = picture.dimensions();
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let mask = self.masks.get(&shot);
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
        let splats = self.shown.splats(self.shown.plan.instants[instant].time)?;
        self.shown.outlined(Shot { view: 0, instant }, &splats, self.factor)
    }
}

/// A page: a column a moment; below each other what the camera sees with the answer outlined, then the scene with the
/// answer highlighted, alone, and taken away.
fn page(title: &str, moments: &[(String, [RgbImage; 4])]) -> RgbImage {
    let Some((_, [first, ..])) = moments.first() else { return RgbImage::new(1, 1) };
    let (width, height) = first.dimensions();
    let page_width = GAP_PX + moments.len() as u32 * (width + GAP_PX);
    let mut lines = TITLE.wrap(title, (page_width - 2 * GAP_PX) as f32);
    lines.truncate(MOST_TITLE_LINES);
    let top = GAP_PX + lines.len() as u32 * TITLE_PX;
    let page_height = top + ROWS.len() as u32 * (height + CAPTION_PX + GAP_PX);
    let mut page = RgbImage::from_pixel(page_width, page_height, PAPER);
    for (number, line) in lines.iter().enumerate() {
        TITLE.write(&mut page, GAP_PX as f32, (GAP_PX + number as u32 * TITLE_PX) as f32, line);
    }
    for (column, (caption, pictures)) in moments.iter().enumerate() {
        let left = GAP_PX + column as u32 * (width + GAP_PX);
        for (row, (picture, what)) in pictures.iter().zip(ROWS).enumerate() {
            let y = top + row as u32 * (height + CAPTION_PX + GAP_PX);
            for (x, pixel_row, pixel) in picture.enumerate_pixels() {
                page.put_pixel(left + x, y + pixel_row, *pixel);
            }
            let text = format!("{caption}, {what}");
            TEXT.write(&mut page, left as f32 + 2.0, (y + height) as f32 + 1.0, &text);
        }
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_any_length_and_script_leave_room_for_the_pictures() {
        let pictures: [RgbImage; 4] = std::array::from_fn(|_| RgbImage::new(256, 192));
        let height = |title: &str| page(title, &[("cam00".to_owned(), pictures.clone())]).height();
        let most = height("") + MOST_TITLE_LINES as u32 * TITLE_PX;
        for title in ["ball ".repeat(10_000), "\u{7403} \u{1f3be} \u{202e}\u{1b}[2J".to_owned()] {
            assert!(height(&title) <= most, "{title:.20}");
        }
    }
}
