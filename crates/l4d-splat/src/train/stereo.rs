//! Multi-view stereo: depth maps of pictures whose cameras are known.
//!
//! 1. Small pictures: a plane sweep with semi-global matching (Hirschmüller 2008), twice, the second time with the
//!    depths on which the views agreed.
//! 2. Full size: starting there, each pixel looks for the slanted patch that fits best.
//! 3. Depths that views do not share are filled in from the shared ones around them; where most of the pictures is
//!    wanted, also along planes that many pixels share (floors, walls).
//!
//! Planes of a sweep are evenly spaced in inverse depth, about a pixel of parallax apart, so that the unit of the world
//! does not matter. Knows neither time nor motion.

mod agreement;
mod cost;
mod extend;
mod fill;
mod planes;
mod refine;
mod semi_global;
mod smaller;

use glam::DVec3;
use rayon::prelude::*;

use crate::view::View;

use super::pinhole::Pinhole;
use agreement::{Known, agreed, carve, weigh};
use cost::costs;
use extend::extend;
use fill::{fill, leave_out_unsupported};
use planes::shared_planes;
use refine::{Hints, refine};
use semi_global::matched;

/// Most neighbours with which a picture is compared.
const NEIGHBOURS: usize = 6;
/// Cosine of the widest angle between the axes of views that are compared.
const LEAST_COSINE: f64 = 0.5;
/// Most planes of a sweep.
const PLANES: usize = 512;
/// At the nearest plane another view still shows this share of the picture.
const STILL_SEEN: f64 = 0.35;
/// Widest parallax of the nearest plane, and the step in which it is looked for, widths of the picture.
const WIDEST: f32 = 6.0;
const WIDENING: f32 = 0.1;

/// A picture and from where it was taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct StereoImage<'a> {
    pub(super) view: &'a View,
    /// Display colour, row-major.
    pub(super) colour: &'a [[u8; 3]],
}

/// Planes parallel to a picture, evenly spaced in inverse depth.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PlaneSweep {
    /// Inverse depth between two planes, 1/m.
    step: f32,
    planes: usize,
}

impl PlaneSweep {
    /// Planes for a view and another one, `baseline_m` away: as near as the other one still shows enough of the picture.
    /// Where cameras turn towards a thing close to them, that is several widths of parallax away from what is far.
    fn new(view: &View, other: &View, baseline_m: f64) -> Self {
        let pixel = (1.0 / (view.focal()[0] * baseline_m)) as f32;
        let pinholes = [view, other].map(Pinhole::new);
        let size @ [width, _] = [view.width(), view.height()].map(|side| side as f32);
        let steps = (WIDEST / WIDENING) as u32;
        let inverse_depth = |step: u32| step as f32 * WIDENING * width * pixel;
        let nearest = (1..=steps)
            .rev()
            .map(inverse_depth)
            .find(|inverse| seen_share(&pinholes, size, *inverse) >= STILL_SEEN);
        let nearest = nearest.unwrap_or(width * pixel);
        let planes = ((nearest / pixel).ceil() as usize).clamp(2, PLANES);
        Self { step: nearest / planes as f32, planes }
    }

    /// Of a plane, 1/m; the first one includes everything that is farther.
    fn inverse_depth(&self, plane: f32) -> f32 {
        (plane + 0.5) * self.step
    }
}

/// How much of a picture of `size` at an inverse depth, 1/m, another view shows, 0 to 1; 64 places are asked.
fn seen_share([from, to]: &[Pinhole; 2], size: [f32; 2], inverse: f32) -> f64 {
    let place = |index: u32| [0, 3].map(|shift| ((index >> shift & 7) as f32 + 0.5) / 8.0);
    let is_seen = |index: &u32| {
        let [x, y] = place(*index);
        to.pixel(from.world([x * size[0], y * size[1]], 1.0 / inverse)).is_some()
    };
    (0..64).filter(is_seen).count() as f64 / 64.0
}

/// The planes for a view among others; none if it has no neighbours.
fn sweep(views: &[&View], reference: usize) -> Option<PlaneSweep> {
    let near = neighbours(views, reference);
    let (other, baseline_m) = *near.get(near.len() / 2)?;
    Some(PlaneSweep::new(views[reference], views[other], baseline_m))
}

/// Depths of one view, not yet compared with those of others.
struct DepthMap {
    sweep: PlaneSweep,
    /// Planar depth, metres; +inf: too far to tell. NaN: unknown, or not wanted.
    depth_m: Vec<f32>,
}

