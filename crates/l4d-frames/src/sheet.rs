//! Contact sheets: rows are views (the held-out one first), columns are moments; below them a legend and the
//! queries. A person sees at a glance whether a scene is worth showing and its queries are right.

mod legend;
mod overview;

use std::path::Path;

use glam::UVec2;
use image::imageops::replace;
use image::{Rgb, RgbImage};
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::store::write_atomic;
use l4d_data::timeline::FPS;
use l4d_data::{Camera, DataError, Name, Query, Split};
use rayon::prelude::*;

use crate::display::Display;
use crate::drawn::encode_colour;
use crate::exr::{FrameError, read_frame};
use crate::overlay::{Mark, annotated, marks};
use crate::text::{Style, Weight};

pub use overview::{Rendered, overview};

/// Pictures are enlarged by a whole factor until they are about this wide, pixels.
const CELL_WIDTH_PX: u32 = 400;
const MARGIN_PX: u32 = 28;
const GAP_PX: u32 = 8;
const PLAIN_GAP_PX: u32 = 4;
const TITLE_HEIGHT_PX: u32 = 66;
const COLUMN_HEADER_PX: u32 = 28;
const ROW_HEADER_PX: u32 = 28;
const PAPER: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([28, 28, 30]);
const SOFT_INK: Rgb<u8> = Rgb([105, 105, 110]);

/// What to draw.
#[derive(Debug, Clone, Copy)]
pub struct Sheet<'a> {
    /// The rendered scene.
    pub scene: &'a Scene,
    /// Where its frames are.
    pub dir: &'a SceneDir,
    /// Rows, top to bottom.
    pub views: &'a [&'a Camera],
    /// Columns, left to right: canonical frames that were rendered.
    pub frames: &'a [u32],
    /// Sentences to list.
    pub queries: &'a [Query],
    /// Only the pictures, without outlines, numbers, text and margins.
    pub plain: bool,
}

impl Sheet<'_> {
    /// Reads the frames and draws the sheet.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn draw(&self) -> Result<RgbImage, FrameError> {
        let marks = marks(&self.scene.instances);
        let cells = self.cells(&marks)?;
        if self.plain {
            return Ok(self.plain_grid(&cells));
        }
        let cell = self.cell_size();
        let columns = self.frames.len() as u32;
        let content = columns * cell.x + columns.saturating_sub(1) * GAP_PX;
        let row_height = ROW_HEADER_PX + cell.y + GAP_PX;
        let pictures_bottom =
            MARGIN_PX + TITLE_HEIGHT_PX + COLUMN_HEADER_PX + self.views.len() as u32 * row_height;
        let legend = legend::Legend::new(self.scene, &marks, self.queries, content);
        let height = pictures_bottom + legend.height_px() + MARGIN_PX;
        let mut page = RgbImage::from_pixel(content + 2 * MARGIN_PX, height, PAPER);
        self.write_title(&mut page);
        for (column, frame) in self.frames.iter().enumerate() {
            let x = MARGIN_PX + column as u32 * (cell.x + GAP_PX);
            let seconds = f64::from(*frame) / FPS;
            let end = text(Weight::Semibold, 20.0, INK).write(
                &mut page,
                x as f32,
                (MARGIN_PX + TITLE_HEIGHT_PX) as f32,
                &format!("frame {frame}"),
            );
            text(Weight::Regular, 20.0, SOFT_INK).write(
                &mut page,
                end + 10.0,
                (MARGIN_PX + TITLE_HEIGHT_PX) as f32,
                &format!("{seconds:.2} s"),
            );
        }
        for (row, camera) in self.views.iter().enumerate() {
            let top = MARGIN_PX + TITLE_HEIGHT_PX + COLUMN_HEADER_PX + row as u32 * row_height;
            write_row_header(&mut page, camera, top);
            for column in 0..self.frames.len() {
                let x = MARGIN_PX + column as u32 * (cell.x + GAP_PX);
                let picture = &cells[row * self.frames.len() + column];
                replace(&mut page, picture, i64::from(x), i64::from(top + ROW_HEADER_PX));
            }
        }
        legend.draw(&mut page, MARGIN_PX, pictures_bottom);
        Ok(page)
    }

    fn factor(&self) -> u32 {
        factor(self.scene, CELL_WIDTH_PX)
    }

    fn cell_size(&self) -> UVec2 {
        UVec2::new(self.scene.width, self.scene.height) * self.factor()
    }

    fn cells(&self, marks: &[Mark]) -> Result<Vec<RgbImage>, FrameError> {
        let Self { scene, dir, .. } = *self;
        let pictures = self.views.iter().flat_map(|camera| {
            self.frames.iter().map(|&frame| ScenePicture { scene, dir, view: &camera.name, frame })
        });
        let marks = if self.plain { &[] } else { marks };
        let pictures: Vec<ScenePicture> = pictures.collect();
        pictures.par_iter().map(|picture| picture.draw(self.factor(), marks)).collect()
    }

    fn plain_grid(&self, cells: &[RgbImage]) -> RgbImage {
        let cell = self.cell_size();
        let pitch = cell + PLAIN_GAP_PX;
        let (columns, rows) = (self.frames.len() as u32, self.views.len() as u32);
        let side = |count: u32, pitch: u32| (count * pitch).saturating_sub(PLAIN_GAP_PX).max(1);
        let mut page = RgbImage::from_pixel(side(columns, pitch.x), side(rows, pitch.y), PAPER);
        for (index, picture) in cells.iter().enumerate() {
            let (column, row) = (index as u32 % columns, index as u32 / columns);
            replace(&mut page, picture, i64::from(column * pitch.x), i64::from(row * pitch.y));
        }
        page
    }

    fn write_title(&self, page: &mut RgbImage) {
        let Self { scene, .. } = self;
        let (x, y) = (MARGIN_PX as f32, MARGIN_PX as f32 - 6.0);
        let end = text(Weight::Semibold, 34.0, INK).write(page, x, y, &scene.name);
        let facts = format!(
            "{}, profile {}, {}x{}, {} training views and 1 held out, {} frames",
            scene.scale.as_str(),
            scene.profile,
            scene.width,
            scene.height,
            scene.cameras.len().saturating_sub(1),
            scene.profile.frames().count()
        );
        text(Weight::Regular, 22.0, SOFT_INK).write(page, end + 18.0, y + 10.0, &facts);
    }
}

