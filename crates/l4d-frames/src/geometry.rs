//! Whether two views of the same moment agree: the proof that cameras, depth and ids belong together.
//!
//! A pixel of view A is back-projected by its depth and projected into view B, where it lands between four
//! pixel centres. Under perspective `1/z` of a plane is affine in image coordinates, so bilinear interpolation
//! of `1/z` gives the depth of B's surface there without error on planes, however slanted. Let
//! `delta = z_projected - z_B`. Only interior pixels of A (one id in their 3x3 neighbourhood) that land between
//! four pixels of one id take part. Such a point is
//!
//! - *unresolved* where A's or B's pixels do not resolve one smooth surface: second differences of `1/z`, which
//!   bound the interpolation error by an eighth of themselves an axis, are worth more than [`allowed_m`];
//! - *occluded* if `delta > tolerance`: B sees something nearer;
//! - *compared* otherwise. `|delta|` is the residual, and a large one means that A sees a surface where B looks
//!   through. Nothing bounds it from above, so wrong cameras cannot hide behind occlusion.
//!
//! `tolerance = allowed + slope + bend`: what the contract allows, 1 mm + 1e-4 z; the change of depth over the
//! 0.02 pixels by which the renderer may miss a pixel centre in either view; and the interpolation error.
//! Ids are compared where the depths agree within the tolerance.

mod lookup;
mod statistics;

use glam::DVec2;

use crate::frame::Surfaces;
use lookup::Sample;
pub(crate) use lookup::{Field, allowed_m};
pub(crate) use statistics::Summary;
pub(crate) use statistics::{CrossView, Miss};

/// How far, in pixels, the renderer may miss a pixel centre (filter width 0.01, in both views, doubled).
const JITTER_PX: f64 = 0.02;
/// A miss lies at a contact if the other id occurs within this many pixels.
const CONTACT_RADIUS_PX: i64 = 3;

/// Compares every pixel of `a` with what `b` saw at the same canonical frame.
pub(crate) fn compare(frame: u32, a: &Field, b: &Field) -> CrossView {
    let mut found = CrossView::default();
    let b_from_a = b.camera.camera_from_world(frame) * a.camera.world_from_camera(frame);
    for pixel in &a.interior {
        let index = pixel.index as usize;
        let (column, row) = (pixel.index % a.surfaces.width, pixel.index / a.surfaces.width);
        let ray = a.camera.ray(DVec2::new(f64::from(column), f64::from(row)) + 0.5);
        let point = b_from_a.transform_point3(ray * f64::from(a.surfaces.depth_m[index]));
        if point.z <= 0.0 {
            continue;
        }
        let position = b.camera.position(point);
        let Some(there) = b.sample(position) else { continue };
        found.landed += 1;
        let allowed = allowed_m(point.z);
        let bend_m = f64::from(pixel.bend_m);
        if bend_m > allowed || there.bend_m > allowed {
            found.unresolved += 1;
            continue;
        }
        let delta_m = point.z - there.depth_m;
        let slope_m = JITTER_PX * (f64::from(pixel.slope_m) + there.slope_m);
        let tolerance_m = allowed + slope_m + bend_m + there.bend_m;
        if delta_m > tolerance_m {
            found.occluded += 1;
            continue;
        }
        found.count_residual(delta_m.abs(), allowed);
        if delta_m.abs() <= tolerance_m {
            let place = Place { frame, column, row, position };
            count_ids(&mut found, place, a.surfaces.id[index], &there, a, b);
        }
    }
    found
}

/// Where a comparison happens: a pixel of A and a position in B.
struct Place {
    frame: u32,
    column: u32,
    row: u32,
    position: DVec2,
}

fn count_ids(found: &mut CrossView, place: Place, id: u32, there: &Sample, a: &Field, b: &Field) {
    found.co_visible += 1;
    if id == there.id {
        return;
    }
    let near_in_a = has_id_near(a.surfaces, i64::from(place.column), i64::from(place.row), there.id);
    let near_in_b =
        has_id_near(b.surfaces, place.position.x.floor() as i64, place.position.y.floor() as i64, id);
    found.count_miss((id, there.id), near_in_a || near_in_b, || Miss {
        id_a: id,
        id_b: there.id,
        count: 1,
        away_from_contact: 0,
        frame: place.frame,
        view_a: a.camera.name.clone(),
        pixel_a: [place.column, place.row],
        view_b: b.camera.name.clone(),
        pixel_b: [place.position.x.floor() as u32, place.position.y.floor() as u32],
    });
}

fn has_id_near(surfaces: &Surfaces, column: i64, row: i64, id: u32) -> bool {
    let around = |centre: i64, limit: u32| {
        (centre - CONTACT_RADIUS_PX).max(0)..=(centre + CONTACT_RADIUS_PX).min(i64::from(limit) - 1)
    };
    around(row, surfaces.height).any(|row| {
        around(column, surfaces.width)
            .any(|column| surfaces.id[surfaces.index(column as u32, row as u32)] == id)
    })
}

/// Ordered pairs of view indices: each view with its neighbours in the list (which is the order along the rig)
/// and with the held-out view, both ways. Grows linearly with the number of views.
pub(crate) fn view_pairs(view_count: usize, test_view: usize) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for view in 0..view_count {
        if view + 1 < view_count {
            pairs.extend([(view, view + 1), (view + 1, view)]);
        }
        if view != test_view {
            pairs.extend([(view, test_view), (test_view, view)]);
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_and_the_held_out_view_both_ways() {
        assert_eq!(view_pairs(3, 0), [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)]);
        assert_eq!(view_pairs(4, 1), [(0, 1), (1, 0), (1, 2), (1, 3), (2, 1), (2, 3), (3, 1), (3, 2)]);
        assert!(view_pairs(1, 0).is_empty());
    }
}
