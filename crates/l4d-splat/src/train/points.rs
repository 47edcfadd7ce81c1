//! Points on surfaces, thinned where a picture shows little, and the Gaussians that they begin as.

use std::collections::HashSet;

use glam::Vec3;

use crate::gaussians::{Gaussians, ShDegree};
use crate::neighbours::Tree;

use super::motion::{Motion, SurfaceKind, tolerance};
use super::pinhole::Pinhole;
use super::views::TrainingViews;

/// Distance of points on a surface of one colour, pixels.
const WIDEST_PX: f32 = 8.0;
/// Difference of neighbouring pixels, display units, that halves the distance of points.
const DETAIL: f32 = 0.02;
/// A step in depth counts as this difference in colour.
const EDGE: f32 = 0.2;
/// What is infinitely far is placed on a ball so many times larger than the scene.
const SKY: f32 = 4.0;
/// Standard deviation of a new Gaussian along its surface, in distances to its neighbours; across it, in the former.
const ALONG: f32 = 0.6;
const ACROSS: f32 = 0.2;
const OPACITY: f32 = 0.8;
/// Value of the constant spherical harmonic.
pub(super) const SH_0: f32 = 0.282_094_8;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// World axes, metres.
    pub(super) position: [f32; 3],
    /// Display colour, 0 to 1.
    pub(super) colour: [f32; 3],
    pub(super) normal: [f32; 3],
    /// Metres to the next point that the detail of its surroundings asks for.
    pub(super) spacing_m: f32,
    pub(super) kind: SurfaceKind,
}

/// Points on the backgrounds of all static cameras.
pub(super) fn background_points(views: &TrainingViews, motion: &Motion) -> Vec<Point> {
    let farthest = (0..views.cameras().len())
        .filter_map(|camera| motion.background(camera))
        .flat_map(|background| background.depth_m.iter().copied().filter(|depth_m| depth_m.is_finite()))
        .fold(1.0, f32::max);
    let mut points = Vec::new();
    for (index, camera) in views.cameras().iter().enumerate() {
        let Some(background) = motion.background(index) else { continue };
        let surface = Surface {
            pinhole: Pinhole::new(camera.view(0)),
            size: views.size().map(|side| side as usize),
            depth_m: &background.depth_m,
            colour: &background.colour,
            sky_m: SKY * farthest,
        };
        let [width, _] = surface.size;
        let is_known = |pixel: &usize| {
            background.kind[*pixel] != SurfaceKind::Moving && !background.depth_m[*pixel].is_nan()
        };
        for pixel in (0..views.pixel_count()).filter(is_known) {
            let spacing_px = surface.spacing_px(pixel);
            // Thinning would drop these anyway; looking at all of them is what takes long.
            let stride = (0.5 * spacing_px) as usize;
            if stride < 2 || (pixel / width % stride == 0 && pixel % width % stride == 0) {
                points.push(surface.point(pixel, background.kind[pixel]));
            }
        }
    }
    points
}

/// Points on what moves, as it is at a moment; `depths_m` is what [`depths_at`](super::depth::depths_at) gives.
pub(super) fn moving_points(
    views: &TrainingViews,
    moment: usize,
    depths_m: &[Vec<f32>],
    wanted: impl Fn(usize, usize) -> bool,
) -> Vec<Point> {
    let mut points = Vec::new();
    for index in views.cameras_at(moment) {
        let (camera, depth_m) = (&views.cameras()[index], &depths_m[index]);
        let picture = camera.picture(moment);
        let colour: Vec<[f32; 3]> = (0..views.pixel_count()).map(|pixel| picture.colour_of(pixel)).collect();
        let surface = Surface {
            pinhole: Pinhole::new(camera.view(moment)),
            size: views.size().map(|side| side as usize),
            depth_m,
            colour: &colour,
            sky_m: f32::INFINITY,
        };
        points.extend(
            (0..views.pixel_count())
                .filter(|&pixel| depth_m[pixel].is_finite() && wanted(index, pixel))
                .map(|pixel| surface.point(pixel, SurfaceKind::Moving)),
        );
    }
    points
}

struct Surface<'a> {
    pinhole: Pinhole,
    size: [usize; 2],
    depth_m: &'a [f32],
    colour: &'a [[f32; 3]],
    sky_m: f32,
}

