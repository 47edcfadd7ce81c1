//! How far away what pictures show is, found by comparing pictures.
//!
//! Plane sweep, semi-global matching (Hirschmüller 2008), and a check of the depth of each view against that of its
//! neighbours. Planes are even in inverse depth, about a pixel of parallax apart, so that the unit of the world does not
//! matter. Knows neither time nor motion.

mod cost;
mod semi_global;

use glam::DVec3;
use rayon::prelude::*;

use crate::view::View;

use super::pinhole::Pinhole;
use cost::costs;
use semi_global::matched;

/// Most neighbours that a picture is compared with.
const NEIGHBOURS: usize = 4;
/// Cosine of the widest angle between the axes of views that are compared.
const LEAST_COSINE: f64 = 0.5;
const PLANES: usize = 256;
/// Parallax of the nearest plane, widths of the picture.
const NEAREST: f64 = 0.8;
/// Dearer matches, bytes of colour, are none.
const WORST_MATCH: u8 = 30;
/// Planes by which depths of two views may differ and still be of one surface.
const AGREE_PLANES: f32 = 1.5;

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

/// Planar depth, metres, of the pixels that are `wanted`, row-major, for the first images; the others are only compared
/// with. +inf: too far to tell. NaN: unknown, or not wanted.
pub(super) fn depths(images: &[StereoImage<'_>], wanted: &[Vec<bool>]) -> Vec<Vec<f32>> {
    let views: Vec<&View> = images.iter().map(|image| image.view).collect();
    let found: Vec<Option<(PlaneSweep, Vec<f32>)>> = wanted
        .par_iter()
        .enumerate()
        .map(|(of, wanted)| {
            let sweep = sweep(&views, of).filter(|_| wanted.contains(&true))?;
            let others: Vec<StereoImage<'_>> =
                neighbours(&views, of).into_iter().map(|(other, _)| images[other]).collect();
            let volume = costs(&images[of], &others, &sweep, wanted);
            Some((sweep, matched(&volume, &images[of], &sweep, wanted)))
        })
        .collect();
    let pinholes: Vec<Pinhole> = views.iter().map(|view| Pinhole::new(view)).collect();
    (0..wanted.len())
        .into_par_iter()
        .map(|of| match &found[of] {
            Some((sweep, depth_m)) => {
                let others: Vec<usize> = neighbours(&views, of)
                    .into_iter()
                    .map(|(other, _)| other)
                    .filter(|&other| other < wanted.len())
                    .collect();
                let is_seen = |(pixel, &depth_m): (usize, &f32)| {
                    let is_told = depth_m.is_finite() && !others.is_empty();
                    let told =
                        || agrees(&pinholes, &found, of, &others, pixel, depth_m, AGREE_PLANES * sweep.step);
                    if is_told && !told() { f32::NAN } else { depth_m }
                };
                depth_m.iter().enumerate().map(is_seen).collect()
            }
            None => vec![f32::NAN; wanted[of].len()],
        })
        .collect()
}

/// Whether any other view sees the same surface at the same place.
fn agrees(
    pinholes: &[Pinhole],
    found: &[Option<(PlaneSweep, Vec<f32>)>],
    of: usize,
    others: &[usize],
    pixel: usize,
    depth_m: f32,
    tolerance: f32,
) -> bool {
    let point = pinholes[of].world(pinholes[of].centre_of(pixel), depth_m);
    others.iter().any(|&other| {
        let Some((_, depths_m)) = &found[other] else { return false };
        let Some((seen, z_m)) = pinholes[other].pixel(point) else { return false };
        (1.0 / depths_m[seen] - 1.0 / z_m).abs() < tolerance
    })
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
