//! Points of surfaces, from the depth of training cameras at one moment.
//!
//! Every pixel with a depth is a point; which of them are kept is decided by a hash of the pixel, so that they lie
//! evenly and are the same in every run. Depth is that of the render: exact, and known to nobody who has a real scene.

use glam::{DVec2, DVec3};
use l4d_data::{Camera, DataError};
use l4d_frames::Frame;
use rayon::prelude::*;

use super::footage::Footage;
use crate::ply::ColouredPoint;

/// A surface seen by another camera lies so near to its depth, relative.
const DEPTH_TOLERANCE: f64 = 0.01;

/// What the training cameras saw at a moment.
pub(super) struct Moment<'a> {
    pub(super) views: Vec<View<'a>>,
}

/// What one of them saw.
pub(super) struct View<'a> {
    pub(super) camera: &'a Camera,
    pub(super) frame: Frame,
    number: u32,
    shown: Vec<[u8; 3]>,
}

/// A point and the pixel that it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SeenPoint {
    pub(super) surface: ColouredPoint,
    pub(super) view: usize,
}

impl<'a> Moment<'a> {
    pub(super) fn read(footage: &'a Footage, frame: u32) -> Result<Self, DataError> {
        let views = footage.training().into_par_iter().map(|camera| {
            let seen = footage.frame(camera, frame)?;
            let shown = footage.shown(&seen).pixels().map(|pixel| pixel.0).collect();
            Ok(View { camera, frame: seen, number: frame, shown })
        });
        Ok(Self { views: views.collect::<Result<_, DataError>>()? })
    }

    /// At most about `budget` points; all pixels with a depth if there are fewer.
    pub(super) fn points(&self, budget: usize) -> Vec<SeenPoint> {
        let is_surface = |depth_m: &&f32| depth_m.is_finite();
        let total: usize =
            self.views.iter().map(|view| view.frame.surfaces.depth_m.iter().filter(is_surface).count()).sum();
        let share = budget as f64 / total.max(1) as f64;
        let mut points = Vec::with_capacity(budget.min(total) + 64);
        for (index, view) in self.views.iter().enumerate() {
            for pixel in 0..view.shown.len() {
                let is_kept = share >= 1.0 || unit_hash(index as u64, pixel as u64) < share;
                if let Some(position) = view.surface_at(pixel).filter(|_| is_kept) {
                    points.push(SeenPoint {
                        surface: ColouredPoint { position, rgb: view.shown[pixel] },
                        view: index,
                    });
                }
            }
        }
        points
    }
}

impl View<'_> {
    /// The frame that it was seen at.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// The surface that a pixel shows.
    fn surface_at(&self, pixel: usize) -> Option<DVec3> {
        let depth_m = f64::from(self.frame.surfaces.depth_m[pixel]);
        let width = self.frame.surfaces.width as usize;
        let centre = DVec2::new((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5);
        depth_m.is_finite().then(|| self.camera.unproject(self.number, centre, depth_m))
    }

    /// Where the picture shows a point, unless something stands before it.
    pub(super) fn sees(&self, point: DVec3) -> Option<DVec2> {
        let (position, depth_m) = self.camera.project(self.number, point);
        let surfaces = &self.frame.surfaces;
        let size = DVec2::new(f64::from(surfaces.width), f64::from(surfaces.height));
        let is_inside = depth_m > 0.0 && position.cmpge(DVec2::ZERO).all() && position.cmplt(size).all();
        if !is_inside {
            return None;
        }
        let there_m = f64::from(surfaces.depth_m[surfaces.index(position.x as u32, position.y as u32)]);
        ((there_m - depth_m).abs() <= DEPTH_TOLERANCE * depth_m).then_some(position)
    }
}

/// A number from 0 to 1 that looks random and depends on nothing but the pixel.
fn unit_hash(view: u64, pixel: u64) -> f64 {
    // SplitMix64's finaliser over a counter.
    let mut bits = (view << 40 | pixel).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ bits >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_even_in_every_view() {
        for view in 0..4 {
            let kept = (0..100_000).filter(|&pixel| unit_hash(view, pixel) < 0.1).count();
            assert!((9_700..10_300).contains(&kept), "{kept} of view {view}");
        }
        assert_ne!(unit_hash(0, 1), unit_hash(1, 0));
    }
}
