//! Where Gaussians begin.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::depth::depths_at;
use super::motion::{Motion, SurfaceKind};
use super::pinhole::Pinhole;
use super::points::{Point, background_points, moving_points, thinned};
use super::stereo::sweep;
use super::views::TrainingViews;
use crate::neighbours::Tree;
use crate::view::View;

/// Movers are given points so many times closer than backgrounds of the same detail.
const MOVERS_CLOSER: f32 = 0.85;
/// Surface points that random and given points are compared with.
const SURFACE_POINTS: usize = 20_000;

/// Distance of points of a scene of which nothing is known, pixels.
const SCATTERED_PX: f32 = 6.0;
/// Points of a whole ball of backdrop; those far from anything seen, radians, are left out.
const BACKDROP_POINTS: usize = 1536;
const BACKDROP_REACH: f32 = 0.4;
/// Angle below which points before the backdrop give it colour in equal shares, radians.
const BACKDROP_ANGLE: f32 = 0.04;
/// Radius of the backdrop over the distance of the farthest thing.
const BACKDROP_RADIUS: f32 = 1.5;
/// Share of the points that a backdrop may have.
const BACKDROP_SHARE: usize = 16;

/// What the first Gaussians are made of.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) enum InitialPoints {
    /// Points on the surfaces that depth shows, as it was measured or found by comparing pictures.
    #[default]
    Depth,
    /// Points anywhere in the box of the scene, of any colour; where depth was not measured, anywhere along the rays of
    /// pixels, of their colour.
    Random,
    /// Points from elsewhere: position (world axes, metres) and display colour (0 to 1).
    Points(Vec<([f32; 3], [f32; 3])>),
}

impl InitialPoints {
    /// At most `count` points, the backdrop among them, and the radius of the backdrop about the middle of the cameras,
    /// metres; what moves is taken as it is at the moment `anchor`.
    pub(super) fn points(
        &self,
        views: &TrainingViews,
        motion: &Motion,
        anchor: usize,
        count: usize,
        random: &mut ChaCha8Rng,
    ) -> (Vec<Point>, f32) {
        let mut surface = background_points(views, motion);
        let moves = |camera, pixel| motion.moves(views, camera, anchor, pixel);
        let movers = moving_points(views, anchor, &depths_at(views, anchor, moves), moves);
        surface.extend(
            movers.into_iter().map(|point| Point { spacing_m: MOVERS_CLOSER * point.spacing_m, ..point }),
        );
        let (backdrop, radius_m) =
            backdrop(views, &thinned(&surface, SURFACE_POINTS), count / BACKDROP_SHARE);
        let count = count.saturating_sub(backdrop.len()).max(1);
        let mut points = match self {
            Self::Depth => thinned(&surface, count),
            Self::Random if !views.has_depth() => points_along_rays(views, motion, anchor, count, random),
            Self::Random => {
                let surface = thinned(&surface, SURFACE_POINTS);
                let corners = box_of(&surface);
                let mut anywhere = || {
                    let position = std::array::from_fn(|axis| {
                        let [low, high] = corners[axis];
                        low + (high - low) * random.random::<f32>()
                    });
                    (position, std::array::from_fn(|_| random.random()))
                };
                let points: Vec<_> = (0..count).map(|_| anywhere()).collect();
                with_nearest_surface(&points, &surface)
            }
            Self::Points(points) => {
                let mut points = with_nearest_surface(points, &thinned(&surface, SURFACE_POINTS));
                points.truncate(count);
                points
            }
        };
        points.extend(backdrop);
        (points, radius_m)
    }
}

