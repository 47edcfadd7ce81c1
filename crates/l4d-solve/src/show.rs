//! An answer as pictures: its outline over what the model shows, and the scene with the answer highlighted, alone,
//! and taken away.
//!
//! Owns what people look at. Refuses to know how an answer came about.

use glam::UVec2;
use l4d_frames::closeup::Closeup;
use l4d_frames::drawn::{Rgb, RgbImage, picture_of};
use l4d_frames::overlay::{Mark, enlarge};
use l4d_frames::text::{Style, Weight};
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;
use l4d_splat::model::ModelError;
use l4d_splat::splats::Splats;
use l4d_splat::view::View;

use crate::clips::{Plan, Shot};
use crate::lift::{LiftError, Lifted, edit};
use crate::scene::SolveScene;
use crate::solve::{Method, SolveError};

/// One of Okabe and Ito's colours, which every kind of colour vision tells from most things in a picture.
const INK: Rgb<u8> = Rgb([86, 180, 233]);
/// The same as display colour, 0 to 1.
const HIGHLIGHT: [f32; 3] = [86.0 / 255.0, 180.0 / 255.0, 233.0 / 255.0];
const HIGHLIGHT_SHARE: f32 = 0.65;
const OUTLINE_PX: u32 = 2;
const PAPER: Rgb<u8> = Rgb([24, 24, 26]);
const TEXT: Style = Style { weight: Weight::Regular, size_px: 15.0, colour: Rgb([240; 3]) };
const TITLE: Style = Style { weight: Weight::Semibold, size_px: 18.0, colour: Rgb([255; 3]) };
/// Narrower pictures are enlarged, so that captions fit below them.
const TILE_PX: u32 = 256;
const GAP_PX: u32 = 6;
const CAPTION_PX: u32 = 20;
const TITLE_PX: u32 = 28;
/// A sentence may be as long as somebody likes.
const MOST_TITLE_LINES: usize = 4;

/// One moment of one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// What the model shows.
    pub scene: RgbImage,
    /// The pixels of the answer.
    pub mask: Mask,
    /// The scene with the answer in another colour.
    pub highlighted: RgbImage,
    /// The answer alone.
    pub extracted: RgbImage,
    /// The scene without the answer.
    pub removed: RgbImage,
}

impl Method<'_> {
    /// One moment of one camera, drawn from the scene and from its edited versions.
    ///
    /// # Errors
    /// A picture that cannot be drawn.
    pub fn show(
        &self,
        scene: &SolveScene,
        lifted: Option<&Lifted>,
        plan: &Plan,
        shot: Shot,
    ) -> Result<Shown, SolveError> {
        let time = plan.instants[shot.instant].time;
        let view = plan.view(shot)?;
        let model = &scene.source.model;
        let splats = model.at(time).map_err(|source| LiftError::Model { time, source })?;
        let layer = lifted.map(|lifted| lifted.layer_at(model, time)).transpose()?;
        let none = vec![false; splats.len()];
        let members = layer.as_ref().map_or(none.as_slice(), |layer| layer.members.as_slice());
        let edited = |result: Result<Splats, _>| {
            result.map_err(|source| LiftError::Model { time, source: ModelError::Splat(source) })
        };
        let prepared = self.rasterizer.prepare(&splats, &view, &scene.raster).map_err(LiftError::from)?;
        let mask = match &layer {
            Some(layer) => layer.mask(prepared.as_ref(), &view)?,
            None => Mask::empty(view.width(), view.height()),
        };
        Ok(Shown {
            scene: self.picture(scene, &splats, &view)?,
            mask,
            highlighted: self.picture(
                scene,
                &edited(edit::highlight(&splats, members, HIGHLIGHT, HIGHLIGHT_SHARE))?,
                &view,
            )?,
            extracted: self.picture(scene, &edited(edit::extract(&splats, members))?, &view)?,
            removed: self.picture(scene, &edited(edit::remove(&splats, members))?, &view)?,
        })
    }

    fn picture(&self, scene: &SolveScene, splats: &Splats, view: &View) -> Result<RgbImage, LiftError> {
        let drawing = self.rasterizer.prepare(splats, view, &scene.raster)?.draw()?;
        Ok(picture_of(drawing.width, drawing.height, &drawing.colour))
    }
}

