//! A made-up room: a scene for benchmarks and tests that have no trained one at hand.
//!
//! Walls and floor of discs that stand still, three balls whose Gaussians go through a random field. The same room and
//! seed always give the same numbers.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;
use l4d_data::camera::looking_at;
use l4d_data::name::NameError;
use l4d_data::{Camera, Name, Split};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::deform::{Bounds, DeformConfig, DeformError, DeformationField, Init, TimeAxis};
use crate::gaussians::{Gaussians, ShDegree};
use crate::model::Model;
use crate::view::{View, ViewError};

/// Inside of the room, metres; the middle of the floor is the origin.
const SIZE_M: [f32; 3] = [4.0, 3.0, 2.6];
/// Centres of the balls, metres.
const BALLS: [[f32; 3]; 3] = [[-0.9, 0.2, 0.6], [0.2, -0.4, 0.9], [1.0, 0.5, 0.5]];
/// Radius of the balls, metres.
const BALL_M: f32 = 0.3;
/// Planes with a time axis among the six of a level.
const WITH_TIME: [usize; 3] = [2, 4, 5];
/// What is left of the offsets of a random field: of centres, scales, rotations, opacities, colours.
const STRENGTHS: [f32; 5] = [0.1, 0.3, 0.3, 0.3, 0.03];
/// Pixels of the pictures that the cameras' numbers belong to.
const CAMERA_SIZE: [u32; 2] = [256, 192];

/// How large the made-up scene is.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    /// Gaussians in all.
    pub gaussians: usize,
    /// Share of them that moves, 0 to 1.
    pub moving: f64,
    /// Degree of the spherical harmonics.
    pub sh_degree: ShDegree,
    /// Width of the field's layers.
    pub width: usize,
    /// Seed of everything random.
    pub seed: u64,
}

impl Room {
    /// A room like a trained scene of profile `small`.
    pub fn ordinary(seed: u64) -> Self {
        Self { gaussians: 10_000, moving: 0.2, sh_degree: ShDegree::MAX, width: 128, seed }
    }

    /// A room that is drawn at once.
    pub fn small(seed: u64) -> Self {
        Self {
            gaussians: 400,
            moving: 0.25,
            sh_degree: ShDegree::new(1).unwrap_or_default(),
            width: 16,
            seed,
        }
    }

