//! Which pixels of a picture are drawn, by tile.

use super::projection::Splat2d;
use crate::raster::{RasterSettings, TILE};
use crate::view::View;

/// A bit for each pixel of a tile, a number for each row; column 0 is the lowest bit.
pub(super) type TileMask = [u16; TILE];

/// The pixels that are drawn.
#[derive(Debug)]
pub(super) struct PixelMask {
    size: [usize; 2],
    /// Row-major.
    masks: Vec<TileMask>,
    /// Marked pixels above and to the left of each corner of a pixel; empty if all are.
    counts: Vec<u32>,
    /// How far from its centre a Gaussian may show, in units of its radius.
    reach: f64,
}

impl PixelMask {
    /// Every pixel.
    pub(super) fn all(view: &View) -> Self {
        Self::new(view, |_| true)
    }

    /// The pixels that `mask` marks, row-major.
    pub(super) fn marked(view: &View, settings: &RasterSettings, mask: &[bool]) -> Self {
        let marked = Self::new(view, |pixel| mask[pixel]);
        let [width, height] = marked.size;
        let corner = width + 1;
        let mut counts = vec![0; corner * (height + 1)];
        for row in 0..height {
            let mut along = 0;
            for column in 0..width {
                along += u32::from(mask[row * width + column]);
                counts[(row + 1) * corner + column + 1] = counts[row * corner + column + 1] + along;
            }
        }
        // Where even an opaque one falls below the smallest alpha; a radius is so many standard deviations.
        let farthest = (-2.0 * f64::from(settings.alpha_min).ln()).sqrt();
        Self { counts, reach: farthest / f64::from(settings.coverage_sigmas), ..marked }
    }

    fn new(view: &View, is_marked: impl Fn(usize) -> bool) -> Self {
        let size @ [width, height] = [view.width() as usize, view.height() as usize];
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let mut masks = vec![[0; TILE]; columns * rows];
        for row in 0..height {
            for column in 0..width {
                let bit = u16::from(is_marked(row * width + column)) << (column % TILE);
                masks[row / TILE * columns + column / TILE][row % TILE] |= bit;
            }
        }
        Self { size, masks, counts: Vec::new(), reach: 1.0 }
    }

    /// Of one tile.
    pub(super) fn of_tile(&self, tile: usize) -> &TileMask {
        &self.masks[tile]
    }

    /// Whether a tile has a marked pixel.
    pub(super) fn has_tile(&self, tile: usize) -> bool {
        self.counts.is_empty() || self.masks[tile] != [0; TILE]
    }

    /// Whether a Gaussian may cover a marked pixel.
    pub(super) fn may_cover(&self, splat2d: &Splat2d) -> bool {
        if self.counts.is_empty() {
            return true;
        }
        let half = self.reach * f64::from(splat2d.radius) + 1.0;
        // Casts cut off and saturate.
        let corner = |axis: usize, side: f64| ((splat2d.mean[axis] + side) as usize).min(self.size[axis]);
        let [left, top] = [0, 1].map(|axis| corner(axis, -half));
        let [right, bottom] = [0, 1].map(|axis| corner(axis, half + 1.0));
        let count = |column: usize, row: usize| self.counts[row * (self.size[0] + 1) + column];
        count(right, bottom) + count(left, top) > count(left, bottom) + count(right, top)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_fall_into_their_tiles() {
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = View::new([40, 20], [50.0, 50.0], [20.0, 10.0], pose).unwrap();
        let mut marks = vec![false; 40 * 20];
        marks[17 * 40 + 35] = true;
        let mask = PixelMask::marked(&view, &RasterSettings::default(), &marks);
        let mut expected = [0; TILE];
        expected[1] = 1 << 3;
        assert_eq!(mask.of_tile(5), &expected);
        let has: Vec<bool> = (0..6).map(|tile| mask.has_tile(tile)).collect();
        assert_eq!(has, [false, false, false, false, false, true]);
        // 3.33 standard deviations of a third of the radius, and a pixel.
        let meets = |mean, radius| mask.may_cover(&splat2d(mean, radius));
        assert!(meets([35.0, 17.0], 1.0) && meets([30.0, 17.0], 4.0) && meets([35.0, 30.0], 10.0));
        assert!(!meets([30.0, 17.0], 3.0) && !meets([35.0, 30.0], 9.0) && !meets([-90.0, -90.0], 20.0));
        let all = PixelMask::all(&view);
        assert_eq!(
            (all.of_tile(0)[3], all.of_tile(2)[3], all.of_tile(3)[3], all.of_tile(3)[4]),
            (0xffff, 0xff, 0xffff, 0)
        );
        assert!(all.has_tile(3) && all.may_cover(&splat2d([-90.0, -90.0], 20.0)));
    }

    fn splat2d(mean: [f64; 2], radius: f32) -> Splat2d {
        Splat2d {
            mean,
            conic_factor: [1.0, 0.0, 1.0],
            log_opacity: 0.0,
            colour: [0.0; 3],
            depth: 1.0,
            index: 0,
            radius,
            tiles: [0, 1, 0, 1],
        }
    }
}
