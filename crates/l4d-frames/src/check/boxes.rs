//! Pictures against tracks: each pixel of an instance lies in its oriented box, and a box in plain sight is seen.
//!
//! Back-projected pixels are in world space, so the test needs ids, depth, camera and track to agree at once.

use std::collections::BTreeMap;

use glam::{DMat3, DVec2, DVec3};
use l4d_data::layout::SceneDir;
use l4d_data::name::Name;
use l4d_data::scene::Scene;
use l4d_data::tracks::{Track, TrackedInstance, Tracks, at_frame};
use l4d_data::{Camera, Report};

use crate::frame::Surfaces;
use crate::geometry::allowed_m;

/// How far outside its box a pixel may lie, in units of what depth may be wrong by.
const MARGIN: f64 = 2.0;
/// A box must be this large on the picture before its absence says anything, pixels.
const SMALLEST_SIDE_PX: f64 = 8.0;

/// Contradictions, by instance.
#[derive(Debug, Default)]
pub(super) struct BoxReport {
    outside: BTreeMap<u32, Outside>,
    unseen: BTreeMap<u32, Place>,
}

#[derive(Debug, Clone)]
struct Place {
    view: Name,
    frame: u32,
}

#[derive(Debug)]
struct Outside {
    pixels: u64,
    pictures: u64,
    worst_m: f64,
    place: Place,
    pixel: [u32; 2],
}

/// An oriented box at one frame.
struct OrientedBox {
    centre: DVec3,
    world_from_box: DMat3,
    half: DVec3,
}

impl OrientedBox {
    fn at(track: &Track, frame: u32) -> Self {
        Self {
            centre: DVec3::from_array(*at_frame(&track.centre, frame)),
            world_from_box: DMat3::from_cols_array(at_frame(&track.axes, frame)).transpose(),
            half: DVec3::from_array(*at_frame(&track.extents, frame)) / 2.0,
        }
    }

    /// Distance of a point to the box, metres; 0 inside.
    fn distance_m(&self, point: DVec3) -> f64 {
        let local = self.world_from_box.transpose() * (point - self.centre);
        (local.abs() - self.half).max(DVec3::ZERO).length()
    }

    fn corners(&self) -> impl Iterator<Item = DVec3> {
        (0..8_u32).map(|corner| {
            let signs = [1, 2, 4].map(|bit| if corner & bit > 0 { 1.0 } else { -1.0 });
            self.centre + self.world_from_box * (self.half * DVec3::from_array(signs))
        })
    }
}

/// A picture and the camera that took it.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) camera: &'a Camera,
    pub(super) surfaces: &'a Surfaces,
}

pub(super) fn look(tracks: &Tracks, view: View, frame: u32) -> BoxReport {
    let boxes: BTreeMap<u32, OrientedBox> = tracks
        .instances
        .iter()
        .map(|instance| (instance.id, OrientedBox::at(&instance.track, frame)))
        .collect();
    let place = Place { view: view.camera.name.clone(), frame };
    let mut found = BoxReport::default();
    look_for_pixels_outside(&boxes, view, &place, &mut found);
    for TrackedInstance { id, .. } in &tracks.instances {
        if boxes.get(id).is_some_and(|bounds| is_in_plain_sight(bounds, view, frame))
            && !view.surfaces.id.contains(id)
        {
            found.unseen.insert(*id, place.clone());
        }
    }
    found
}

