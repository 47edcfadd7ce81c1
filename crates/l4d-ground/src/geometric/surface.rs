//! A frame as points in space: which belong to what supports everything else, and which are in front of the background.

use glam::{DVec2, DVec3, Vec3};
use l4d_data::Scale;

use super::lab::LabTable;
use super::perceive::median;
use super::settings::{LEAST_ALPHA, LEAST_PX, MOVING_SHARE, SCALE_DEPTH_M, SUPPORT_SHARE, SUPPORT_THICKNESS};
use crate::clip::{ClipFrame, ViewClip};

/// Steepest support: the upward part of its normal.
const LEVEL_NORMAL: f32 = 0.88;
/// Upward part of the normal of a pixel that may belong to a support.
const LOOSE_NORMAL: f32 = 0.6;
/// Most supports that are looked for: floor, table, shelf.
const MOST_SUPPORTS: usize = 4;
/// Most frames that the background is taken from.
const BACKGROUND_FRAMES: usize = 25;

/// A frame in space.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Planar depth, metres; infinite where nothing is known.
    pub(crate) depth_m: Vec<f32>,
    /// Points, metres, world; zero where nothing is known.
    pub(crate) points: Vec<Vec3>,
    /// Upward part of the normal, 0 to 1; 0 where it isn't known.
    pub(crate) upward: Vec<f32>,
    /// L*a*b*.
    pub(crate) colours: Vec<[f32; 3]>,
}

impl Surface {
    pub(crate) fn new(clip: &ViewClip, seen: &ClipFrame, table: &LabTable) -> Self {
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
        let upward = upward_of(&points, &depth_m, width, height);
        let colour = |index: usize| {
            let (column, row) = ((index % width) as u32, (index / width) as u32);
            seen.colour.get_pixel_checked(column, row).map_or([0; 3], |pixel| pixel.0)
        };
        let colours = (0..pixels).map(|index| table.at(colour(index))).collect();
        Self { width, height, depth_m, points, upward, colours }
    }

    pub(crate) fn is_known(&self, index: usize) -> bool {
        self.depth_m[index].is_finite()
    }
}

/// Median depth of the first frame, metres; 0 of none.
pub(crate) fn median_depth_m(surfaces: &[Surface]) -> f64 {
    let depths = surfaces.iter().take(1).flat_map(|surface| surface.depth_m.iter().step_by(7));
    median(depths.filter(|depth_m| depth_m.is_finite()).map(|&depth_m| f64::from(depth_m)).collect())
}

