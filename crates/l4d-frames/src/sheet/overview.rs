//! Many scenes on one page: what the held-out camera sees of each at a few moments, under the names of the scales.

use glam::UVec2;
use image::RgbImage;
use image::imageops::replace;
use l4d_data::Scale;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use rayon::prelude::*;

use super::{GAP_PX, INK, MARGIN_PX, PAPER, SOFT_INK, ScenePicture, factor, text};
use crate::exr::FrameError;
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
    let cell = UVec2::new(first.width, first.height) * factor(first, CELL_WIDTH_PX);
    let strip_px = (moments.len() as u32 * (cell.x + GAP_PX)).saturating_sub(GAP_PX);
    let row_px = SCENE_HEADER_PX + cell.y + SCENE_GAP_PX;
    let strips: Vec<Vec<RgbImage>> =
        scenes.par_iter().map(|rendered| strip(rendered, moments)).collect::<Result<_, _>>()?;
    let members =
        |scale: Scale| scenes.iter().zip(&strips).filter(move |((scene, _), _)| scene.scale == scale);
    let groups =
        || Scale::ALL.into_iter().map(|scale| (scale, members(scale).count())).filter(|group| group.1 > 0);
    let rows: usize = groups().map(|(_, count)| count.div_ceil(SCENES_A_ROW)).sum();
    let width = 2 * MARGIN_PX + SCENES_A_ROW as u32 * (strip_px + SCENE_GAP_PX) - SCENE_GAP_PX;
    let height = 2 * MARGIN_PX + groups().count() as u32 * SCALE_HEADER_PX + rows as u32 * row_px;
    let mut sheet = RgbImage::from_pixel(width, height, PAPER);
    let mut top = MARGIN_PX;
    for (scale, count) in groups() {
        write_scale(&mut sheet, scale, count, top);
        top += SCALE_HEADER_PX;
        for (place, ((scene, _), strip)) in members(scale).enumerate() {
            let left = MARGIN_PX + (place % SCENES_A_ROW) as u32 * (strip_px + SCENE_GAP_PX);
            let row = top + (place / SCENES_A_ROW) as u32 * row_px;
            text(Weight::Semibold, 20.0, INK).write(&mut sheet, left as f32, row as f32, &scene.name);
            for (x, picture) in (left..).step_by((cell.x + GAP_PX) as usize).zip(strip) {
                replace(&mut sheet, picture, i64::from(x), i64::from(row + SCENE_HEADER_PX));
            }
        }
        top += count.div_ceil(SCENES_A_ROW) as u32 * row_px;
    }
    Ok(sheet)
}

fn strip((scene, dir): &Rendered, moments: &[u32]) -> Result<Vec<RgbImage>, FrameError> {
    let Some(view) = scene.test_camera().or(scene.cameras.first()) else { return Ok(Vec::new()) };
    let picture = |&frame: &u32| ScenePicture { scene, dir, view: &view.name, frame };
    moments.iter().map(|frame| picture(frame).draw(factor(scene, CELL_WIDTH_PX), &[])).collect()
}

fn write_scale(sheet: &mut RgbImage, scale: Scale, count: usize, top: u32) {
    let (x, y) = (MARGIN_PX as f32, top as f32);
    let end = text(Weight::Semibold, 34.0, INK).write(sheet, x, y, scale.as_str());
    let scenes = if count == 1 { "scene" } else { "scenes" };
    text(Weight::Regular, 22.0, SOFT_INK).write(sheet, end + 16.0, y + 10.0, &format!("{count} {scenes}"));
}

#[cfg(test)]
mod tests {
    use l4d_testing::Dataset;

    use super::*;

    #[test]
    fn a_page_holds_a_strip_per_scene() {
        let fake = Dataset::new();
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
