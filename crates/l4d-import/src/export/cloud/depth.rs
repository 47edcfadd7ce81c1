//! Points from the depth of training cameras: every pixel with a depth is one.
//!
//! Depth is that of the render: exact, and known to no one who has a real scene.

use glam::{DVec2, DVec3};
use l4d_data::Camera;
use l4d_frames::Surfaces;
use l4d_frames::drawn::RgbImage;

use super::{CloudPoint, is_kept, share};
use crate::points::ColouredPoint;

/// A surface seen by another camera lies so near to its depth, relative.
const DEPTH_TOLERANCE: f64 = 0.01;

/// What the training cameras saw at a moment.
pub(in crate::export) struct SeenFrame<'a> {
    views: Vec<View<'a>>,
    frame: u32,
}

/// What one of them saw.
pub(in crate::export) struct View<'a> {
    camera: &'a Camera,
    picture: RgbImage,
    surfaces: Surfaces,
}

impl<'a> SeenFrame<'a> {
    pub(in crate::export) fn new(views: Vec<View<'a>>, frame: u32) -> Self {
        Self { views, frame }
    }

    pub(super) fn points(&self, budget: usize) -> Vec<CloudPoint> {
        let is_surface = |depth_m: &&f32| depth_m.is_finite();
        let depths = self.views.iter().map(|view| view.surfaces.depth_m.iter());
        let total: usize = depths.map(|depths| depths.filter(is_surface).count()).sum();
        let share = share(budget, total);
        let mut points = Vec::with_capacity(budget.min(total) + 64);
        for (source, view) in self.views.iter().enumerate() {
            for (pixel, shown) in view.picture.pixels().enumerate() {
                if let Some(position) =
                    view.surface_at(self.frame, pixel).filter(|_| is_kept(share, source, pixel))
                {
                    points.push(CloudPoint { surface: ColouredPoint { position, rgb: shown.0 }, source });
                }
            }
        }
        points
    }

    pub(super) fn sightings(&self, point: &CloudPoint) -> Vec<(&'a Camera, DVec2)> {
        let position = point.surface.position;
        let sighting = |(index, view): (usize, &View<'a>)| {
            // Rounding must not lose the picture that the point comes from.
            let own = || view.camera.project(self.frame, position).0;
            let seen = view.sees(self.frame, position).or_else(|| (index == point.source).then(own));
            Some((view.camera, seen?))
        };
        self.views.iter().enumerate().filter_map(sighting).collect()
    }
}

impl<'a> View<'a> {
    pub(in crate::export) fn new(camera: &'a Camera, picture: RgbImage, surfaces: Surfaces) -> Self {
        Self { camera, picture, surfaces }
    }

    /// The surface that a pixel shows.
    fn surface_at(&self, frame: u32, pixel: usize) -> Option<DVec3> {
        let depth_m = f64::from(self.surfaces.depth_m[pixel]);
        let width = self.surfaces.width as usize;
        let centre = DVec2::new((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        depth_m.is_finite().then(|| self.camera.unproject(frame, centre, depth_m))
    }

    /// Where the picture shows a point, unless something is before it.
    fn sees(&self, frame: u32, point: DVec3) -> Option<DVec2> {
        let (position, depth_m) = self.camera.project(frame, point);
        let size = DVec2::new(f64::from(self.surfaces.width), f64::from(self.surfaces.height));
        let is_inside = depth_m > 0.0 && position.cmpge(DVec2::ZERO).all() && position.cmplt(size).all();
        if !is_inside {
            return None;
        }
        let index = self.surfaces.index(position.x as u32, position.y as u32);
        let there_m = f64::from(self.surfaces.depth_m[index]);
        ((there_m - depth_m).abs() <= DEPTH_TOLERANCE * depth_m).then_some(position)
    }
}
