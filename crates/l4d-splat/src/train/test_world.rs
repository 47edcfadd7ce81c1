//! A world for tests: a wall at z = 4 m, before it a card at z = 3 m that moves along x, seen by three cameras.

use glam::{DMat4, DVec2, DVec3};
use half::f16;
use l4d_data::{Camera, Name, Timeline};

use super::views::{Picture, TrainingViews};

pub(super) const SIZE: [u32; 2] = [48, 32];
/// Of the cameras, along x.
const PLACES_M: [f64; 3] = [-0.5, 0.0, 0.5];

#[derive(Debug, Clone, Copy)]
pub(super) struct World {
    /// Left edge of the card at a moment of so many, metres; none if it is not there.
    pub(super) card: fn(moment: usize, moments: usize) -> Option<f64>,
    /// Light on the lower half of the wall at a moment.
    pub(super) light: fn(moment: usize, moments: usize) -> f64,
    /// Whether wall and card have a grain: where colours repeat, comparing pictures tells nothing.
    pub(super) grain: bool,
}

impl World {
    pub(super) const EMPTY: Self = Self { card: |_, _| None, light: |_, _| 1.0, grain: false };

    pub(super) fn views(&self, moments: usize) -> TrainingViews {
        let cameras: Vec<Camera> =
            PLACES_M.into_iter().enumerate().map(|(index, x)| camera(index, x)).collect();
        taken(&cameras, SIZE, moments, |camera, at, moment| self.seen(&cameras[camera], at, moment, moments))
    }

    /// The same without depth; colours never repeat then.
    pub(super) fn views_without_depth(&self, moments: usize) -> TrainingViews {
        Self { grain: true, ..*self }.views(moments).of_colour()
    }

    /// Planar depth, metres, and colour at a point of a picture, pixels.
    fn seen(&self, camera: &Camera, at: DVec2, moment: usize, moments: usize) -> (f64, [u8; 3]) {
        let card = (self.card)(moment, moments);
        let near = camera.unproject(0, at, 3.0);
        let far = camera.unproject(0, at, 4.0);
        let on_card = card.is_some_and(|left| (left..left + 0.6).contains(&near.x) && near.y.abs() < 0.4);
        let light = if far.y > 0.0 { (self.light)(moment, moments) } else { 1.0 };
        let stripes = if (far.x * 2.0).floor().rem_euclid(2.0) == 0.0 { 60.0 } else { 160.0 };
        let wall = (light * stripes) as u8;
        let colour = if on_card { [220, 30, 20] } else { [wall, wall, 90] };
        let at = if on_card { near - DVec3::X * card.unwrap_or_default() } else { far };
        let shade = if self.grain { 1.0 + 0.4 * grain(at) } else { 1.0 };
        let depth_m = if on_card { 3.0 } else { 4.0 };
        (depth_m, colour.map(|value| (shade * f64::from(value)) as u8))
    }
}

/// What cameras see at moments spread over the clip. `look` gets the index of a camera, a point of its picture (pixels)
/// and a moment, and says planar depth, metres, and colour.
pub(super) fn taken(
    cameras: &[Camera],
    size: [u32; 2],
    moments: usize,
    look: impl Fn(usize, DVec2, usize) -> (f64, [u8; 3]),
) -> TrainingViews {
    let frames = (0..moments).map(|moment| (moment * 96 / moments.max(2).saturating_sub(1)) as u32).collect();
    let mut views = TrainingViews::new(size, frames, Timeline::CANONICAL).unwrap();
    for (index, camera) in cameras.iter().enumerate() {
        let picture = |moment| {
            let mut picture = Picture::default();
            for pixel in 0..size[0] * size[1] {
                let at = DVec2::new(f64::from(pixel % size[0]), f64::from(pixel / size[0])) + 0.5;
                let (depth_m, colour) = look(index, at, moment);
                picture.depth_m.push(f16::from_f64(depth_m));
                picture.colour.push(colour);
            }
            picture
        };
        views.add(camera, size, (0..moments).map(picture).collect()).unwrap();
    }
    views
}

/// About -1 to 1, nowhere the same.
pub(super) fn grain(at: DVec3) -> f64 {
    let wave =
        |x: f64, y: f64| (7.3 * x + 2.1 * (1.9 * y).sin()).sin() * (5.9 * y + 1.7 * (3.1 * x).sin()).sin();
    0.5 * wave(at.x, at.y) + 0.5 * wave(2.3 * at.y + 0.7, 1.7 * at.x)
}

/// One that looks at the wall from a place on the x axis.
pub(super) fn camera(index: usize, x: f64) -> Camera {
    camera_at(index, DVec3::X * x, SIZE, 40.0)
}

/// One that looks along z.
pub(super) fn camera_at(index: usize, from: DVec3, size: [u32; 2], focal_px: f64) -> Camera {
    Camera::new(Name::new(format!("cam{index:02}")).unwrap(), size, focal_px, DMat4::from_translation(from))
}
