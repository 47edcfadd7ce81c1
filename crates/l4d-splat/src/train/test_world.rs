//! A world for tests: a wall at z = 4 m, before it a card at z = 3 m that moves along x, seen by three cameras.

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
        self.views_of(moments, true)
    }

    fn views_of(&self, moments: usize, has_depth: bool) -> TrainingViews {
        let world = Self { grain: self.grain || !has_depth, ..*self };
        let frames =
            (0..moments).map(|moment| (moment * 96 / moments.max(2).saturating_sub(1)) as u32).collect();
        let mut views = TrainingViews::new(SIZE, frames, Timeline::CANONICAL).unwrap();
        for (index, x) in PLACES_M.into_iter().enumerate() {
            let camera = camera(index, x);
            let picture = |moment| {
                let picture = world.picture(&camera, moment, moments);
                if has_depth { picture } else { Picture { depth_m: Vec::new(), ..picture } }
            };
            let pictures = (0..moments).map(picture).collect();
            views.add(&camera, SIZE, pictures).unwrap();
        }
        views
    }

    /// The same without depth.
    pub(super) fn views_without_depth(&self, moments: usize) -> TrainingViews {
        self.views_of(moments, false)
    }

    fn picture(&self, camera: &Camera, moment: usize, moments: usize) -> Picture {
        let card = (self.card)(moment, moments);
        let mut picture = Picture::default();
        for row in 0..SIZE[1] {
            for column in 0..SIZE[0] {
                let at = glam::DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let near = camera.unproject(0, at, 3.0);
                let far = camera.unproject(0, at, 4.0);
                let on_card =
                    card.is_some_and(|left| (left..left + 0.6).contains(&near.x) && near.y.abs() < 0.4);
                let light = if far.y > 0.0 { (self.light)(moment, moments) } else { 1.0 };
                let stripes = if (far.x * 2.0).floor().rem_euclid(2.0) == 0.0 { 60.0 } else { 160.0 };
                let wall = (light * stripes) as u8;
                picture.depth_m.push(if on_card { f16::from_f32(3.0) } else { f16::from_f32(4.0) });
                let colour = if on_card { [220, 30, 20] } else { [wall, wall, 90] };
                let at = if on_card { near - glam::DVec3::X * card.unwrap_or_default() } else { far };
                let shade = if self.grain { 1.0 + 0.4 * grain(at) } else { 1.0 };
                picture.colour.push(colour.map(|value| (shade * f64::from(value)) as u8));
            }
        }
        picture
    }
}

/// About -1 to 1, nowhere the same.
pub(super) fn grain(at: glam::DVec3) -> f64 {
    let wave =
        |x: f64, y: f64| (7.3 * x + 2.1 * (1.9 * y).sin()).sin() * (5.9 * y + 1.7 * (3.1 * x).sin()).sin();
    0.5 * wave(at.x, at.y) + 0.5 * wave(2.3 * at.y + 0.7, 1.7 * at.x)
}

/// One that looks at the wall from a place on the x axis.
pub(super) fn camera(index: usize, x: f64) -> Camera {
    let pose = glam::DMat4::from_translation(glam::DVec3::X * x);
    Camera::new(Name::new(format!("cam{index:02}")).unwrap(), SIZE, 40.0, pose)
}
