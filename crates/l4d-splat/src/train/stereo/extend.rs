//! Extends planes to pixels whose depth no other view shares: a floor goes on where a table hides it from the others.
//!
//! Each plane's membership spreads from its shared pixels to neighbours of the same colour. A pixel gets the plane of
//! the largest membership that no other view contradicts. Finds no planes itself.

use rayon::prelude::*;

use super::super::pinhole::Pinhole;
use super::agreement::{Known, is_seen_through};
use super::fill::Bonds;
use super::planes::{ScenePlane, TOLERANCE};
use super::{DepthMap, StereoImage, difference};

/// Difference of colour that weakens the bond of two neighbours by a factor of e, bytes.
const EDGE: f32 = 8.0;
/// Pull of unshared pixels towards membership 0, in bonds of one colour: it limits how far a plane spreads.
const LOSS: f32 = 1e-3;
/// Membership below which a pixel is not put on a plane.
const LEAST: f32 = 0.02;
/// A plane may not be so many times nearer than the depth that was filled in from the surroundings of a pixel.
const NEARER: f32 = 4.0;
/// Colours that differ by more are of different surfaces, bytes; less is light and gloss, which differ between views.
const OTHER_COLOUR: u8 = 40;
/// A surface hides a point if it is at least so many times nearer.
const HIDDEN: f32 = 1.05;

