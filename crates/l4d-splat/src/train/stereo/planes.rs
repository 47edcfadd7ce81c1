//! Planes that the views share: floors, walls and tops of tables. Knows nothing of what lies on them.

use glam::{DMat3, DVec3};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::super::pinhole::Pinhole;
use super::agreement::Known;
use super::{DepthMap, StereoImage};

/// Most planes of a scene.
const MOST: usize = 10;
/// Triples of pixels that are tried for each plane.
const TRIES: usize = 400;
/// Pixels that are asked, all views together.
const SAMPLES: usize = 6000;
/// Share of the samples that lie on a plane, and their number, at least.
const LEAST_SHARE: f32 = 0.03;
const LEAST: usize = 30;
/// One of so many samples votes on a triple.
const VOTERS: usize = 4;
/// Between the pixels of a triple, widths of a picture at most.
const NEAR: f32 = 0.2;
/// Draws until a pixel is near enough.
const DRAWS: usize = 200;
/// Steps of the sweep by which a pixel of a plane may be off.
pub(super) const TOLERANCE: f32 = 0.7;
const REFITS: usize = 3;

/// A plane of the world: `normal * (point - origin) = 1`.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScenePlane {
    normal: DVec3,
    origin: DVec3,
}

impl ScenePlane {
    /// Inverse depth, 1/m, at a position (u, v) of a picture; none where the plane is behind the camera.
    pub(super) fn inverse(&self, pinhole: &Pinhole, position: [f32; 2]) -> Option<f32> {
        self.along(wide(pinhole.centre()), wide(pinhole.ray(position)))
    }

    fn along(&self, centre: DVec3, ray: DVec3) -> Option<f32> {
        let away = 1.0 - self.normal.dot(centre - self.origin);
        let inverse = (self.normal.dot(ray) / away) as f32;
        (inverse.is_finite() && inverse > 0.0).then_some(inverse)
    }

    fn of_three(points: [DVec3; 3], origin: DVec3) -> Option<Self> {
        let normal = (points[1] - points[0]).cross(points[2] - points[0]);
        let away = normal.dot(points[0] - origin);
        let normal = normal / away;
        normal.is_finite().then_some(Self { normal, origin })
    }

    /// Least squares of errors in inverse depth, from a plane that is nearly right.
    fn refitted<'a>(&self, inliers: impl Iterator<Item = &'a Sample>) -> Option<Self> {
        let (mut squares, mut sum) = (DMat3::ZERO, DVec3::ZERO);
        for sample in inliers {
            // What a change of inverse depth changes of `normal * (point - origin)`.
            let slope = self.normal.dot(sample.ray) / f64::from(sample.inverse).powi(2);
            let weight = (slope * f64::from(sample.tolerance)).powi(-2);
            let offset = sample.point - self.origin;
            squares += DMat3::from_cols(offset * offset.x, offset * offset.y, offset * offset.z) * weight;
            sum += offset * weight;
        }
        let normal = squares.inverse() * sum;
        normal.is_finite().then_some(Self { normal, ..*self })
    }
}

/// A pixel of which views share the depth.
struct Sample {
    view: usize,
    at: [f32; 2],
    centre: DVec3,
    /// World axes, planar depth 1.
    ray: DVec3,
    point: DVec3,
    /// 1/m.
    inverse: f32,
    tolerance: f32,
}

impl Sample {
    fn is_on(&self, plane: &ScenePlane) -> bool {
        plane
            .along(self.centre, self.ray)
            .is_some_and(|inverse| (inverse - self.inverse).abs() < self.tolerance)
    }
}

