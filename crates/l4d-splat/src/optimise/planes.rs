//! What keeps the planes of a deformation field smooth where no Gaussian says what they should be.
//!
//! The three terms of 4DGaussians. Second differences are taken along the slower axis of a plane alone: time, where
//! the plane has it, and y, z, z of the planes (x,y), (x,z), (y,z).

use rayon::prelude::*;

use crate::deform::{DeformationField, FieldGradients, Plane};

use super::{OptimiseError, check};

/// How much each term counts. Values of 4DGaussians for multi-camera video are the default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneWeights {
    /// Second differences of planes in space ("total variation").
    pub space: f32,
    /// Second differences along time.
    pub time: f32,
    /// Distance of planes in time from 1, where they change nothing.
    pub stillness: f32,
}

impl Default for PlaneWeights {
    fn default() -> Self {
        Self { space: 2.0e-4, time: 1.0e-3, stillness: 1.0e-4 }
    }
}

impl PlaneWeights {
    /// All weights, multiplied.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        Self { space: factor * self.space, time: factor * self.time, stillness: factor * self.stillness }
    }
}

/// Adds the weighted gradient of the penalty on a field's planes to `gradients`. The penalty is a sum over planes of
/// means over texels and channels.
///
/// # Errors
/// Texels that are not finite; gradients of another field.
pub fn plane_penalty(
    field: &DeformationField,
    weights: &PlaneWeights,
    gradients: &mut FieldGradients,
) -> Result<(), OptimiseError> {
    let planes: Vec<&Plane> = field.planes().collect();
    let mut into: Vec<&mut Plane> = gradients.planes_mut().collect();
    if planes.len() != into.len() || planes.iter().zip(&into).any(|(a, b)| a.texels.len() != b.texels.len()) {
        return Err(OptimiseError("the gradient of the planes is that of another field".to_owned()));
    }
    for (index, plane) in planes.iter().enumerate() {
        check(&plane.texels, || format!("plane {} of level {}", index % 6, index / 6))?;
    }
    planes.par_iter().zip(&mut into).for_each(|(plane, gradient)| {
        bend(plane, if plane.has_time { weights.time } else { weights.space }, &mut gradient.texels);
        if plane.has_time {
            deviation(plane, weights.stillness, &mut gradient.texels);
        }
    });
    Ok(())
}

/// By the mean squared second difference along the rows of texels; 0 where there are fewer than three.
fn bend(plane: &Plane, weight: f32, gradient: &mut [f32]) {
    let row = plane.columns * plane.channels;
    let count = (row * plane.rows.saturating_sub(2)).max(1) as f64;
    let step = (2.0 * f64::from(weight) / count) as f32;
    let mut second = vec![0.0; row];
    for start in (0..plane.texels.len().saturating_sub(2 * row)).step_by(row) {
        let three: [&[f32]; 3] = std::array::from_fn(|line| &plane.texels[start + line * row..][..row]);
        for (((second, a), b), c) in second.iter_mut().zip(three[0]).zip(three[1]).zip(three[2]) {
            *second = a - 2.0 * b + c;
        }
        for (line, share) in [1.0, -2.0, 1.0].into_iter().enumerate() {
            for (gradient, second) in gradient[start + line * row..][..row].iter_mut().zip(&second) {
                *gradient += share * step * second;
            }
        }
    }
}

/// By the mean absolute difference from 1.
fn deviation(plane: &Plane, weight: f32, gradient: &mut [f32]) {
    let step = (f64::from(weight) / plane.texels.len().max(1) as f64) as f32;
    for (gradient, &texel) in gradient.iter_mut().zip(&plane.texels) {
        *gradient += match texel - 1.0 {
            0.0 => 0.0,
            above if above > 0.0 => step,
            _ => -step,
        };
    }
}
