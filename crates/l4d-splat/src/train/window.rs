//! Parts of pictures: where something changes is where a dynamic scene has to be learned.

use crate::raster::TILE;
use crate::view::{View, ViewError};

use super::footage::Footage;
use super::motion::Motion;

/// Pixels left around what changes.
const MARGIN_PX: usize = 6;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Window {
    /// A whole picture.
    pub(super) fn whole([width, height]: [u32; 2]) -> Self {
        Self { left: 0, top: 0, width: width as usize, height: height as usize }
    }

    /// What changes in a picture, with a margin, in whole tiles; none if nothing does.
    pub(super) fn of_change(footage: &Footage, motion: &Motion, shot: usize, moment: usize) -> Option<Self> {
        let [width, height] = footage.size().map(|side| side as usize);
        let (mut first, mut last) = ([usize::MAX; 2], [0; 2]);
        for pixel in 0..footage.pixel_count() {
            if motion.changes(footage, shot, moment, pixel) {
                let at = [pixel % width, pixel / width];
                for axis in 0..2 {
                    first[axis] = first[axis].min(at[axis]);
                    last[axis] = last[axis].max(at[axis]);
                }
            }
        }
        if first[0] == usize::MAX {
            return None;
        }
        let from = first.map(|side| side.saturating_sub(MARGIN_PX) / TILE * TILE);
        let to =
            [0, 1].map(|axis| (last[axis] + 1 + MARGIN_PX).next_multiple_of(TILE).min([width, height][axis]));
        Some(Self { left: from[0], top: from[1], width: to[0] - from[0], height: to[1] - from[1] })
    }

    /// The part of a view.
    pub(super) fn of(&self, view: &View) -> Result<View, ViewError> {
        let [x, y] = view.principal();
        View::new(
            [self.width as u32, self.height as u32],
            view.focal(),
            [x - self.left as f64, y - self.top as f64],
            view.camera_from_world(),
        )
    }

    /// Row-major indices of its pixels in a picture that is `width` wide.
    pub(super) fn pixels(self, width: usize) -> impl Iterator<Item = usize> {
        (self.top..self.top + self.height)
            .flat_map(move |row| (self.left..self.left + self.width).map(move |column| row * width + column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_view_sees_the_same_at_other_pixels() {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = View::new([64, 48], [50.0, 50.0], [32.0, 24.0], pose).unwrap();
        let window = Window { left: 16, top: 32, width: 32, height: 16 };
        let part = window.of(&view).unwrap();
        assert_eq!((part.width(), part.height(), part.principal()), (32, 16, [16.0, -8.0]));
        let pixels: Vec<usize> = window.pixels(64).collect();
        assert_eq!((pixels.len(), pixels[0], pixels[32]), (32 * 16, 32 * 64 + 16, 33 * 64 + 16));
    }
}
