//! How far away what pictures show is, found by comparing pictures.
//!
//! Smaller pictures are compared first, plane by plane: a plane sweep with semi-global matching (Hirschmüller 2008), twice,
//! the second time with what the views agreed on. From there each pixel looks for the slanted patch that fits best, at full
//! size. What views do not share is carried on from what they do; where most of the pictures is wanted, along the planes
//! on which much lies (floors, walls). Planes of a sweep are even in inverse depth, about a pixel of parallax apart, so
//! that the unit of the world does not matter. Knows neither time nor motion.

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

/// Most neighbours that a picture is compared with.
const NEIGHBOURS: usize = 6;
/// Cosine of the widest angle between the axes of views that are compared.
const LEAST_COSINE: f64 = 0.5;
const PLANES: usize = 256;
/// Parallax of the nearest plane, widths of the picture.
const NEAREST: f64 = 0.8;

/// A picture and from where it was taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct StereoImage<'a> {
    pub(super) view: &'a View,
    /// Display colour, row-major.
    pub(super) colour: &'a [[u8; 3]],
}

/// Planes parallel to a picture, even in inverse depth.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PlaneSweep {
    /// Inverse depth between two planes, 1/m.
    step: f32,
    planes: usize,
}

impl PlaneSweep {
    /// Planes for a view and a camera at such a distance beside it.
    fn new(view: &View, baseline_m: f64) -> Self {
        let focal_px = view.focal()[0];
        let parallax_px = NEAREST * f64::from(view.width());
        let planes = (parallax_px.ceil() as usize).clamp(2, PLANES);
        Self { step: (parallax_px / planes as f64 / (focal_px * baseline_m)) as f32, planes }
    }

    /// 1/m; the first plane includes everything that is farther.
    fn inverse_depth(&self, plane: f32) -> f32 {
        (plane + 0.5) * self.step
    }
}

/// The planes for a view among others; none where no other is beside it and looks the same way.
fn sweep(views: &[&View], of: usize) -> Option<PlaneSweep> {
    let near = neighbours(views, of);
    let (_, baseline_m) = *near.get(near.len() / 2)?;
    Some(PlaneSweep::new(views[of], baseline_m))
}

/// What a view alone says of its pixels.
struct DepthMap {
    sweep: PlaneSweep,
    /// Planar depth, metres; +inf: too far to tell. NaN: unknown, or not wanted.
    depth_m: Vec<f32>,
}

