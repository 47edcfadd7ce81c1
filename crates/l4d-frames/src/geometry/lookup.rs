//! A view made ready for comparisons: what it saw at a place, and how well its pixels resolve the surface there.

use glam::DVec2;
use l4d_data::Camera;

use crate::frame::Surfaces;

/// Depth error that the contract allows at a depth: 1 mm + 1e-4 z.
pub(crate) fn allowed_m(depth_m: f64) -> f64 {
    1e-3 + 1e-4 * depth_m
}

/// A picture, the camera that took it, and what every comparison needs of them.
#[derive(Debug)]
pub(crate) struct Field<'a> {
    pub(super) camera: &'a Camera,
    pub(super) surfaces: &'a Surfaces,
    /// Inverse depth, 1/metres; 0 where nothing was hit.
    inverse: Vec<f64>,
    pub(super) interior: Vec<Interior>,
}

/// A pixel whose 3x3 neighbourhood is of one id and hits something everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interior {
    /// Index of the pixel.
    pub(super) index: u32,
    /// Change of depth over one pixel, metres.
    pub(super) slope_m: f32,
    /// Bound of the error of interpolating the depth between pixels, metres.
    pub(super) bend_m: f32,
}

/// A place between four pixels of one id.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    pub(super) id: u32,
    pub(super) depth_m: f64,
    /// As for [`Interior`].
    pub(super) slope_m: f64,
    /// As for [`Interior`].
    pub(super) bend_m: f64,
}

impl<'a> Field<'a> {
    pub(crate) fn new(camera: &'a Camera, surfaces: &'a Surfaces) -> Self {
        let inverse = surfaces.depth_m.iter().map(|depth_m| f64::from(*depth_m).recip()).collect();
        let mut field = Self { camera, surfaces, inverse, interior: Vec::new() };
        let rows = 1..surfaces.height.saturating_sub(1);
        let columns = 1..surfaces.width.saturating_sub(1);
        let pixels = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
        field.interior =
            pixels.filter_map(|(column, row)| field.interior_at(surfaces.index(column, row))).collect();
        field
    }

    fn interior_at(&self, centre: usize) -> Option<Interior> {
        let width = self.surfaces.width as usize;
        let id = self.surfaces.id[centre];
        let is_whole = [centre - width, centre, centre + width].into_iter().all(|middle| {
            let around = middle - 1..middle + 2;
            self.surfaces.id[around.clone()].iter().all(|&other| other == id)
                && self.inverse[around].iter().all(|&inverse| inverse > 0.0)
        });
        if !is_whole {
            return None;
        }
        let depth_m = self.inverse[centre].recip();
        let mut slope = 0.0;
        let mut bend = 0.0;
        for step in [1, width] {
            let [before, here, after] =
                [centre - step, centre, centre + step].map(|index| self.inverse[index]);
            slope += (before - after).abs() / 2.0;
            bend += (before - 2.0 * here + after).abs() / 8.0;
        }
        let metres = |change: f64| (change * depth_m * depth_m) as f32;
        Some(Interior { index: centre as u32, slope_m: metres(slope), bend_m: metres(bend) })
    }

    /// What lies at a position between four pixel centres, if they are of one id and hit something.
    ///
    /// `1/z` is interpolated bilinearly. Its second differences reach one pixel further; on each axis at least one
    /// of the two outer neighbours must be of the same id, or a depth edge between the four could not be told from
    /// a slanted plane.
    pub(super) fn sample(&self, position: DVec2) -> Option<Sample> {
        let corner = (position - 0.5).floor();
        let inside = corner.x >= 0.0
            && corner.y >= 0.0
            && corner.x + 1.0 < f64::from(self.surfaces.width)
            && corner.y + 1.0 < f64::from(self.surfaces.height);
        if !inside {
            return None;
        }
        let (column, row) = (corner.x as usize, corner.y as usize);
        let (width, height) = (self.surfaces.width as usize, self.surfaces.height as usize);
        let first = row * width + column;
        let id = self.surfaces.id[first];
        let four = [first, first + 1, first + width, first + width + 1];
        if !four.into_iter().all(|index| self.shows(index, id)) {
            return None;
        }
        let (before, after) = (column > 0, column + 2 < width);
        let rows = [first, first + width].map(|start| Line { start, step: 1, before, after });
        let (before, after) = (row > 0, row + 2 < height);
        let columns = [first, first + 1].map(|start| Line { start, step: width, before, after });
        let bend = (self.bend(rows, id)? + self.bend(columns, id)?) / 8.0;

        let [w00, w10, w01, w11] = four.map(|index| self.inverse[index]);
        let share = position - 0.5 - corner;
        let top = w00 + (w10 - w00) * share.x;
        let bottom = w01 + (w11 - w01) * share.x;
        let depth_m = (top + (bottom - top) * share.y).recip();
        let slope = (w10 - w00).abs().max((w11 - w01).abs()) + (w01 - w00).abs().max((w11 - w10).abs());
        let area = depth_m * depth_m;
        Some(Sample { id, depth_m, slope_m: slope * area, bend_m: bend * area })
    }

