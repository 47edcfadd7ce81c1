//! The temporal identity field (paper, section 4, equations 2 to 6; after SA4D).
//!
//! e = phi(gamma(X), gamma(t)) for each Gaussian, E = sum over Gaussians of e a T in each pixel, f = softmax of a 1x1
//! convolution of E over C = 2 classes; cross-entropy on the masks and a KL divergence that holds neighbours in the
//! deformed space together.
//!
//! The same numbers are reached by a shorter way than they are written down (docs/panopticquery.md lists the
//! savings): a convolution commutes with a blend and two classes need one number, the difference of their logits, so
//! that one channel is drawn and not 32; the last layer and the convolution are one vector; phi is evaluated once an
//! iteration, for the Gaussians that the picture or the neighbourhoods need; neighbours are found once a time. The tests
//! write the objective down as the paper does.

mod encoding;
mod learn;
mod network;
mod objective;
#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::error::{LiftError, check_ranges};

pub(super) use learn::learn;
pub use network::Network;

/// The faithful field. Defaults are those of the paper's implementation details and SA4D's network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldSettings {
    /// Steps of Adam.
    pub iterations: u32,
    /// Rate of Adam, for the network and the decoder.
    pub learning_rate: f64,
    /// Weight of the cross-entropy (lambda of L_2d).
    pub lambda_2d: f64,
    /// Weight of the divergence (lambda of L_3d).
    pub lambda_3d: f64,
    /// Gaussians of which the neighbours are compared in each step (m).
    pub sampled: u32,
    /// Neighbours of each, itself among them as in SA4D's code (k).
    pub neighbours: u32,
    /// Width of the three hidden layers.
    pub width: u32,
    /// Numbers of an identity feature.
    pub features: u32,
    /// Seed of the parameters, the order of pictures and the samples.
    pub seed: u64,
}

impl FieldSettings {
    /// As the paper.
    pub fn paper() -> Self {
        Self {
            iterations: 2000,
            learning_rate: 5e-4,
            lambda_2d: 1.0,
            lambda_3d: 2.0,
            sampled: 1000,
            neighbours: 5,
            width: 256,
            features: 32,
            seed: 0,
        }
    }

    fn check(&self) -> Result<(), LiftError> {
        check_ranges([
            ("iterations", f64::from(self.iterations), 0.0..=1e7, "0 to 1e7 steps"),
            ("learning_rate", self.learning_rate, 1e-12..=1e3, "1e-12 to 1e3"),
            ("lambda_2d", self.lambda_2d, 0.0..=1e6, "0 to 1e6"),
            ("lambda_3d", self.lambda_3d, 0.0..=1e6, "0 to 1e6"),
            ("neighbours", f64::from(self.neighbours), 1.0..=64.0, "1 to 64 neighbours"),
            ("width", f64::from(self.width), 1.0..=4096.0, "1 to 4096"),
            ("features", f64::from(self.features), 1.0..=4096.0, "1 to 4096"),
        ])
    }
}
