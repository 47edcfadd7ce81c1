//! Parts of pictures: where something changes is where a dynamic scene has to be learned.

use std::ops::Range;

use crate::raster::TILE;
use crate::view::{View, ViewError};

use super::motion::{Bits, Motion};
use super::views::TrainingViews;

/// Pixels looked at around what changes.
const MARGIN_PX: usize = 3;

/// Pixels of a picture, within a rectangle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChangedRegion {
    pub(super) crop: Crop,
    /// Of the pixels of the crop.
    bits: Bits,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Crop {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Crop {
    pub(super) fn whole([width, height]: [u32; 2]) -> Self {
        Self { left: 0, top: 0, width: width as usize, height: height as usize }
    }

    /// Whole tiles around all marked pixels; none if there are none.
    fn around(marks: &[bool], width: usize) -> Option<Self> {
        let height = marks.len() / width;
        let (mut first, mut last) = ([usize::MAX; 2], [0; 2]);
        for (pixel, _) in marks.iter().enumerate().filter(|(_, marked)| **marked) {
            let at = [pixel % width, pixel / width];
            for axis in 0..2 {
                first[axis] = first[axis].min(at[axis]);
                last[axis] = last[axis].max(at[axis]);
            }
        }
        if first[0] == usize::MAX {
            return None;
        }
        let from = first.map(|side| side / TILE * TILE);
        let to = [0, 1].map(|axis| (last[axis] + 1).next_multiple_of(TILE).min([width, height][axis]));
        Some(Self { left: from[0], top: from[1], width: to[0] - from[0], height: to[1] - from[1] })
    }

    pub(super) fn of(&self, view: &View) -> Result<View, ViewError> {
        let [x, y] = view.principal();
        View::new(
            [self.width as u32, self.height as u32],
            view.focal(),
            [x - self.left as f64, y - self.top as f64],
            view.camera_from_world(),
        )
    }

    /// Row-major indices of the pixels of each of its rows in a picture that is `width` wide.
    pub(super) fn rows(self, width: usize) -> impl Iterator<Item = Range<usize>> {
        (self.top..self.top + self.height)
            .map(move |row| row * width + self.left..row * width + self.left + self.width)
    }
}

impl ChangedRegion {
    /// What changes in a picture, with a margin; none if nothing does.
    pub(super) fn of_changes(
        views: &TrainingViews,
        motion: &Motion,
        camera: usize,
        moment: usize,
    ) -> Option<Self> {
        if !views.cameras()[camera].has_picture(moment) {
            return None;
        }
        let width = views.size()[0] as usize;
        let changes: Vec<bool> =
            (0..views.pixel_count()).map(|pixel| motion.changes(views, camera, moment, pixel)).collect();
        let marks = widened(&changes, width, MARGIN_PX);
        let crop = Crop::around(&marks, width)?;
        let inside: Vec<bool> = crop.rows(width).flatten().map(|pixel| marks[pixel]).collect();
        Some(Self { crop, bits: Bits::of(&inside) })
    }

    /// Which pixels of the crop belong to it, row-major.
    pub(super) fn marks(&self) -> Vec<bool> {
        (0..self.crop.width * self.crop.height).map(|place| self.bits.get(place)).collect()
    }
}

/// Marks everything within a square around what is marked.
fn widened(marks: &[bool], width: usize, margin: usize) -> Vec<bool> {
    let height = marks.len() / width;
    let mut along = vec![false; marks.len()];
    for (pixel, _) in marks.iter().enumerate().filter(|(_, marked)| **marked) {
        let (row, column) = (pixel / width, pixel % width);
        let columns = column.saturating_sub(margin)..(column + margin + 1).min(width);
        along[row * width..][columns].fill(true);
    }
    let mut wide = vec![false; marks.len()];
    for row in 0..height {
        for other in row.saturating_sub(margin)..(row + margin + 1).min(height) {
            let from = &along[other * width..][..width];
            for (to, from) in wide[row * width..][..width].iter_mut().zip(from) {
                *to |= from;
            }
        }
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_view_sees_the_same_at_other_pixels() {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = View::new([64, 48], [50.0, 50.0], [32.0, 24.0], pose).unwrap();
        let crop = Crop { left: 16, top: 32, width: 32, height: 16 };
        let region = crop.of(&view).unwrap();
        assert_eq!((region.width(), region.height(), region.principal()), (32, 16, [16.0, -8.0]));
        let rows: Vec<Range<usize>> = crop.rows(64).collect();
        assert_eq!((rows.len(), &rows[0], &rows[1]), (16, &(2064..2096), &(2128..2160)));
    }

    #[test]
    fn a_margin_stays_in_the_picture_and_the_window_is_made_of_tiles() {
        let mut marks = vec![false; 40 * 20];
        marks[3 * 40 + 39] = true;
        let wide = widened(&marks, 40, 2);
        let expected = |pixel: usize| (1..6).contains(&(pixel / 40)) && pixel % 40 >= 37;
        assert_eq!(wide, (0..40 * 20).map(expected).collect::<Vec<bool>>());
        let crop = Crop::around(&wide, 40).unwrap();
        assert_eq!(crop, Crop { left: 32, top: 0, width: 8, height: 16 });
        assert_eq!(Crop::around(&[false; 40], 40), None);
    }
}