/// The planes on which many shared pixels lie, the largest first (RANSAC, one plane after the other).
pub(super) fn shared_planes(
    images: &[StereoImage<'_>],
    maps: &[Option<DepthMap>],
    known: &[Vec<Known>],
) -> Vec<ScenePlane> {
    let mut samples = samples(images, maps, known);
    let origin = images.iter().map(|image| DVec3::from(image.view.centre())).sum::<DVec3>()
        / images.len().max(1) as f64;
    let least = LEAST.max((LEAST_SHARE * samples.len() as f32) as usize);
    let reach = NEAR * images.first().map_or(0, |image| image.view.width()) as f32;
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut found = Vec::new();
    while found.len() < MOST && samples.len() >= least {
        let votes =
            |plane: &ScenePlane| samples.iter().step_by(VOTERS).filter(|sample| sample.is_on(plane)).count();
        let proposed = (0..TRIES).filter_map(|_| propose(&samples, origin, reach, &mut random));
        let Some(mut plane) = proposed.max_by_key(votes) else { break };
        for _ in 0..REFITS {
            plane = plane.refitted(samples.iter().filter(|sample| sample.is_on(&plane))).unwrap_or(plane);
        }
        let before = samples.len();
        samples.retain(|sample| !sample.is_on(&plane));
        if before - samples.len() < least {
            break;
        }
        found.push(plane);
    }
    found
}

fn samples(images: &[StereoImage<'_>], maps: &[Option<DepthMap>], known: &[Vec<Known>]) -> Vec<Sample> {
    let shared = known.iter().flatten().filter(|known| known.is_shared()).count();
    let every = shared.div_ceil(SAMPLES).max(1);
    let mut samples = Vec::with_capacity(SAMPLES);
    let mut count = 0;
    for (view, (map, known)) in maps.iter().zip(known).enumerate() {
        let Some(DepthMap { sweep, .. }) = map else { continue };
        let pinhole = Pinhole::new(images[view].view);
        for (pixel, known) in known.iter().enumerate().filter(|(_, known)| known.is_shared()) {
            count += 1;
            // What is too far to tell lies on no plane.
            if count % every != 0 || known.inverse < 0.5 * sweep.step {
                continue;
            }
            let at = pinhole.centre_of(pixel);
            samples.push(Sample {
                view,
                at,
                centre: wide(pinhole.centre()),
                ray: wide(pinhole.ray(at)),
                point: wide(pinhole.world(at, 1.0 / known.inverse)),
                inverse: known.inverse,
                tolerance: TOLERANCE * sweep.step,
            });
        }
    }
    samples
}

/// The plane of three pixels of a view that are not far from each other.
fn propose(samples: &[Sample], origin: DVec3, reach: f32, random: &mut ChaCha8Rng) -> Option<ScenePlane> {
    let first = &samples[random.random_range(0..samples.len())];
    let is_near = |other: &&Sample| {
        other.view == first.view && (other.at[0] - first.at[0]).hypot(other.at[1] - first.at[1]) < reach
    };
    let mut another = || (0..DRAWS).map(|_| &samples[random.random_range(0..samples.len())]).find(is_near);
    ScenePlane::of_three([first.point, another()?.point, another()?.point], origin)
}

fn wide(vector: [f32; 3]) -> DVec3 {
    DVec3::from(vector.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::super::agreement::SHARED;
    use super::*;
    use crate::train::test_world::World;

    #[test]
    fn two_walls_are_found_among_noise() {
        let views = World::EMPTY.views(1);
        let images: Vec<StereoImage<'_>> = views
            .cameras()
            .iter()
            .map(|camera| StereoImage { view: camera.view(0), colour: &camera.picture(0).colour })
            .collect();
        let walls = [DVec3::new(0.0, 0.0, 0.25), DVec3::new(0.15, 0.0, 0.2)];
        let wall = |index: usize| ScenePlane { normal: walls[index], origin: DVec3::ZERO };
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let known: Vec<Vec<Known>> = images
            .iter()
            .map(|image| {
                let pinhole = Pinhole::new(image.view);
                (0..image.colour.len())
                    .map(|pixel| match pixel % 3 {
                        2 => Known { inverse: random.random_range(0.05..0.5), trust: SHARED },
                        index => Known {
                            inverse: wall(index).inverse(&pinhole, pinhole.centre_of(pixel)).unwrap_or(0.0),
                            trust: SHARED,
                        },
                    })
                    .collect()
            })
            .collect();
        let maps = super::super::empty_maps(&images);
        let found = shared_planes(&images, &maps, &known);
        let pinhole = Pinhole::new(images[1].view);
        for index in 0..2 {
            let is_it = |plane: &ScenePlane| {
                [[3.5, 4.5], [40.5, 8.5], [20.5, 30.5]].into_iter().all(|at| {
                    let inverse = |plane: &ScenePlane| plane.inverse(&pinhole, at).unwrap_or(0.0);
                    (inverse(plane) - inverse(&wall(index))).abs() < 0.01
                })
            };
            assert!(found.iter().any(is_it), "wall {index} is not among {found:?}");
        }
        assert!(shared_planes(&images, &maps, &[vec![], vec![], vec![]]).is_empty());
    }
}