/// Size of a scene that is so far away.
pub(crate) fn scale_of(median_depth_m: f64) -> Scale {
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

fn upward_of(points: &[Vec3], depth_m: &[f32], width: usize, height: usize) -> Vec<f32> {
    let mut upward = vec![0.0; points.len()];
    for row in 1..height.saturating_sub(1) {
        for column in 1..width.saturating_sub(1) {
            let at = row * width + column;
            let around = [at - 1, at + 1, at - width, at + width];
            if around.iter().all(|&index| depth_m[index].is_finite()) {
                let normal = (points[at + 1] - points[at - 1]).cross(points[at + width] - points[at - width]);
                upward[at] = normal.normalize_or_zero().z.abs();
            }
        }
    }
    upward
}

/// What a clip shows when nothing moves, and the level surfaces in it.
#[derive(Debug, Clone)]
pub(crate) struct Backdrop {
    /// Depth behind everything that ever moves away, metres; none where the camera moves.
    pub(crate) depth_m: Option<Vec<f32>>,
    /// Heights of supports, metres, world.
    pub(crate) levels_m: Vec<f32>,
    /// Half the thickness of a support, metres.
    pub(crate) thickness_m: f32,
}

impl Backdrop {
    pub(crate) fn new(clip: &ViewClip, surfaces: &[Surface], median_depth_m: f64) -> Self {
        let stands = clip.camera.world_from_camera.windows(2).all(|pair| pair[0] == pair[1]);
        let depth_m = (stands && surfaces.len() > 2).then(|| farthest(surfaces));
        let thickness_m = (median_depth_m * SUPPORT_THICKNESS) as f32;
        let levels_m = levels(surfaces, thickness_m, SUPPORT_SHARE);
        Self { depth_m, levels_m, thickness_m }
    }

    /// Whether a pixel shows a support.
    pub(crate) fn is_support(&self, surface: &Surface, index: usize) -> bool {
        let height_m = surface.points[index].z;
        let off = self.levels_m.iter().map(|level| (height_m - level).abs()).fold(f32::INFINITY, f32::min);
        let upward = surface.upward[index];
        (off <= self.thickness_m && upward >= LOOSE_NORMAL)
            || (off <= 0.5 * self.thickness_m && upward >= 0.0)
    }

    /// Whether a pixel shows something before the background.
    pub(crate) fn is_before(&self, surface: &Surface, index: usize, share: f32) -> bool {
        let Some(behind) = self.depth_m.as_ref().map(|depth_m| depth_m[index]) else { return false };
        surface.depth_m[index] < behind * (1.0 - share)
    }
}

impl Backdrop {
    /// Median of the points before the background, and their median distance from it, metres.
    pub(crate) fn focus(&self, surfaces: &[Surface]) -> Option<(DVec3, f64)> {
        let points: Vec<Vec3> = surfaces
            .iter()
            .flat_map(|surface| {
                let is_mover =
                    |index: &usize| surface.is_known(*index) && self.is_before(surface, *index, MOVING_SHARE);
                (0..surface.points.len()).step_by(3).filter(is_mover).map(|index| surface.points[index])
            })
            .collect();
        if points.len() < LEAST_PX {
            return None;
        }
        let middle = |axis: usize| median(points.iter().map(|point| f64::from(point[axis])).collect());
        let focus = DVec3::new(middle(0), middle(1), middle(2));
        let spread = median(points.iter().map(|point| precise(*point).distance(focus)).collect());
        Some((focus, spread))
    }
}

/// The depth that four fifths of the frames do not exceed, pixel by pixel.
fn farthest(surfaces: &[Surface]) -> Vec<f32> {
    let step = surfaces.len().div_ceil(BACKGROUND_FRAMES).max(1);
    let chosen: Vec<&Surface> = surfaces.iter().step_by(step).collect();
    let pixels = surfaces.first().map_or(0, |surface| surface.depth_m.len());
    let rank = chosen.len() * 4 / 5;
    let mut values = vec![0.0_f32; chosen.len()];
    (0..pixels)
        .map(|index| {
            for (value, surface) in values.iter_mut().zip(&chosen) {
                *value = surface.depth_m[index];
            }
            *values.select_nth_unstable_by(rank.min(chosen.len() - 1), f32::total_cmp).1
        })
        .collect()
}

/// Heights at which much of the first frame is level.
fn levels(surfaces: &[Surface], thickness_m: f32, share: f64) -> Vec<f32> {
    let Some(surface) = surfaces.first() else { return Vec::new() };
    let is_level = |index: &usize| surface.upward[*index] >= LEVEL_NORMAL && surface.is_known(*index);
    let mut heights: Vec<f32> =
        (0..surface.points.len()).filter(is_level).map(|index| surface.points[index].z).collect();
    heights.sort_by(f32::total_cmp);
    let least = (surface.points.len() as f64 * share) as usize;
    let mut levels = Vec::new();
    while levels.len() < MOST_SUPPORTS {
        let Some((first, last)) = densest(&heights, 2.0 * thickness_m) else { break };
        if last - first < least.max(1) {
            break;
        }
        levels.push(heights[(first + last) / 2]);
        heights.drain(first..last);
    }
    levels
}

/// The fullest window of a width over sorted values, as indices from, to.
fn densest(values: &[f32], width: f32) -> Option<(usize, usize)> {
    let mut first = 0;
    let mut best = None;
    for (last, &value) in values.iter().enumerate() {
        while value - values[first] > width {
            first += 1;
        }
        if best.is_none_or(|(from, to)| last + 1 - first > to - from) {
            best = Some((first, last + 1));
        }
    }
    best
}

/// Points as the rest of the crate counts them.
pub(crate) fn precise(point: Vec3) -> DVec3 {
    point.as_dvec3()
}