/// One picture of a rendered scene.
#[derive(Debug, Clone, Copy)]
pub struct ScenePicture<'a> {
    /// The rendered scene.
    pub scene: &'a Scene,
    /// Where its frames are.
    pub dir: &'a SceneDir,
    /// From which camera.
    pub view: &'a Name,
    /// Canonical frame that was rendered.
    pub frame: u32,
}

impl ScenePicture<'_> {
    /// What the camera saw, `factor` times as large, with outlines and numbers of marks.
    fn draw(&self, factor: u32, marks: &[Mark]) -> Result<RgbImage, FrameError> {
        let size = UVec2::new(self.scene.width, self.scene.height);
        let frame = read_frame(&self.dir.frame(self.view, self.frame), size)?;
        let picture = Display::new(self.scene.exposure).picture(&frame);
        Ok(annotated(&picture, &frame.surfaces.id, factor, marks))
    }
}

/// The whole factor that makes pictures of a scene at least so wide.
fn factor(scene: &Scene, width_px: u32) -> u32 {
    width_px.div_ceil(scene.width.max(1)).max(1)
}

/// Writes a drawn page as a PNG file.
///
/// # Errors
/// What the disk refuses.
pub fn save(page: &RgbImage, path: &Path) -> Result<(), DataError> {
    write_atomic(path, &encode_colour(page))
}

fn write_row_header(page: &mut RgbImage, camera: &Camera, top: u32) {
    let (x, y) = (MARGIN_PX as f32, top as f32 + 3.0);
    let end = text(Weight::Semibold, 20.0, INK).write(page, x, y, &camera.name);
    let split = match camera.split {
        Split::Test => "held out",
        Split::Train => "training",
    };
    text(Weight::Regular, 20.0, SOFT_INK).write(page, end + 10.0, y, split);
}

fn text(weight: Weight, size_px: f32, colour: Rgb<u8>) -> Style {
    Style { weight, size_px, colour }
}

/// The held-out view and two training views, a quarter and three quarters along the rig.
pub fn default_views(scene: &Scene) -> Vec<&Camera> {
    let training: Vec<&Camera> = scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect();
    let along = |quarter: usize| training.get(training.len() * quarter / 4).copied();
    let mut views: Vec<&Camera> = scene.test_camera().into_iter().chain(along(1)).chain(along(3)).collect();
    views.dedup_by_key(|camera| camera.name.clone());
    views
}

/// Five rendered frames, evenly spaced over the clip.
pub fn default_frames(scene: &Scene) -> Vec<u32> {
    let frames: Vec<u32> = scene.profile.frames().collect();
    (0..5).map(|index| frames[index * (frames.len() - 1) / 4]).collect()
}

#[cfg(test)]
mod tests {
    use l4d_testing::Dataset;

    use super::*;

    #[test]
    fn a_sheet_has_outlines_and_a_plain_one_only_pictures() {
        let fake = Dataset::new();
        let (dir, views, frames) = (fake.dir(), default_views(&fake.scene), default_frames(&fake.scene));
        assert_eq!(frames, [0, 24, 48, 72, 96]);
        let names: Vec<&str> = views.iter().map(|camera| camera.name.as_str()).collect();
        assert_eq!(names, ["cam02", "cam01", "cam04"]);
        let sheet = Sheet {
            scene: &fake.scene,
            dir: &dir,
            views: &views,
            frames: &frames,
            queries: &[],
            plain: false,
        };
        let page = sheet.draw().unwrap();
        let ball =
            marks(&fake.scene.instances).into_iter().find(|mark| mark.id == Dataset::BALL).unwrap().colour;
        assert!(page.pixels().any(|pixel| *pixel == ball));
        let plain = Sheet { plain: true, ..sheet }.draw().unwrap();
        assert_eq!(plain.dimensions(), (5 * 512 + 4 * 4, 3 * 384 + 2 * 4));
        assert!(plain.pixels().all(|pixel| *pixel != ball));
        assert!(page.width() > plain.width() && page.height() > plain.height());
    }
}