/// Planar depth, metres, row-major, of the `wanted` pixels of the first images; images without `wanted` only serve for
/// comparison. +inf: too far to tell. NaN: unknown, or not wanted.
pub(super) fn depths(images: &[StereoImage<'_>], wanted: &[Vec<bool>]) -> Vec<Vec<f32>> {
    let Some(first) = images.first() else { return Vec::new() };
    let factor = smaller::factor_for(first.view);
    let shrunk: Vec<(View, Vec<[u8; 3]>)> =
        images.iter().map(|image| smaller::shrunk(image, factor)).collect();
    let small: Vec<StereoImage<'_>> =
        shrunk.iter().map(|(view, colour)| StereoImage { view, colour }).collect();
    let small_wanted: Vec<Vec<bool>> =
        wanted.iter().map(|wanted| smaller::any(wanted, first.view, factor)).collect();
    let first_agreed = agreed(&small, &swept(&small, &small_wanted, None));
    let small_maps = swept(&small, &small_wanted, Some(&first_agreed));
    let small_agreed = agreed(&small, &small_maps);
    let (coarse, _) = filled(&small, &small_wanted, &small_agreed);
    // Where little is wanted, it is what moves, which is too small for planes.
    let has_planes = is_most_wanted(wanted);
    let coarse_planes =
        if has_planes { shared_planes(&small, &small_maps, &small_agreed) } else { Vec::new() };
    let maps: Vec<Option<DepthMap>> = depth_maps(images, wanted, |of, others, sweep| {
        let hints = Hints { images: &small, known: &coarse, of, factor, planes: &coarse_planes };
        refine(&images[of], others, sweep, &wanted[of], &hints)
    });
    let known = agreed(images, &maps);
    let (mut inverse, mut support) = filled(images, wanted, &known);
    if has_planes {
        let planes = shared_planes(images, &maps, &known);
        extend(&planes, images, wanted, &maps, &known, &mut inverse, &mut support);
    }
    carve(&mut inverse, images, &known, &maps);
    for (inverse, support) in inverse.iter_mut().zip(&support) {
        leave_out_unsupported(inverse, support);
    }
    let depth = |(inverse, map): (Vec<f32>, &Option<DepthMap>)| {
        let step = map.as_ref().map_or(0.0, |map| map.sweep.step);
        inverse.into_iter().map(|inverse| depth_m(inverse, step)).collect()
    };
    inverse.into_iter().zip(&maps).map(depth).collect()
}

/// Whether more than half of the pixels are wanted.
fn is_most_wanted(wanted: &[Vec<bool>]) -> bool {
    2 * wanted.iter().flatten().filter(|wanted| **wanted).count() > wanted.iter().map(Vec::len).sum::<usize>()
}

/// The largest difference of two colours over the channels, bytes.
fn difference(one: [u8; 3], other: [u8; 3]) -> u8 {
    std::iter::zip(one, other).map(|(one, other)| one.abs_diff(other)).max().unwrap_or_default()
}

/// Metres; +inf below half the inverse depth of the first plane. `step` as in [`PlaneSweep`].
fn depth_m(inverse: f32, step: f32) -> f32 {
    if inverse < 0.25 * step { f32::INFINITY } else { 1.0 / inverse }
}

/// The depth map of each view, from `depths` of its index, its neighbours and its planes; none for views without
/// neighbours, or of which nothing is wanted.
fn depth_maps(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    depths: impl Fn(usize, &[StereoImage<'_>], &PlaneSweep) -> Vec<f32> + Sync,
) -> Vec<Option<DepthMap>> {
    let views: Vec<&View> = images.iter().map(|image| image.view).collect();
    let map = |reference: usize| {
        let sweep = sweep(&views, reference).filter(|_| wanted[reference].contains(&true))?;
        let others: Vec<StereoImage<'_>> =
            neighbours(&views, reference).into_iter().map(|(other, _)| images[other]).collect();
        Some(DepthMap { sweep, depth_m: depths(reference, &others, &sweep) })
    };
    (0..wanted.len()).into_par_iter().map(map).collect()
}

/// Depth maps of plane sweeps: the best planes by colour alone, or also by what the views agreed on (`known`).
fn swept(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    known: Option<&[Vec<Known>]>,
) -> Vec<Option<DepthMap>> {
    let pinholes: Vec<Pinhole> = images.iter().map(|image| Pinhole::new(image.view)).collect();
    depth_maps(images, wanted, |of, others, sweep| {
        let mut volume = costs(&images[of], others, sweep, &wanted[of]);
        if let Some(known) = known {
            weigh(&mut volume, &pinholes, known, of, sweep, &wanted[of]);
        }
        matched(&volume, &images[of], sweep, &wanted[of])
    })
}

/// Inverse depths by view, 1/m, filled in where none is shared, and how well shared ones support them, 0 to 1.
fn filled(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    known: &[Vec<Known>],
) -> (Vec<Vec<f32>>, Vec<Vec<f32>>) {
    (0..wanted.len()).into_par_iter().map(|of| fill(&images[of], &wanted[of], &known[of])).unzip()
}

/// The nearest views that look about the same way as `reference` from another place, with their distance, metres.
fn neighbours(views: &[&View], reference: usize) -> Vec<(usize, f64)> {
    let axis = |view: &View| DVec3::from(view.rotation()[2]);
    let mut near: Vec<(usize, f64)> = (0..views.len())
        .filter(|&other| other != reference && axis(views[reference]).dot(axis(views[other])) > LEAST_COSINE)
        .map(|other| (other, DVec3::from(views[reference].centre()).distance(views[other].centre().into())))
        .filter(|&(_, away_m)| away_m > 0.0)
        .collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    near.truncate(NEIGHBOURS);
    near
}

/// Depth maps without depths, for tests of what comes after them.
#[cfg(test)]
fn empty_maps(images: &[StereoImage<'_>]) -> Vec<Option<DepthMap>> {
    let views: Vec<&View> = images.iter().map(|image| image.view).collect();
    let map = |sweep| DepthMap { sweep, depth_m: Vec::new() };
    (0..views.len()).map(|of| sweep(&views, of).map(map)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::test_world::World;

    /// Shares of the pixels of a synthetic world whose depth at a moment is found within `tolerance_m`, wrongly, and
    /// not at all.
    fn shares(moment: usize, tolerance_m: f32) -> [f64; 3] {
        let world = World { card: |_, _| Some(-0.3), ..World::EMPTY };
        let views = World { grain: true, ..world }.views(2);
        let images: Vec<StereoImage<'_>> = views
            .cameras()
            .iter()
            .map(|camera| StereoImage { view: camera.view(moment), colour: &camera.picture(moment).colour })
            .collect();
        let wanted = vec![vec![true; views.pixel_count()]; 3];
        let mut counts = [0.0; 3];
        for (camera, found) in views.cameras().iter().zip(depths(&images, &wanted)) {
            for (true_m, found_m) in camera.picture(moment).depth_m.iter().zip(found) {
                let error_m = (found_m - true_m.to_f32()).abs();
                let kind = if error_m < tolerance_m { 0 } else { 2 - usize::from(error_m.is_finite()) };
                counts[kind] += 1.0 / wanted.len() as f64 / wanted[0].len() as f64;
            }
        }
        counts
    }

    #[test]
    fn most_depths_of_a_card_before_a_wall_are_right() {
        let [right, wrong, unknown] = shares(0, 0.25);
        println!("right {right:.3}, wrong {wrong:.3}, unknown {unknown:.3}");
        // Pictures of 48 pixels, of which the outer ones see what no neighbour does: 0.65, 0.17 and 0.18.
        assert!(right > 0.6 && wrong < 0.2, "right {right:.3}, wrong {wrong:.3}, unknown {unknown:.3}");
    }

    #[test]
    fn planes_reach_what_two_cameras_turn_to_close_by() {
        // A metre from the origin, half a right angle apart, and parallel ones as far apart.
        let turned = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let pose = [[cos, 0.0, sin, 0.0], [0.0, 1.0, 0.0, 0.0], [-sin, 0.0, cos, 1.0]];
            View::new([128, 96], [200.0; 2], [64.0, 48.0], pose).unwrap()
        };
        let beside = |x: f64| {
            let pose = [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
            View::new([128, 96], [200.0; 2], [64.0, 48.0], pose).unwrap()
        };
        let nearest_m = |[one, other]: [View; 2]| {
            let sweep = sweep(&[&one, &other], 0).unwrap();
            assert!(sweep.planes < PLANES, "{} planes", sweep.planes);
            1.0 / (sweep.step * sweep.planes as f32)
        };
        let near_m = nearest_m([turned(0.0), turned(std::f64::consts::FRAC_PI_4)]);
        assert!((0.5..0.9).contains(&near_m), "{near_m} m");
        // Parallax of 0.6 to 0.7 widths.
        let near_m = nearest_m([beside(0.0), beside(0.7654)]);
        assert!((1.7..2.0).contains(&near_m), "{near_m} m");
    }

    #[test]
    fn cameras_at_one_place_give_no_depth() {
        let views = World::EMPTY.views(1);
        let camera = &views.cameras()[0];
        let image = StereoImage { view: camera.view(0), colour: &camera.picture(0).colour };
        let twice = depths(&[image, image], &[vec![true; views.pixel_count()]]);
        assert!(twice[0].iter().all(|depth_m| depth_m.is_nan()));
    }
}
