//! Points of a COLMAP model that is in the world of the scene.
//!
//! A point that could not have been triangulated without a held-out view is left out: it would show what that view saw.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat3, DVec2};
use l4d_data::{Camera, DataError, Name, Split};
use l4d_formats::colmap::{Model, ModelImage};

use super::{CloudPoint, is_kept, share};
use crate::capture::name_of;
use crate::points::ColouredPoint;

/// Poses of one view agree to this: radians, and the distance between its centres over that of all cameras.
const SAME_POSE: f64 = 1e-3;
/// Views that it takes to triangulate a point.
const FEWEST_VIEWS: usize = 2;

pub(in crate::export) struct Reconstruction {
    points: Vec<Point>,
    left_out: usize,
}

struct Point {
    surface: ColouredPoint,
    /// Training cameras that saw it.
    views: Vec<Name>,
}

impl Reconstruction {
    /// Reads the model in a folder. Its images are called like the views, and are where these are at one of the frames.
    pub(in crate::export) fn given(
        folder: &Path,
        cameras: &[Camera],
        frames: &[u32],
    ) -> Result<Self, DataError> {
        let model = Model::read(folder)?;
        let mut views: BTreeMap<u32, &Camera> = BTreeMap::new();
        for image in &model.images {
            if let Some(camera) = camera_of(folder, image, cameras) {
                check_pose(folder, image, camera, cameras, frames)?;
                views.insert(image.id, camera);
            }
        }
        if views.is_empty() {
            let message = "none of them is called like a view of the scene";
            let hint = "triangulate with the images and cameras of `l4d export --format colmap`";
            return Err(DataError::invalid(folder, "images", message, hint));
        }
        let mut points = Vec::with_capacity(model.points.len());
        for point in &model.points {
            if !point.position.is_finite() {
                let place = format!("point {}", point.id);
                let message = "has a position that is not finite";
                let hint = "triangulate the points again";
                return Err(DataError::invalid(folder, place, message, hint));
            }
            let mut images: Vec<u32> = point.track.iter().map(|(image, _)| *image).collect();
            images.sort_unstable();
            images.dedup();
            let is_held_out =
                |image: &u32| views.get(image).is_some_and(|camera| camera.split == Split::Test);
            let seen: Vec<u32> = images.iter().copied().filter(|image| !is_held_out(image)).collect();
            if images.is_empty() || seen.len() >= FEWEST_VIEWS {
                let surface = ColouredPoint { position: point.position, rgb: point.rgb };
                let views = seen.iter().filter_map(|image| Some(views.get(image)?.name.clone())).collect();
                points.push(Point { surface, views });
            }
        }
        Ok(Self { left_out: model.points.len() - points.len(), points })
    }

    /// How many points too few training views saw.
    pub(super) fn left_out(&self) -> usize {
        self.left_out
    }

    pub(super) fn points(&self, budget: usize) -> Vec<CloudPoint> {
        let share = share(budget, self.points.len());
        let points = self.points.iter().enumerate().filter(|(index, _)| is_kept(share, 0, *index));
        points.map(|(source, point)| CloudPoint { surface: point.surface, source }).collect()
    }

    pub(super) fn sightings<'a>(
        &self,
        point: &CloudPoint,
        present: &[&'a Camera],
        frame: u32,
    ) -> Vec<(&'a Camera, DVec2)> {
        let views = self.points.get(point.source).map_or(&[][..], |point| &point.views);
        let seen = present.iter().copied().filter(|camera| views.contains(&camera.name));
        seen.map(|camera| (camera, camera.project(frame, point.surface.position).0)).collect()
    }
}

/// The camera that an image is called like.
fn camera_of<'a>(folder: &Path, image: &ModelImage, cameras: &'a [Camera]) -> Option<&'a Camera> {
    let stem = image.name.rsplit_once('.').map_or(image.name.as_str(), |(stem, _)| stem);
    let name = name_of(folder, stem).ok()?;
    cameras.iter().find(|camera| camera.name == name)
}

fn check_pose(
    folder: &Path,
    image: &ModelImage,
    camera: &Camera,
    cameras: &[Camera],
    frames: &[u32],
) -> Result<(), DataError> {
    let there = image.camera_from_world().inverse();
    let centre = |camera: &Camera, frame: u32| camera.world_from_camera(frame).w_axis.truncate();
    let stands_there = |frame: &u32| {
        let here = camera.world_from_camera(*frame);
        let distances = cameras.iter().map(|other| centre(other, *frame).distance(centre(camera, *frame)));
        let extent = distances.fold(f64::MIN_POSITIVE, f64::max);
        let turned = DMat3::from_mat4(here).transpose() * DMat3::from_mat4(there);
        let angle =
            ((turned.x_axis.x + turned.y_axis.y + turned.z_axis.z - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
        let moved = centre(camera, *frame).distance(there.w_axis.truncate()) / extent;
        angle < SAME_POSE && moved < SAME_POSE
    };
    if frames.iter().any(stands_there) {
        return Ok(());
    }
    let message = "stands elsewhere than the view of that name: the model has a world of its own";
    let hint = "keep the poses (`colmap point_triangulator`): a mapper makes a new world";
    Err(DataError::invalid(folder, format!("image {}", image.name), message, hint))
}