/// A picture, `factor` times as large, with the answer outlined.
pub fn outlined(picture: &RgbImage, mask: &Mask, factor: u32) -> RgbImage {
    let (width, height) = picture.dimensions();
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let ids: Vec<u32> = pixels.map(|(column, row)| u32::from(mask.get(column, row))).collect();
    let whole = PixelBox {
        first_col: 0,
        first_row: 0,
        last_col: width.saturating_sub(1),
        last_row: height.saturating_sub(1),
    };
    let mut closeup = Closeup::cut(picture, &ids, whole, UVec2::new(width, height) * factor.max(1));
    closeup.outline(&[Mark { id: 1, number: 1, colour: INK, faint: false }], |_| OUTLINE_PX);
    closeup.into_picture()
}

/// A page: a column a moment; below each other what the camera sees with the answer outlined, then the scene with the
/// answer highlighted, alone, and taken away.
pub fn sheet(title: &str, moments: &[(String, Shown)]) -> RgbImage {
    let Some((_, first)) = moments.first() else { return RgbImage::new(1, 1) };
    let factor = TILE_PX.div_ceil(first.scene.width().max(1));
    let [width, height] = [first.scene.width(), first.scene.height()].map(|side| side * factor);
    let rows = ["outlined", "highlighted", "alone", "taken away"];
    let page_width = GAP_PX + moments.len() as u32 * (width + GAP_PX);
    let mut lines = TITLE.wrap(title, (page_width - 2 * GAP_PX) as f32);
    lines.truncate(MOST_TITLE_LINES);
    let top = GAP_PX + lines.len() as u32 * TITLE_PX;
    let page_height = top + rows.len() as u32 * (height + CAPTION_PX + GAP_PX);
    let mut page = RgbImage::from_pixel(page_width, page_height, PAPER);
    for (number, line) in lines.iter().enumerate() {
        TITLE.write(&mut page, GAP_PX as f32, (GAP_PX + number as u32 * TITLE_PX) as f32, line);
    }
    for (column, (caption, shown)) in moments.iter().enumerate() {
        let left = GAP_PX + column as u32 * (width + GAP_PX);
        let edited = [&shown.highlighted, &shown.extracted, &shown.removed];
        let enlarged = edited.map(|picture| enlarge(picture, factor));
        let pictures = std::iter::once(outlined(&shown.scene, &shown.mask, factor)).chain(enlarged);
        for (row, (picture, what)) in pictures.zip(rows).enumerate() {
            let y = top + row as u32 * (height + CAPTION_PX + GAP_PX);
            put(&mut page, &picture, left, y);
            let text = format!("{caption}, {what}");
            TEXT.write(&mut page, left as f32 + 2.0, (y + height) as f32 + 1.0, &text);
        }
    }
    page
}

fn put(page: &mut RgbImage, picture: &RgbImage, left: u32, top: u32) {
    for (column, row, pixel) in picture.enumerate_pixels() {
        if left + column < page.width() && top + row < page.height() {
            page.put_pixel(left + column, top + row, *pixel);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_any_length_and_script_leave_room_for_the_pictures() {
        let picture = RgbImage::new(64, 48);
        let shown = Shown {
            scene: picture.clone(),
            mask: Mask::empty(64, 48),
            highlighted: picture.clone(),
            extracted: picture.clone(),
            removed: picture,
        };
        let height = |title: &str| sheet(title, &[("cam00".to_owned(), shown.clone())]).height();
        let most = height("") + MOST_TITLE_LINES as u32 * TITLE_PX;
        for title in ["ball ".repeat(10_000), "\u{7403} \u{1f3be} \u{202e}\u{1b}[2J".to_owned()] {
            assert!(height(&title) <= most, "{title:.20}");
        }
    }
}
