//! A learning rate for each group of parameters.

use super::rate::LearningRate;

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

/// Factors on the rate of each number of a Gaussian's spherical harmonics (coefficient, then channel).
pub fn sh_pattern(coefficients: usize) -> Vec<f32> {
    (0..3 * coefficients).map(|place| if place < 3 { 1.0 } else { SH_REST }).collect()
}