    fn shows(&self, index: usize, id: u32) -> bool {
        self.surfaces.id[index] == id && self.inverse[index] > 0.0
    }

    /// The largest second difference of `1/z` along two parallel lines, of those that stay on the id.
    fn bend(&self, lines: [Line; 2], id: u32) -> Option<f64> {
        let second_difference = |middle: usize, step: usize| {
            let [a, b, c] = [middle - step, middle, middle + step].map(|index| self.inverse[index]);
            (a - 2.0 * b + c).abs()
        };
        let mut largest = f64::NEG_INFINITY;
        for Line { start, step, before, after } in lines {
            if before && self.shows(start - step, id) {
                largest = largest.max(second_difference(start, step));
            }
            if after && self.shows(start + 2 * step, id) {
                largest = largest.max(second_difference(start + step, step));
            }
        }
        largest.is_finite().then_some(largest)
    }
}

/// Two neighbouring pixels on an axis, and whether the picture goes on before and after them.
#[derive(Clone, Copy)]
struct Line {
    start: usize,
    step: usize,
    before: bool,
    after: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane `1/z = 0.5 + 0.01 column + 0.02 row` at pixel centres, all of id 4.
    fn plane() -> Surfaces {
        let mut surfaces = Surfaces::empty(6, 5);
        for row in 0..5 {
            for column in 0..6 {
                let index = surfaces.index(column, row);
                let centre = (f64::from(column) + 0.5, f64::from(row) + 0.5);
                surfaces.depth_m[index] = (0.5 + 0.01 * centre.0 + 0.02 * centre.1).recip() as f32;
                surfaces.id[index] = 4;
            }
        }
        surfaces
    }

    fn camera() -> Camera {
        Camera::new("cam00".parse().unwrap(), [6, 5], 1.0, glam::DMat4::IDENTITY)
    }

    fn sample(surfaces: &Surfaces, x: f64, y: f64) -> Option<Sample> {
        Field::new(&camera(), surfaces).sample(DVec2::new(x, y))
    }

    #[test]
    fn planes_are_interpolated_without_error() {
        let sample = sample(&plane(), 2.8, 2.1).unwrap();
        assert!((sample.depth_m - (0.5f64 + 0.028 + 0.042).recip()).abs() < 1e-6);
        assert!(sample.bend_m < 1e-5);
        assert_eq!(sample.id, 4);
    }

    #[test]
    fn positions_without_four_neighbours_of_one_id_are_skipped() {
        let mut surfaces = plane();
        for (x, y) in [(0.4, 2.0), (5.6, 2.0), (2.0, -1e9), (f64::NAN, 2.0)] {
            assert_eq!(sample(&surfaces, x, y), None);
        }
        assert_eq!(Field::new(&camera(), &surfaces).interior.len(), 4 * 3);
        let corner = surfaces.index(3, 2);
        surfaces.id[corner] = 5;
        assert_eq!(sample(&surfaces, 2.8, 2.1), None);
        // Of the 4x3 interior pixels, the nine around the odd one are none any more.
        assert_eq!(Field::new(&camera(), &surfaces).interior.len(), 3);
    }

    #[test]
    fn a_depth_edge_between_the_four_bends_more_than_is_allowed() {
        let mut surfaces = plane();
        for row in 0..5 {
            for column in 3..6 {
                let index = surfaces.index(column, row);
                surfaces.depth_m[index] *= 1.05;
            }
        }
        let sample = sample(&surfaces, 2.9, 2.1).unwrap();
        assert!(sample.bend_m > allowed_m(sample.depth_m), "{sample:?}");
    }
}