impl Surface<'_> {
    fn point(&self, pixel: usize, kind: SurfaceKind) -> Point {
        let depth_m = self.depth_of(pixel);
        let position = self.pinhole.world(self.pinhole.centre_of(pixel), depth_m);
        Point {
            position,
            colour: self.colour[pixel],
            normal: self.normal(pixel, position),
            spacing_m: self.spacing_px(pixel) * self.pinhole.footprint_m(depth_m),
            kind,
        }
    }

    fn spacing_px(&self, pixel: usize) -> f32 {
        (WIDEST_PX / (1.0 + self.detail(pixel) / DETAIL)).max(1.0)
    }

    fn depth_of(&self, pixel: usize) -> f32 {
        let depth_m = self.depth_m[pixel];
        if depth_m.is_finite() {
            return depth_m;
        }
        let ray = self.pinhole.ray(self.pinhole.centre_of(pixel));
        self.sky_m / ray.iter().map(|value| value * value).sum::<f32>().sqrt()
    }

    /// Largest difference to a neighbour.
    fn detail(&self, pixel: usize) -> f32 {
        let here = self.colour[pixel];
        let difference = |other: usize| {
            let there = self.colour[other];
            let colour = (0..3).map(|channel| (here[channel] - there[channel]).abs()).fold(0.0, f32::max);
            if self.joins(pixel, other) { colour } else { colour.max(EDGE) }
        };
        self.beside(pixel).into_iter().flatten().map(difference).fold(0.0, f32::max)
    }

    /// Whether two neighbours lie on one surface, as far as one can tell.
    fn joins(&self, pixel: usize, other: usize) -> bool {
        let (a_m, b_m) = (self.depth_m[pixel], self.depth_m[other]);
        a_m == b_m || (a_m - b_m).abs() < 8.0 * tolerance(a_m.min(b_m))
    }

    /// Neighbours left, right, above, below.
    fn beside(&self, pixel: usize) -> [Option<usize>; 4] {
        let [width, height] = self.size;
        let (row, column) = (pixel / width, pixel % width);
        [
            (column > 0).then(|| pixel - 1),
            (column + 1 < width).then(|| pixel + 1),
            (row > 0).then(|| pixel - width),
            (row + 1 < height).then(|| pixel + width),
        ]
    }

    /// Across the two steps to neighbours on the same surface; towards the camera where there are none.
    fn normal(&self, pixel: usize, position: [f32; 3]) -> [f32; 3] {
        let step = |from: Option<usize>, to: Option<usize>| {
            let [from, to] = [from, to].map(|side| side.filter(|&other| self.joins(pixel, other)));
            let place = |side: Option<usize>| {
                let at = |other| self.pinhole.world(self.pinhole.centre_of(other), self.depth_of(other));
                Vec3::from(side.map_or(position, at))
            };
            (from.is_some() || to.is_some()).then(|| place(to) - place(from))
        };
        let unit = |vector: Vec3| (vector.length() > 1e-12).then(|| (vector / vector.length()).to_array());
        let [left, right, above, below] = self.beside(pixel);
        let towards = Vec3::from(self.pinhole.centre()) - Vec3::from(position);
        let across = step(left, right).zip(step(above, below)).map(|(x, y)| x.cross(y));
        across.and_then(unit).or_else(|| unit(towards)).unwrap_or([0.0, 0.0, 1.0])
    }
}

/// The points that are left when each keeps others at `scale` times its spacing: cells of powers of two, one point a
/// cell, fine ones first.
fn kept(points: &[Point], by_spacing: &[u32], scale: f32) -> Vec<u32> {
    let mut taken = HashSet::new();
    let mut kept = Vec::new();
    for &index in by_spacing {
        let point = &points[index as usize];
        let level = (point.spacing_m * scale).log2().floor() as i32;
        let cell = |level: i32| {
            let side = (level as f32).exp2();
            (level, point.position.map(|value| (value / side).floor() as i64))
        };
        if taken.insert(cell(level)) {
            // A coarser point would add nothing next to a finer one.
            taken.insert(cell(level + 1));
            kept.push(index);
        }
    }
    kept
}

