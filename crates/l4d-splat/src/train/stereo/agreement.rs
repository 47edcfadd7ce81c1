//! What several views say of one place: which depths they share, and what they see through.

use rayon::prelude::*;

use super::super::pinhole::Pinhole;
use super::{DepthMap, PlaneSweep, StereoImage};

/// Planes by which depths of two views may differ and still be of one surface.
const TOLERANCE_PLANES: f32 = 1.0;
/// How far a depth may be trusted that no other view shares, that one does and that more do, or all that look there; in
/// bonds between neighbours of one colour.
const TRUST: [f32; 3] = [0.005, 0.05, SHARED];
pub(super) const SHARED: f32 = 4.0;
/// What it costs a plane that one of two other views knows nothing there, or that one sees through it, bytes.
const UNSEEN: u8 = 6;
const SEEN_THROUGH: u8 = 10;

/// Inverse depth, 1/m, and how far it may be trusted: 0 where nothing is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Known {
    pub(super) inverse: f32,
    pub(super) trust: f32,
}

impl Known {
    /// Whether enough views agree.
    pub(super) fn is_shared(self) -> bool {
        self.trust >= SHARED
    }

    /// Whether what is known lies behind a point at a planar depth: views see through the point.
    fn is_behind(self, z_m: f32, tolerance: f32) -> bool {
        self.is_shared() && 1.0 / z_m - self.inverse > 2.0 * tolerance
    }
}

/// What each view says, the mean with the views that say the same.
pub(super) fn agreed(images: &[StereoImage<'_>], maps: &[Option<DepthMap>]) -> Vec<Vec<Known>> {
    let pinholes: Vec<Pinhole> = images.iter().map(|image| Pinhole::new(image.view)).collect();
    (0..maps.len())
        .into_par_iter()
        .map(|of| match &maps[of] {
            Some(map) => {
                (0..map.depth_m.len()).map(|pixel| shared(&pinholes, maps, of, map, pixel)).collect()
            }
            None => vec![Known::default(); images[of].colour.len()],
        })
        .collect()
}

fn shared(pinholes: &[Pinhole], maps: &[Option<DepthMap>], of: usize, map: &DepthMap, pixel: usize) -> Known {
    if map.depth_m[pixel].is_nan() {
        return Known::default();
    }
    let far_m = map.depth_m[pixel].min(1e4);
    let point = pinholes[of].world(pinholes[of].centre_of(pixel), far_m);
    let own = 1.0 / far_m;
    let (mut sum, mut count, mut others) = (own, 1, 0);
    for (other, map_of_other) in maps.iter().enumerate().filter(|(other, _)| *other != of) {
        let Some(found) = map_of_other else { continue };
        let Some((seen, z_m)) = pinholes[other].pixel(point) else { continue };
        others += 1;
        let difference = 1.0 / found.depth_m[seen] - 1.0 / z_m;
        if difference.abs() < TOLERANCE_PLANES * map.sweep.step {
            sum += own + difference;
            count += 1;
        }
    }
    // A map without any other cannot be checked, and is taken as it is.
    let is_only = maps.iter().enumerate().all(|(other, map)| other == of || map.is_none());
    let all = others > 0 && count > others;
    let level = if is_only || all { 2 } else { (count - 1).min(2) };
    Known { inverse: f32::max(sum / count as f32, 0.0), trust: TRUST[level] }
}

/// Adds to the costs of planes what the other views know: a point that they see is likely, one that they see through is
/// not.
pub(super) fn weigh(
    volume: &mut [u8],
    pinholes: &[Pinhole],
    known: &[Vec<Known>],
    of: usize,
    sweep: &PlaneSweep,
    wanted: &[bool],
) {
    let tolerance = TOLERANCE_PLANES * sweep.step;
    let others: Vec<usize> = (0..known.len()).filter(|other| *other != of).collect();
    for (pixel, costs) in
        volume.chunks_exact_mut(sweep.planes).enumerate().filter(|(pixel, _)| wanted[*pixel])
    {
        let centre = pinholes[of].centre_of(pixel);
        for (plane, cost) in costs.iter_mut().enumerate() {
            let point = pinholes[of].world(centre, 1.0 / sweep.inverse_depth(plane as f32));
            let (mut seen, mut through) = (0_u8, 0_u8);
            for &other in &others {
                let Some((at, z_m)) = pinholes[other].pixel(point) else { continue };
                let there = known[other][at];
                seen += u8::from(there.is_shared() && (1.0 / z_m - there.inverse).abs() < tolerance);
                through += u8::from(there.is_behind(z_m, tolerance));
            }
            *cost += UNSEEN * (2 - seen.min(2)) + SEEN_THROUGH * through.min(2);
        }
    }
}

/// Whether another view sees what lies behind a pixel's point at an inverse depth, 1/m; `step`: that of the sweep of the
/// pixel's view.
pub(super) fn is_seen_through(
    pinholes: &[Pinhole],
    known: &[Vec<Known>],
    of: usize,
    pixel: usize,
    inverse: f32,
    step: f32,
) -> bool {
    let point = pinholes[of].world(pinholes[of].centre_of(pixel), 1.0 / inverse);
    (0..known.len()).filter(|other| *other != of).any(|other| {
        let seen = pinholes[other].pixel(point);
        seen.is_some_and(|(at, z_m)| known[other][at].is_behind(z_m, TOLERANCE_PLANES * step))
    })
}

/// Moves what no other view shares away from the camera, until none sees through it.
pub(super) fn carve(
    inverse: &mut [Vec<f32>],
    images: &[StereoImage<'_>],
    known: &[Vec<Known>],
    maps: &[Option<DepthMap>],
) {
    let pinholes: Vec<Pinhole> = images.iter().map(|image| Pinhole::new(image.view)).collect();
    inverse.par_iter_mut().enumerate().for_each(|(of, inverse)| {
        let Some(map) = &maps[of] else { return };
        let step = map.sweep.step;
        for pixel in (0..inverse.len()).filter(|pixel| !known[of][*pixel].is_shared()) {
            while inverse[pixel] > step && is_seen_through(&pinholes, known, of, pixel, inverse[pixel], step)
            {
                inverse[pixel] -= step;
            }
        }
    });
}
