//! Where Gaussians begin.

use glam::Vec3;

use super::colmap::ColouredPoint;
use super::depth::depths_at;
use super::motion::{Motion, SurfaceKind};
use super::points::{Point, background_points, moving_points, thinned};
use super::views::TrainingViews;
use crate::neighbours::Tree;

/// Movers are given points so many times closer than backgrounds of the same detail.
const MOVERS_CLOSER: f32 = 0.85;
/// Surface points that given points are compared with.
const SURFACE_POINTS: usize = 20_000;

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
    Surfaces,
    /// Points from elsewhere.
    Points(Vec<ColouredPoint>),
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
            Self::Surfaces => thinned(&surface, count),
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
    let centre = Vec3::from(views.middle().map(|value| value as f32));
    let seen: Vec<(Vec3, f32, [f32; 3])> = surface
        .iter()
        .map(|point| {
            let offset = Vec3::from(point.position) - centre;
            let away_m = offset.length().max(1e-6);
            (offset / away_m, away_m, point.colour)
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
        Vec3::new(around * angle.cos(), around * angle.sin(), z)
    });
    let at = |direction: Vec3| {
        let (mut sum, mut total, mut nearest) = ([0.0; 3], 0.0, f32::INFINITY);
        for &(other, _, colour) in &seen {
            // The chord is the angle, where it matters.
            let squared = 2.0 - 2.0 * direction.dot(other).min(1.0);
            let weight = (squared + BACKDROP_ANGLE * BACKDROP_ANGLE).powi(-2);
            nearest = nearest.min(squared);
            total += weight;
            for (sum, value) in sum.iter_mut().zip(colour) {
                *sum += weight * value;
            }
        }
        (nearest < BACKDROP_REACH * BACKDROP_REACH).then(|| Point {
            position: (centre + radius_m * direction).to_array(),
            colour: sum.map(|sum| sum / total),
            normal: (-direction).to_array(),
            spacing_m,
            kind: SurfaceKind::Static,
        })
    };
    (directions.filter_map(at).collect(), radius_m)
}

/// Points with what the nearest point on a surface says of normal, spacing and motion.
fn with_nearest_surface(points: &[ColouredPoint], surface: &[Point]) -> Vec<Point> {
    let positions: Vec<[f32; 3]> = surface.iter().map(|point| point.position).collect();
    let tree = Tree::new(positions.as_flattened(), 3);
    let dress = |&(position, colour): &ColouredPoint| match tree
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