/// At most `count` points, spread as their spacings ask for. Their spacing becomes the one that came about.
pub(super) fn thinned(points: &[Point], count: usize) -> Vec<Point> {
    let mut by_spacing: Vec<u32> = (0..points.len() as u32).collect();
    by_spacing.sort_by(|&a, &b| points[a as usize].spacing_m.total_cmp(&points[b as usize].spacing_m));
    // Each doubling of the spacing leaves a quarter of the points; bisect on a logarithmic scale.
    let (mut low, mut high) = (0.5_f32, 64.0_f32);
    let mut best = kept(points, &by_spacing, low);
    if best.len() > count {
        for _ in 0..10 {
            let middle = (low * high).sqrt();
            let found = kept(points, &by_spacing, middle);
            if found.len() > count {
                low = middle;
            } else {
                high = middle;
                best = found;
            }
        }
        best.truncate(count);
    } else {
        high = low;
    }
    best.sort_unstable();
    best.into_iter()
        .map(|index| {
            let point = points[index as usize];
            Point { spacing_m: point.spacing_m * high, ..point }
        })
        .collect()
}

/// Gaussians at points: discs on their surfaces, as wide as the way to their neighbours.
pub(super) fn gaussians(points: &[Point], degree: ShDegree) -> Gaussians {
    let positions: Vec<[f32; 3]> = points.iter().map(|point| point.position).collect();
    let tree = Tree::new(positions.as_flattened(), 3);
    let mut gaussians = Gaussians { sh_degree: degree, ..Gaussians::default() };
    for (index, point) in points.iter().enumerate() {
        let near = tree.nearest(&point.position, Some(index as u32), 3);
        // Alone, it is as wide as its surroundings ask for.
        let mean =
            if near.len() < 3 { f32::INFINITY } else { near.iter().map(|one| one.0).sum::<f32>() / 3.0 };
        let mean = mean.sqrt();
        let along = ALONG * mean.clamp(0.5 * point.spacing_m, 1.5 * point.spacing_m).max(1e-6);
        gaussians.means.push(point.position);
        gaussians.log_scales.push([along.ln(), along.ln(), (ACROSS * along).ln()]);
        gaussians.rotations.push(towards(point.normal));
        gaussians.opacity_logits.push((OPACITY / (1.0 - OPACITY)).ln());
        gaussians.sh.push(point.colour.map(|value| (value - 0.5) / SH_0));
        gaussians.sh.extend(std::iter::repeat_n([0.0; 3], degree.coefficients() - 1));
    }
    gaussians
}

/// Quaternion (w, x, y, z) that turns the own z axis to a unit vector.
fn towards([x, y, z]: [f32; 3]) -> [f32; 4] {
    if z < -0.999_9 {
        return [0.0, 1.0, 0.0, 0.0];
    }
    // Half way between the two: (1 + cos, sin * axis), scaled.
    let length = (2.0 * (1.0 + z)).sqrt();
    [0.5 * length, -y / length, x / length, 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(count: usize, spacing_m: f32) -> Vec<Point> {
        let at = |index: usize| Point {
            position: [index as f32 * 0.01, 0.0, 0.0],
            colour: [0.5; 3],
            normal: [0.0, 0.0, 1.0],
            spacing_m,
            kind: SurfaceKind::Static,
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn points_are_thinned_to_the_spacing_that_they_ask_for() {
        let mut points = row(400, 0.02);
        for point in &mut points[200..] {
            point.spacing_m = 0.16;
        }
        let thin = thinned(&points, 60);
        let fine = thin.iter().filter(|point| point.position[0] < 2.0).count();
        assert!(thin.len() <= 60 && thin.len() > 30, "{}", thin.len());
        assert!(fine > 5 * (thin.len() - fine), "{fine} of {}", thin.len());
        assert_eq!(thinned(&points[..5], 60).len(), 5);
        assert!(thinned(&[], 60).is_empty());
    }

    #[test]
    fn new_gaussians_are_discs_on_their_surface() {
        let mut points = row(5, 0.01);
        points[2].normal = [0.0, 1.0, 0.0];
        let gaussians = gaussians(&points, ShDegree::new(1).unwrap());
        assert_eq!((gaussians.len(), gaussians.sh.len()), (5, 20));
        // Neighbours of the middle one: 0.01, 0.01, 0.02; their root mean square is clamped to 0.015.
        let expected = (ALONG * 2e-4_f32.sqrt()).ln();
        assert!((gaussians.log_scales[2][0] - expected).abs() < 1e-4);
        assert!((gaussians.log_scales[2][2] - (expected + ACROSS.ln())).abs() < 1e-4);
        // Turns z to y: a quarter turn about -x.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        for (found, expected) in gaussians.rotations[2].into_iter().zip([half, -half, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6);
        }
        assert_eq!(gaussians.rotations[0], [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(towards([0.0, 0.0, -1.0]), [0.0, 1.0, 0.0, 0.0]);
    }
}
