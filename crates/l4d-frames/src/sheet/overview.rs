//! Many scenes on one page: what the held-out camera sees of each at a few moments, under the names of the scales.

use glam::UVec2;
use image::RgbImage;
use image::imageops::replace;
use l4d_data::Scale;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use rayon::prelude::*;

use super::{GAP_PX, INK, MARGIN_PX, PAPER, SOFT_INK, text};
use crate::display::Display;
use crate::exr::{FrameError, read_frame};
use crate::overlay::enlarge;
use crate::text::Weight;

/// Pictures are enlarged by a whole factor until they are about this wide, pixels.
const CELL_WIDTH_PX: u32 = 256;
const SCENES_A_ROW: usize = 2;
const SCENE_GAP_PX: u32 = 28;
const SCALE_HEADER_PX: u32 = 56;
const SCENE_HEADER_PX: u32 = 30;

/// A rendered scene and where its frames are.
pub type Rendered = (Scene, SceneDir);

/// Draws a strip of pictures per scene; all scenes have to be of one profile. Moments are canonical frames.
///
/// # Errors
/// A picture that cannot be read.
pub fn overview(scenes: &[Rendered], moments: &[u32]) -> Result<RgbImage, FrameError> {
    let Some((first, _)) = scenes.first() else { return Ok(RgbImage::from_pixel(1, 1, PAPER)) };
    let page = Page::new(UVec2::new(first.width, first.height), moments.len() as u32);
    let strips: Vec<Vec<RgbImage>> =
        scenes.par_iter().map(|rendered| page.strip(rendered, moments)).collect::<Result<_, _>>()?;
    let groups: Vec<(Scale, Vec<usize>)> = Scale::ALL
        .into_iter()
        .map(|scale| (scale, (0..scenes.len()).filter(|&index| scenes[index].0.scale == scale).collect()))
        .filter(|(_, members): &(Scale, Vec<usize>)| !members.is_empty())
        .collect();
    let mut sheet = RgbImage::from_pixel(page.width_px(), page.height_px(&groups), PAPER);
    let mut top = MARGIN_PX;
    for (scale, members) in &groups {
        write_scale(&mut sheet, *scale, members.len(), top);
        top += SCALE_HEADER_PX;
        for pair in members.chunks(SCENES_A_ROW) {
            for (column, &index) in pair.iter().enumerate() {
                let left = MARGIN_PX + column as u32 * (page.strip_px() + SCENE_GAP_PX);
                text(Weight::Semibold, 20.0, INK).write(
                    &mut sheet,
                    left as f32,
                    top as f32,
                    &scenes[index].0.name,
                );
                for (moment, picture) in strips[index].iter().enumerate() {
                    let x = left + moment as u32 * (page.cell.x + GAP_PX);
                    replace(&mut sheet, picture, i64::from(x), i64::from(top + SCENE_HEADER_PX));
                }
            }
            top += page.row_px();
        }
    }
    Ok(sheet)
}

/// Sizes on the page, pixels.
struct Page {
    factor: u32,
    cell: UVec2,
    moments: u32,
}

impl Page {
    fn new(picture: UVec2, moments: u32) -> Self {
        let factor = CELL_WIDTH_PX.div_ceil(picture.x.max(1)).max(1);
        Self { factor, cell: picture * factor, moments }
    }

    fn strip_px(&self) -> u32 {
        (self.moments * (self.cell.x + GAP_PX)).saturating_sub(GAP_PX)
    }

    fn row_px(&self) -> u32 {
        SCENE_HEADER_PX + self.cell.y + SCENE_GAP_PX
    }

    fn width_px(&self) -> u32 {
        2 * MARGIN_PX + SCENES_A_ROW as u32 * (self.strip_px() + SCENE_GAP_PX) - SCENE_GAP_PX
    }

    fn height_px(&self, groups: &[(Scale, Vec<usize>)]) -> u32 {
        let rows: usize = groups.iter().map(|(_, members)| members.len().div_ceil(SCENES_A_ROW)).sum();
        2 * MARGIN_PX + groups.len() as u32 * SCALE_HEADER_PX + rows as u32 * self.row_px()
    }

    fn strip(&self, (scene, dir): &Rendered, moments: &[u32]) -> Result<Vec<RgbImage>, FrameError> {
        let display = Display::new(scene.exposure);
        let view = scene.test_camera().or(scene.cameras.first());
        let Some(view) = view else { return Ok(Vec::new()) };
        let size = UVec2::new(scene.width, scene.height);
        let draw = |&frame: &u32| {
            let frame = read_frame(&dir.frame(&view.name, frame), size)?;
            Ok(enlarge(&display.picture(&frame), self.factor))
        };
        moments.iter().map(draw).collect()
    }
}

fn write_scale(sheet: &mut RgbImage, scale: Scale, count: usize, top: u32) {
    let (x, y) = (MARGIN_PX as f32, top as f32);
    let end = text(Weight::Semibold, 34.0, INK).write(sheet, x, y, scale.as_str());
    let scenes = if count == 1 { "scene" } else { "scenes" };
    text(Weight::Regular, 22.0, SOFT_INK).write(sheet, end + 16.0, y + 10.0, &format!("{count} {scenes}"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fake::FakeScene;

    #[test]
    fn a_page_holds_a_strip_per_scene() {
        let fake = FakeScene::write();
        let scenes = vec![(fake.scene.clone(), fake.dir()), (fake.scene.clone(), fake.dir())];
        let page = overview(&scenes[..1], &[0, 48, 96]).unwrap();
        let wider = overview(&scenes, &[0, 48, 96]).unwrap();
        // 128x96 twice as large: three pictures and two gaps, room for two scenes.
        assert_eq!(page.width(), 2 * 28 + 2 * (3 * 256 + 2 * 8) + 28);
        assert_eq!(page.height(), 2 * 28 + 56 + 30 + 192 + 28);
        assert_eq!(wider.dimensions(), page.dimensions());
        let inked = |sheet: &RgbImage, left: u32| {
            (left..left + 700).any(|x| (120..300).any(|y| *sheet.get_pixel(x, y) != PAPER))
        };
        assert!(inked(&page, 30) && !inked(&page, 850) && inked(&wider, 850));
    }
}
