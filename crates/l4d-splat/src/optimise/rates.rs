//! The learning rates of 4DGaussians.

use super::error::OptimiseError;
use super::rate::LearningRate;

/// Steps over which rates fall, in the coarse and in the fine stage alike.
const STEPS: u64 = 20_000;
/// Coefficients of direction learn this many times slower than the base colour.
const SH_REST: f32 = 1.0 / 20.0;

/// One rate a group of parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Centres.
    pub means: LearningRate,
    /// Log-scales.
    pub log_scales: LearningRate,
    /// Quaternions.
    pub rotations: LearningRate,
    /// Opacity logits.
    pub opacity_logits: LearningRate,
    /// Spherical harmonics of degree 0; [`sh_pattern`] has the others.
    pub sh: LearningRate,
    /// Layers of the deformation field.
    pub layers: LearningRate,
    /// Planes of the deformation field.
    pub planes: LearningRate,
}

impl Rates {
    /// Rates for multi-camera video. `extent_m` is the radius of the cameras about their centre, times 1.1: what
    /// moves through space learns in proportion.
    ///
    /// # Errors
    /// An extent that is not positive and finite.
    pub fn of_4d_gaussians(extent_m: f64) -> Result<Self, OptimiseError> {
        let falling =
            |first: f64, last: f64| LearningRate::log_linear(first * extent_m, last * extent_m, STEPS);
        Ok(Self {
            means: falling(1.6e-4, 1.6e-6)?,
            log_scales: LearningRate::constant(5.0e-3)?,
            rotations: LearningRate::constant(1.0e-3)?,
            opacity_logits: LearningRate::constant(5.0e-2)?,
            sh: LearningRate::constant(2.5e-3)?,
            layers: falling(1.6e-4, 1.6e-5)?,
            planes: falling(1.6e-3, 1.6e-4)?,
        })
    }
}

/// Factors on the rate of each number of a Gaussian's spherical harmonics (coefficient, then channel).
pub fn sh_pattern(coefficients: usize) -> Vec<f32> {
    (0..3 * coefficients).map(|place| if place < 3 { 1.0 } else { SH_REST }).collect()
}