fn look_for_pixels_outside(
    boxes: &BTreeMap<u32, OrientedBox>,
    view: View,
    place: &Place,
    found: &mut BoxReport,
) {
    let View { camera, surfaces } = view;
    let world_from_camera = camera.world_from_camera(place.frame);
    let mut current: Option<(u32, &OrientedBox)> = None;
    for row in 0..surfaces.height {
        for column in 0..surfaces.width {
            let index = surfaces.index(column, row);
            let id = surfaces.id[index];
            if id == 0 {
                continue;
            }
            if current.is_none_or(|(known, _)| known != id) {
                current = boxes.get(&id).map(|bounds| (id, bounds));
            }
            let Some((_, bounds)) = current.filter(|(known, _)| *known == id) else { continue };
            let depth_m = f64::from(surfaces.depth_m[index]);
            let ray = camera.ray(DVec2::new(f64::from(column), f64::from(row)) + 0.5);
            let distance_m = bounds.distance_m(world_from_camera.transform_point3(ray * depth_m));
            if distance_m > MARGIN * allowed_m(depth_m) {
                found.add_outside(id, distance_m, place, [column, row]);
            }
        }
    }
}

/// Whether the whole box is in the picture, large enough, and nothing is before it.
fn is_in_plain_sight(bounds: &OrientedBox, view: View, frame: u32) -> bool {
    let size = DVec2::new(f64::from(view.surfaces.width), f64::from(view.surfaces.height));
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    let mut nearest_m = f64::INFINITY;
    for corner in bounds.corners() {
        let (position, depth_m) = view.camera.project(frame, corner);
        if depth_m <= 0.0 {
            return false;
        }
        low = low.min(position);
        high = high.max(position);
        nearest_m = nearest_m.min(depth_m);
    }
    if low.min_element() < 0.0 || high.cmpgt(size).any() || (high - low).min_element() < SMALLEST_SIDE_PX {
        return false;
    }
    let (first, last) = (low.floor().as_uvec2(), (high.ceil().min(size)).as_uvec2());
    (first.y..last.y).all(|row| {
        (first.x..last.x)
            .all(|column| f64::from(view.surfaces.depth_m[view.surfaces.index(column, row)]) >= nearest_m)
    })
}

impl BoxReport {
    fn add_outside(&mut self, id: u32, distance_m: f64, place: &Place, pixel: [u32; 2]) {
        let entry = self.outside.entry(id).or_insert_with(|| Outside {
            pixels: 0,
            pictures: 1,
            worst_m: 0.0,
            place: place.clone(),
            pixel,
        });
        entry.pixels += 1;
        if distance_m > entry.worst_m {
            (entry.worst_m, entry.pixel) = (distance_m, pixel);
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        for (id, more) in other.outside {
            match self.outside.get_mut(&id) {
                None => {
                    self.outside.insert(id, more);
                }
                Some(known) => {
                    let (pixels, pictures) = (known.pixels + more.pixels, known.pictures + more.pictures);
                    if more.worst_m > known.worst_m {
                        *known = more;
                    }
                    (known.pixels, known.pictures) = (pixels, pictures);
                }
            }
        }
        for (id, place) in other.unseen {
            self.unseen.entry(id).or_insert(place);
        }
    }

    pub(super) fn report(self, scene: &Scene, dir: &SceneDir, report: &mut Report) {
        let mut add = |code, id: u32, place: &Place, message: &str, hint| {
            let instance = scene.instances.iter().find(|instance| instance.id == id);
            let name = instance.map_or_else(|| format!("id {id}"), |instance| instance.name.to_string());
            let path = dir.frame(&place.view, place.frame);
            report.error(code, &path, format!("instance {name}"), message, hint);
        };
        for (id, outside) in self.outside {
            let Outside { pixels, pictures, worst_m, place, pixel: [column, row] } = outside;
            let message = format!(
                "{pixels} pixels in {pictures} pictures lie outside its box of the tracks, the worst by {:.1} mm \
                 at column {column}, row {row}",
                worst_m * 1e3
            );
            let hint = "tracks, ids, depth and camera must come from the same recipe and frame";
            add("L4D113", id, &place, &message, hint);
        }
        for (id, place) in self.unseen {
            let message = "its box is wholly in the picture and nothing is before it, but no pixel shows it";
            let hint = "check the instance's pass index and that its parts are rendered";
            add("L4D114", id, &place, message, hint);
        }
    }
}