/// Puts pixels that views do not share on planes, where possible: sets their inverse depth, and their support to 1.
pub(super) fn extend(
    planes: &[ScenePlane],
    images: &[StereoImage<'_>],
    wanted: &[Vec<bool>],
    maps: &[Option<DepthMap>],
    known: &[Vec<Known>],
    inverse: &mut [Vec<f32>],
    support: &mut [Vec<f32>],
) {
    let pinholes: Vec<Pinhole> = images.iter().map(|image| Pinhole::new(image.view)).collect();
    inverse.par_iter_mut().zip(support).enumerate().for_each(|(of, (inverse, support))| {
        let Some(map) = &maps[of] else { return };
        let step = map.sweep.step;
        let of_planes: Vec<Vec<f32>> =
            planes.iter().map(|plane| inverse_depths(plane, &pinholes[of], inverse.len())).collect();
        let members = memberships(&images[of], &wanted[of], &known[of], &of_planes, TOLERANCE * step);
        for pixel in (0..inverse.len()).filter(|&pixel| wanted[of][pixel] && !known[of][pixel].is_shared()) {
            let is_possible = |plane: &usize| {
                let there = of_planes[*plane][pixel];
                let most = NEARER * inverse[pixel].max(step);
                members[*plane][pixel] >= LEAST
                    && there < most
                    && !looks_different(&pinholes, images, known, of, pixel, there)
                    && !is_seen_through(&pinholes, known, of, pixel, there, step)
            };
            let by_membership = |a: &usize, b: &usize| members[*a][pixel].total_cmp(&members[*b][pixel]);
            if let Some(plane) = (0..planes.len()).filter(is_possible).max_by(by_membership) {
                inverse[pixel] = of_planes[plane][pixel];
                support[pixel] = 1.0;
            }
        }
    });
}

/// Whether every other view of a pixel's point at an inverse depth, 1/m, shows another colour there. Views in which a
/// shared depth hides the point do not count; false if none is left.
fn looks_different(
    pinholes: &[Pinhole],
    images: &[StereoImage<'_>],
    known: &[Vec<Known>],
    of: usize,
    pixel: usize,
    inverse: f32,
) -> bool {
    let point = pinholes[of].world(pinholes[of].centre_of(pixel), 1.0 / inverse);
    let own = images[of].colour[pixel];
    let differs = |other: usize| {
        let (at, z_m) = pinholes[other].pixel(point)?;
        let there = known.get(other).map(|known| known[at]).unwrap_or_default();
        let is_hidden = there.is_shared() && there.inverse > HIDDEN / z_m;
        (!is_hidden).then(|| difference(own, images[other].colour[at]) > OTHER_COLOUR)
    };
    let mut seen = (0..images.len()).filter(|other| *other != of).filter_map(differs).peekable();
    seen.peek().is_some() && seen.all(|differs| differs)
}

/// Inverse depth of a plane at each pixel, 1/m; NaN where it is behind the camera.
fn inverse_depths(plane: &ScenePlane, pinhole: &Pinhole, pixels: usize) -> Vec<f32> {
    (0..pixels).map(|pixel| plane.inverse(pinhole, pinhole.centre_of(pixel)).unwrap_or(f32::NAN)).collect()
}

/// Membership of pixels by plane, \[planes\]\[pixels\], 0 to 1: that of the shared pixels that can be reached without a
/// change of colour.
fn memberships(
    image: &StereoImage<'_>,
    wanted: &[bool],
    known: &[Known],
    planes: &[Vec<f32>],
    tolerance: f32,
) -> Vec<Vec<f32>> {
    let bonds = Bonds::new(image, wanted, EDGE);
    let nearest = |at: usize| {
        let error = |plane: usize| (planes[plane][at] - known[at].inverse).abs();
        let is_near = |plane: &usize| error(*plane) < tolerance;
        (0..planes.len()).filter(is_near).min_by(|a, b| error(*a).total_cmp(&error(*b)))
    };
    let is_shared = |at: usize| wanted[at] && known[at].is_shared();
    let of_shared: Vec<Option<usize>> =
        (0..wanted.len()).map(|at| if is_shared(at) { nearest(at) } else { None }).collect();
    let membership = |plane: usize| {
        let by_itself = |at: usize| f32::from(u8::from(of_shared[at] == Some(plane)));
        let mut values: Vec<f32> = (0..wanted.len()).map(by_itself).collect();
        let own = |at: usize| if is_shared(at) { (known[at].trust, by_itself(at)) } else { (LOSS, 0.0) };
        bonds.settle(&mut values, wanted, own, known);
        values
    };
    (0..planes.len()).map(membership).collect()
}

#[cfg(test)]
mod tests {
    use super::super::agreement::SHARED;
    use super::*;
    use crate::view::View;

    #[test]
    fn a_plane_goes_on_to_where_the_colour_changes() {
        let pose = |x: f64| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let views = [0.0, 0.2].map(|x| View::new([16, 8], [16.0, 16.0], [8.0, 4.0], pose(x)).unwrap());
        let is_floor = |at: usize| at % 16 < 9;
        // The other camera sees the floor end a pixel farther to the right.
        let colours = [9, 10].map(|end| -> Vec<[u8; 3]> {
            (0..128).map(|at| if at % 16 < end { [180, 150, 90] } else { [20, 40, 200] }).collect()
        });
        let images = [0, 1].map(|of: usize| StereoImage { view: &views[of], colour: &colours[of] });
        // Slanted: twice as near at the right edge as at the left one.
        let slanted = |at: usize| 0.2 * (1.0 + (at % 16) as f32 / 16.0);
        let mut known = vec![vec![Known::default(); 128]; 2];
        for at in (0..128).filter(|at| at % 16 < 6) {
            known[0][at] = Known { inverse: slanted(at), trust: SHARED };
        }
        let maps = super::super::empty_maps(&images);
        let planes = super::super::planes::shared_planes(&images, &maps, &known);
        assert_eq!(planes.len(), 1);
        let wanted = vec![vec![true; 128]; 2];
        let (mut inverse, mut support) = (vec![vec![0.25; 128]; 2], vec![vec![0.0; 128]; 2]);
        extend(&planes, &images, &wanted, &maps, &known, &mut inverse, &mut support);
        for at in (0..128).filter(|at| at % 16 >= 6) {
            let expected = if is_floor(at) { (slanted(at), 1.0) } else { (0.25, 0.0) };
            assert!((inverse[0][at] - expected.0).abs() < 1e-3, "{at}: {}", inverse[0][at]);
            assert_eq!(support[0][at], expected.1, "{at}");
        }
    }
}