    /// The scene.
    ///
    /// # Errors
    /// A width that no field has.
    pub fn model(&self) -> Result<Model, DeformError> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let moving = ((self.gaussians as f64 * self.moving) as usize).min(self.gaussians);
        let resting = self.gaussians - moving;
        let mut gaussians = Gaussians { sh_degree: self.sh_degree, ..Gaussians::default() };
        for _ in 0..resting {
            self.push_disc(&mut gaussians, resting, &mut random);
        }
        for index in 0..moving {
            self.push_mote(&mut gaussians, BALLS[index % BALLS.len()], moving, &mut random);
        }
        let dynamic = (resting as u32..self.gaussians as u32).collect();
        Ok(Model { gaussians, dynamic, field: Some(self.field(&mut random)?), ..Model::default() })
    }

    /// Eight cameras around the room and one held out, for pictures of 256 x 192 pixels.
    ///
    /// # Errors
    /// None: the numbers are fixed.
    pub fn cameras(&self) -> Result<Vec<Camera>, NameError> {
        let camera = |index: usize| {
            let angle = index as f64 * std::f64::consts::TAU / 9.0 + 0.3;
            let stands = DVec3::new(1.7 * angle.cos(), 1.3 * angle.sin(), 1.5 + 0.2 * (3.0 * angle).sin());
            let pose = looking_at(stands, DVec3::new(0.0, 0.0, 0.7));
            let camera = Camera::new(Name::new(format!("cam{index:02}"))?, CAMERA_SIZE, 200.0, pose);
            Ok(Camera { split: if index == 8 { Split::Test } else { Split::Train }, ..camera })
        };
        (0..9).map(camera).collect()
    }

    /// Size of the pictures that the cameras' numbers belong to.
    pub fn camera_size(&self) -> [u32; 2] {
        CAMERA_SIZE
    }

    /// What the cameras see in pictures of `size` pixels.
    ///
    /// # Errors
    /// A size that no picture has.
    pub fn views(&self, size: [u32; 2]) -> Result<Vec<View>, ViewError> {
        let cameras = self.cameras().unwrap_or_default();
        cameras.iter().map(|camera| View::of_camera(camera, 0, CAMERA_SIZE, size)).collect()
    }

    fn push_disc(&self, gaussians: &mut Gaussians, among: usize, random: &mut ChaCha8Rng) {
        let [x, y, z] = SIZE_M;
        // Floor, ceiling, and the four walls, by area.
        let areas = [x * y, x * y, y * z, y * z, x * z, x * z];
        let total: f32 = areas.iter().sum();
        let mut at = random.random_range(0.0..total);
        let face = areas.iter().position(|area| {
            at -= area;
            at < 0.0
        });
        let face = face.unwrap_or(0);
        let axis = [2, 0, 1][face / 2];
        let mut mean = [
            random.random_range(-0.5..0.5) * x,
            random.random_range(-0.5..0.5) * y,
            random.random_range(0.0..1.0) * z,
        ];
        mean[axis] = match (axis, face % 2) {
            (2, 0) => 0.0,
            (2, _) => z,
            (_, 0) => -0.5 * SIZE_M[axis],
            (_, _) => 0.5 * SIZE_M[axis],
        };
        let spacing = (total / among.max(1) as f32).sqrt();
        let mut log_scale = [0; 3].map(|_| (spacing * random.random_range(0.35..0.9)).ln());
        log_scale[2] = (0.05 * spacing).ln();
        // The own z axis becomes the normal of the wall.
        let rotation = match axis {
            0 => [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
            1 => [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0],
            _ => [1.0, 0.0, 0.0, 0.0],
        };
        let stripes = (PI * (mean[0] + 2.0 * mean[1] + mean[2])).sin();
        let colour = [0.35 + 0.25 * stripes, 0.4 + 0.08 * face as f32, 0.55 - 0.2 * stripes];
        self.push(gaussians, mean, log_scale, rotation, colour, random);
    }

    fn push_mote(&self, gaussians: &mut Gaussians, ball: [f32; 3], among: usize, random: &mut ChaCha8Rng) {
        let mut direction = [0.0; 3].map(|_: f32| random.random_range(-1.0..1.0_f32));
        let length = direction.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-3);
        direction = direction.map(|value| value / length);
        let mean = std::array::from_fn(|axis| ball[axis] + BALL_M * direction[axis]);
        let spacing = (3.0 * 4.0 * PI * BALL_M * BALL_M / among.max(1) as f32).sqrt();
        let log_scale = [0; 3].map(|_| (spacing * random.random_range(0.35..0.8)).ln());
        let rotation = [0; 4].map(|_| random.random_range(-1.0..1.0));
        let colour = std::array::from_fn(|axis| 0.5 + 0.4 * direction[axis] * (ball[axis] + 0.5).signum());
        self.push(gaussians, mean, log_scale, rotation, colour, random);
    }

    fn push(
        &self,
        gaussians: &mut Gaussians,
        mean: [f32; 3],
        log_scale: [f32; 3],
        rotation: [f32; 4],
        colour: [f32; 3],
        random: &mut ChaCha8Rng,
    ) {
        const CONSTANT: f32 = 0.282_094_8;
        gaussians.means.push(mean);
        gaussians.log_scales.push(log_scale);
        gaussians.rotations.push(rotation);
        gaussians.opacity_logits.push(random.random_range(0.5..4.0));
        gaussians.sh.push(colour.map(|value| (value + random.random_range(-0.05..0.05) - 0.5) / CONSTANT));
        for index in 1..self.sh_degree.coefficients() {
            // Higher bands say less, as in trained models.
            let spread = 0.06 / (index as f32).sqrt().floor().powi(2);
            gaussians.sh.push([0; 3].map(|_| random.random_range(-spread..spread)));
        }
    }

    /// A field whose offsets vary with place and time: those of an untrained one hardly do.
    fn field(&self, random: &mut ChaCha8Rng) -> Result<DeformationField, DeformError> {
        let config = DeformConfig {
            spatial_resolution: [16; 3],
            time_resolution: 8,
            width: self.width,
            sh_coefficients: self.sh_degree.coefficients(),
            time_axis: TimeAxis::Whole,
            ..DeformConfig::dynerf()
        };
        let [x, y, z] = SIZE_M;
        let bounds = Bounds::new([[0.5 * x, 0.5 * y, z], [-0.5 * x, -0.5 * y, 0.0]])?;
        let mut field = DeformationField::new(config, bounds, Init::Foreign, self.seed)?;
        let parameters = field.parameters_mut();
        for (index, plane) in parameters.planes.into_iter().enumerate() {
            let spread = if WITH_TIME.contains(&(index % 6)) { 0.4 } else { 0.2 };
            plane.fill_with(|| random.random_range(1.0 - spread..1.0 + spread));
        }
        // After the first layer, each head has weights and biases of two layers.
        let heads = parameters.layers.into_iter().skip(2).collect::<Vec<_>>();
        for (index, list) in heads.into_iter().enumerate().filter(|(index, _)| index % 4 >= 2) {
            let strength = STRENGTHS[index / 4 % STRENGTHS.len()];
            list.iter_mut().for_each(|value| *value *= strength);
        }
        Ok(field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::{Cpu, RasterSettings, Rasterizer as _};

    #[test]
    fn the_room_fills_every_picture_and_its_balls_move() {
        let room = Room::small(1);
        let model = room.model().unwrap();
        assert_eq!((model.gaussians.len(), model.dynamic.len()), (400, 100));
        assert_eq!(model, room.model().unwrap());
        assert_ne!(model, Room::small(2).model().unwrap());
        let [first, last] = [0.0, 1.0].map(|time| model.at(time).unwrap());
        let moved = |index: usize| {
            let apart = |axis: usize| first.means()[index][axis] - last.means()[index][axis];
            (0..3).map(|axis| apart(axis).powi(2)).sum::<f32>().sqrt()
        };
        assert!(model.dynamic.iter().filter(|&&index| moved(index as usize) > 0.01).count() > 50);
        for (camera, view) in room.cameras().unwrap().iter().zip(room.views([64, 48]).unwrap()) {
            assert_eq!(camera.problem(), None);
            let cpu = Cpu::new();
            let drawing = cpu.prepare(&first, &view, &RasterSettings::default()).unwrap().draw().unwrap();
            let filled = drawing.alpha.iter().filter(|&&alpha| alpha > 0.5).count();
            assert!(filled * 10 > drawing.alpha.len() * 9, "{}: {filled} pixels", camera.name);
        }
    }
}
