//! A frame as points in space, and what a set of its pixels shows.

use glam::{DVec2, DVec3, Vec3};
use l4d_data::Scale;
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;

use super::lab::LabTable;
use super::perceive::{Body, Glimpse, median};
use crate::clip::{ClipFrame, ViewClip};

/// Pixels filled less than this show nothing.
const LEAST_ALPHA: f32 = 0.5;
/// How deep a thing may be to either side of its middle, in widths.
const DEEP: f64 = 0.6;
/// Median depth up to which a scene is a tabletop, and up to which it is a room; metres.
const SCALE_DEPTH_M: [f64; 2] = [1.7, 5.0];

/// A frame in space.
#[derive(Debug, Clone)]
pub(super) struct Surface<'c> {
    frame: &'c ClipFrame,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Planar depth, metres; infinite where nothing is known.
    pub(super) depth_m: Vec<f32>,
    /// Points, metres, world; zero where nothing is known.
    pub(super) points: Vec<Vec3>,
    focal_px: f64,
}

impl<'c> Surface<'c> {
    pub(super) fn new(clip: &ViewClip, seen: &'c ClipFrame) -> Self {
        let (width, height) = (clip.width as usize, clip.height as usize);
        let pixels = width * height;
        let is_filled =
            |index: usize| seen.depth.alpha.get(index).is_none_or(|alpha| alpha.to_f32() >= LEAST_ALPHA);
        let depth = |index: usize| {
            let depth_m = seen.depth.depth_m.get(index).copied().unwrap_or(f32::INFINITY);
            if depth_m.is_finite() && depth_m > 0.0 && is_filled(index) { depth_m } else { f32::INFINITY }
        };
        let depth_m: Vec<f32> = (0..pixels).map(depth).collect();
        let points = points_of(clip, seen.frame, &depth_m);
        Self { frame: seen, width, height, depth_m, points, focal_px: clip.camera.fx.max(1e-9) }
    }

    pub(super) fn is_known(&self, index: usize) -> bool {
        self.depth_m[index].is_finite()
    }

    /// What a set of pixels shows; nothing of none.
    pub(super) fn glimpse(&self, number: usize, members: &[u32], table: &LabTable) -> Option<Glimpse> {
        let (width, height) = (self.width as u32, self.height as u32);
        let mut mask = Mask::empty(width, height);
        let mut bounds = PixelBox { first_col: u32::MAX, first_row: u32::MAX, last_col: 0, last_row: 0 };
        let mut colour = [0.0; 3];
        for &index in members {
            let (column, row) = (index % width, index / width);
            mask.set(column, row, true);
            bounds.first_col = bounds.first_col.min(column);
            bounds.last_col = bounds.last_col.max(column);
            bounds.first_row = bounds.first_row.min(row);
            bounds.last_row = bounds.last_row.max(row);
            let shown = self.frame.colour.get_pixel_checked(column, row).map_or([0; 3], |pixel| pixel.0);
            let [l, a, b] = table.at(shown);
            colour = [colour[0] + l, colour[1] + a, colour[2] + b];
        }
        Some(Glimpse {
            number,
            mask,
            area_px: members.len() as u64,
            bounds,
            colour: colour.map(|sum| sum / members.len() as f32),
            body: self.body(members)?,
        })
    }

    /// Where that is of which these pixels are; nothing of none. Depth is wrong at outlines: what is farther from the
    /// middle than the thing is wide belongs to something else.
    pub(super) fn body(&self, pixels: &[u32]) -> Option<Body> {
        let known: Vec<usize> =
            pixels.iter().map(|&pixel| pixel as usize).filter(|&pixel| self.is_known(pixel)).collect();
        let ends = |place: &dyn Fn(usize) -> usize| {
            let places = known.iter().map(|&pixel| place(pixel));
            Some((places.clone().min()?, places.max()?))
        };
        let columns = ends(&|pixel| pixel % self.width)?;
        let rows = ends(&|pixel| pixel / self.width)?;
        let is_whole = columns.0 > 0 && rows.0 > 0 && columns.1 + 1 < self.width && rows.1 + 1 < self.height;
        let depth_m = |pixel: usize| f64::from(self.depth_m[pixel]);
        let middle_m = median(known.iter().map(|&pixel| depth_m(pixel)).collect());
        let longer_px = (columns.1 - columns.0).max(rows.1 - rows.0) + 1;
        let wide_m = longer_px as f64 * middle_m / self.focal_px;
        let near = known.iter().filter(|pixel| (depth_m(**pixel) - middle_m).abs() <= DEEP * wide_m);
        let points: Vec<DVec3> = near.map(|&pixel| self.points[pixel].as_dvec3()).collect();
        Body::of(&points, is_whole)
    }
}

/// Median depth of the first frame of a clip, metres; 0 of none.
pub(super) fn median_depth_m(clip: &ViewClip) -> f64 {
    let depth = clip.frames.first().map(|seen| &seen.depth);
    let depths = depth.into_iter().flat_map(|depth| depth.depth_m.iter().zip(&depth.alpha).step_by(7));
    let is_known = |depth_m: f32, alpha: f32| depth_m.is_finite() && depth_m > 0.0 && alpha >= LEAST_ALPHA;
    let known = depths.filter(|(depth_m, alpha)| is_known(**depth_m, alpha.to_f32()));
    median(known.map(|(&depth_m, _)| f64::from(depth_m)).collect())
}

/// Size of a scene that is so far away.
pub(super) fn scale_of(median_depth_m: f64) -> Scale {
    let [table, room] = SCALE_DEPTH_M;
    if median_depth_m <= table {
        Scale::Tabletop
    } else if median_depth_m <= room {
        Scale::Room
    } else {
        Scale::Outdoor
    }
}

fn points_of(clip: &ViewClip, frame: u32, depth_m: &[f32]) -> Vec<Vec3> {
    let width = clip.width as usize;
    let eye = clip.camera.unproject(frame, DVec2::ZERO, 0.0);
    let ray = |column: f64, row: f64| clip.camera.unproject(frame, DVec2::new(column, row), 1.0) - eye;
    let corner = ray(0.5, 0.5);
    let (right, down) = (ray(1.5, 0.5) - corner, ray(0.5, 1.5) - corner);
    let point = |(index, &depth_m): (usize, &f32)| {
        if !depth_m.is_finite() {
            return Vec3::ZERO;
        }
        let (column, row) = ((index % width) as f64, (index / width) as f64);
        (eye + (corner + right * column + down * row) * f64::from(depth_m)).as_vec3()
    };
    depth_m.iter().enumerate().map(point).collect()
}