/// A ball around everything, in the colours of the points before it as seen from the middle of the cameras: what shows
/// where no training camera ever looked, so that other cameras see something likely there and not black. Training leaves
/// it alone.
fn backdrop(views: &TrainingViews, surface: &[Point], most: usize) -> (Vec<Point>, f32) {
    if surface.is_empty() {
        return (Vec::new(), f32::INFINITY);
    }
    let centre = views.middle().map(|value| value as f32);
    let seen: Vec<([f32; 3], f32, [f32; 3])> = surface
        .iter()
        .map(|point| {
            let offset: [f32; 3] = std::array::from_fn(|axis| point.position[axis] - centre[axis]);
            let away_m = dot(offset, offset).sqrt().max(1e-6);
            (offset.map(|value| value / away_m), away_m, point.colour)
        })
        .collect();
    let radius_m = BACKDROP_RADIUS * seen.iter().map(|&(_, away_m, _)| away_m).fold(0.0, f32::max);
    // A small budget gets a coarser ball.
    let count = BACKDROP_POINTS.min(4 * most);
    let spacing_m = radius_m * (4.0 * std::f32::consts::PI / count.max(1) as f32).sqrt();
    let directions = (0..count).map(|index| {
        // Evenly along z, by the golden angle about it.
        let z = 1.0 - (2 * index + 1) as f32 / count as f32;
        let angle = index as f32 * 2.399_963;
        let around = (1.0 - z * z).sqrt();
        [around * angle.cos(), around * angle.sin(), z]
    });
    let at = |direction: [f32; 3]| {
        let (mut sum, mut total, mut nearest) = ([0.0; 3], 0.0, f32::INFINITY);
        for &(other, _, colour) in &seen {
            // The chord is the angle, where it matters.
            let squared = 2.0 - 2.0 * dot(direction, other).min(1.0);
            let weight = (squared + BACKDROP_ANGLE * BACKDROP_ANGLE).powi(-2);
            nearest = nearest.min(squared);
            total += weight;
            for (sum, value) in sum.iter_mut().zip(colour) {
                *sum += weight * value;
            }
        }
        (nearest < BACKDROP_REACH * BACKDROP_REACH).then(|| Point {
            position: std::array::from_fn(|axis| centre[axis] + radius_m * direction[axis]),
            colour: sum.map(|sum| sum / total),
            normal: direction.map(|value| -value),
            spacing_m,
            kind: SurfaceKind::Static,
        })
    };
    (directions.filter_map(at).collect(), radius_m)
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Points along the rays of pixels of a moment, evenly in parallax.
fn points_along_rays(
    views: &TrainingViews,
    motion: &Motion,
    moment: usize,
    count: usize,
    random: &mut ChaCha8Rng,
) -> Vec<Point> {
    let present: Vec<usize> = views.cameras_at(moment).collect();
    let from: Vec<&View> = present.iter().map(|&camera| views.cameras()[camera].view(moment)).collect();
    let sweeps: Vec<_> = (0..from.len()).filter_map(|view| Some((view, sweep(&from, view)?))).collect();
    let mut anywhere = || {
        let (view, sweep) = sweeps[random.random_range(0..sweeps.len())];
        let (camera, pinhole) = (present[view], Pinhole::new(from[view]));
        let pixel = random.random_range(0..views.pixel_count());
        let depth_m = 1.0 / sweep.inverse_depth(random.random::<f32>() * sweep.planes() as f32);
        let kind = match motion.background(camera) {
            Some(background) if !motion.moves(views, camera, moment, pixel) => background.kind[pixel],
            _ => SurfaceKind::Moving,
        };
        Point {
            position: pinhole.world(pinhole.centre_of(pixel), depth_m),
            colour: views.cameras()[camera].picture(moment).colour_of(pixel),
            normal: from[view].rotation()[2].map(|value| -value as f32),
            spacing_m: SCATTERED_PX * pinhole.footprint_m(depth_m),
            kind,
        }
    };
    let count = if sweeps.is_empty() { 0 } else { count };
    (0..count).map(|_| anywhere()).collect()
}

/// Points with what the nearest point on a surface says of normal, spacing and motion.
fn with_nearest_surface(points: &[([f32; 3], [f32; 3])], surface: &[Point]) -> Vec<Point> {
    let positions: Vec<[f32; 3]> = surface.iter().map(|point| point.position).collect();
    let tree = Tree::new(positions.as_flattened(), 3);
    let dress = |&(position, colour): &([f32; 3], [f32; 3])| match tree
        .nearest(&position, None, 1)
        .first()
        .map(|&(_, nearest)| &surface[nearest as usize])
    {
        Some(known) => Point { position, colour, ..*known },
        None => {
            Point { position, colour, normal: [0.0, 0.0, 1.0], spacing_m: 0.1, kind: SurfaceKind::Moving }
        }
    };
    points.iter().map(dress).collect()
}

/// Least and largest coordinate along each axis of all but the outermost points.
fn box_of(points: &[Point]) -> [[f32; 2]; 3] {
    std::array::from_fn(|axis| {
        let mut along: Vec<f32> = points.iter().map(|point| point.position[axis]).collect();
        along.sort_by(f32::total_cmp);
        match along.len().checked_sub(1) {
            Some(last) => [along[last / 50], along[last - last / 50]],
            None => [-1.0, 1.0],
        }
    })
}