/// Planar depth, metres, of the pixels that are `wanted`, row-major, for the first images; the others are only compared
/// with. +inf: too far to tell. NaN: nothing is known, or not wanted.
pub(super) fn depths(images: &[StereoImage<'_>], wanted: &[Vec<bool>]) -> Vec<Vec<f32>> {
    let Some(first) = images.first() else { return Vec::new() };
    let factor = smaller::factor_for(first.view);
    let shrunk: Vec<(View, Vec<[u8; 3]>)> =
        images.iter().map(|image| smaller::shrunk(image, factor)).collect();
    let small: Vec<StereoImage<'_>> =
        shrunk.iter().map(|(view, colour)| StereoImage { view, colour }).collect();
    let small_wanted: Vec<Vec<bool>> =
        wanted.iter().map(|wanted| smaller::any(wanted, first.view, factor)).collect();
    let alone = agreed(&small, &swept(&small, &small_wanted, None));
    let small_maps = swept(&small, &small_wanted, Some(&alone));
    let together = agreed(&small, &small_maps);
    let (coarse, _) = filled(&small, &small_wanted, &together);
    // What moves is too small for planes.
    let has_planes = is_most(wanted);
    let coarse_planes = if has_planes { shared_planes(&small, &small_maps, &together) } else { Vec::new() };
    let maps: Vec<Option<DepthMap>> = each(images, wanted, |of, others, sweep| {
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

fn is_most(wanted: &[Vec<bool>]) -> bool {
    2 * wanted.iter().flatten().filter(|wanted| **wanted).count() > wanted.iter().map(Vec::len).sum::<usize>()
}

/// The largest difference of two colours in a channel, bytes.
fn difference(one: [u8; 3], other: [u8; 3]) -> u8 {
    std::iter::zip(one, other).map(|(one, other)| one.abs_diff(other)).max().unwrap_or_default()
}

/// Metres; what is within half a plane of infinity is there.
fn depth_m(inverse: f32, step: f32) -> f32 {
    if inverse < 0.25 * step { f32::INFINITY } else { 1.0 / inverse }
}

/// What each view says, compared with its neighbours; none for those without any, or of which nothing is wanted.
fn each(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    depths: impl Fn(usize, &[StereoImage<'_>], &PlaneSweep) -> Vec<f32> + Sync,
) -> Vec<Option<DepthMap>> {
    let views: Vec<&View> = images.iter().map(|image| image.view).collect();
    let map = |of: usize| {
        let sweep = sweep(&views, of).filter(|_| wanted[of].contains(&true))?;
        let others: Vec<StereoImage<'_>> =
            neighbours(&views, of).into_iter().map(|(other, _)| images[other]).collect();
        Some(DepthMap { sweep, depth_m: depths(of, &others, &sweep) })
    };
    (0..wanted.len()).into_par_iter().map(map).collect()
}

/// The best planes of a sweep by themselves, or with what the views know.
fn swept(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    known: Option<&[Vec<Known>]>,
) -> Vec<Option<DepthMap>> {
    let pinholes: Vec<Pinhole> = images.iter().map(|image| Pinhole::new(image.view)).collect();
    each(images, wanted, |of, others, sweep| {
        let mut volume = costs(&images[of], others, sweep, &wanted[of]);
        if let Some(known) = known {
            weigh(&mut volume, &pinholes, known, of, sweep, &wanted[of]);
        }
        matched(&volume, &images[of], sweep, &wanted[of])
    })
}

/// Inverse depths by view, carried on to where nothing is shared, and their support.
fn filled(
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    known: &[Vec<Known>],
) -> (Vec<Vec<f32>>, Vec<Vec<f32>>) {
    (0..wanted.len()).into_par_iter().map(|of| fill(&images[of], &wanted[of], &known[of])).unzip()
}

/// Views that a view can be compared with, and how far they stand from it, metres; the nearest first.
fn neighbours(views: &[&View], of: usize) -> Vec<(usize, f64)> {
    let axis = |view: &View| DVec3::from(view.rotation()[2]);
    let mut near: Vec<(usize, f64)> = (0..views.len())
        .filter(|&other| other != of && axis(views[of]).dot(axis(views[other])) > LEAST_COSINE)
        .map(|other| (other, DVec3::from(views[of].centre()).distance(views[other].centre().into())))
        .filter(|&(_, away_m)| away_m > 0.0)
        .collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    near.truncate(NEIGHBOURS);
    near
}

/// Maps of views that have measured nothing, for tests of what follows.
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

    /// What the cameras of the made-up world see at a moment, and how much of it is found within `tolerance_m`, wrongly,
    /// and not at all.
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
    fn a_card_stands_before_its_wall() {
        let [right, wrong, unknown] = shares(0, 0.25);
        println!("right {right:.3}, wrong {wrong:.3}, unknown {unknown:.3}");
        // Pictures of 48 pixels, of which the outer ones see what no neighbour does: 0.65, 0.17 and 0.18.
        assert!(right > 0.6 && wrong < 0.2, "right {right:.3}, wrong {wrong:.3}, unknown {unknown:.3}");
    }

    #[test]
    fn one_view_alone_tells_nothing() {
        let views = World::EMPTY.views(1);
        let camera = &views.cameras()[0];
        let image = StereoImage { view: camera.view(0), colour: &camera.picture(0).colour };
        let twice = depths(&[image, image], &[vec![true; views.pixel_count()]]);
        assert!(twice[0].iter().all(|depth_m| depth_m.is_nan()));
    }
}
