//! How the field learns and is read.

use serde::{Deserialize, Serialize};

use crate::lift::closed::ClosedSettings;
use crate::lift::error::LiftError;

/// How the two losses are averaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Normalisation {
    /// As the paper writes it: cross-entropy over pixels, divergence over Gaussians and neighbours.
    #[default]
    Paper,
    /// As the code of SA4D and Gaussian Grouping does: the cross-entropy also by ln C, the divergence also by C.
    Code,
}

impl Normalisation {
    const CLASSES: f64 = 2.0;

    /// Factor on the cross-entropy.
    pub(super) fn pixels(self) -> f64 {
        match self {
            Self::Paper => 1.0,
            Self::Code => 1.0 / Self::CLASSES.ln(),
        }
    }

    /// Factor on the divergence.
    pub(super) fn neighbours(self) -> f64 {
        match self {
            Self::Paper => 1.0,
            Self::Code => 1.0 / Self::CLASSES,
        }
    }
}

/// How a field becomes a mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReadOut {
    /// Features are blended, decoded, and the likelier class counts: the paper.
    #[default]
    Decode2d,
    /// Each Gaussian is decoded, those above one half are blended as 1, and pixels are cut at one half.
    Hard3d,
}

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
    /// How losses are averaged.
    pub normalisation: Normalisation,
    /// How masks are read.
    pub read_out: ReadOut,
    /// Share of the derivatives of a step by the logits of Gaussians, signs aside, that may be left out, the smallest
    /// first; 0 for none: then every number is that of the objective. The loss is that of the objective in any case,
    /// and the derivative by a parameter is off by at most this share of their sum times the steepest logit.
    pub left_out: f64,
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
            normalisation: Normalisation::Paper,
            read_out: ReadOut::Decode2d,
            left_out: 0.0,
            seed: 0,
        }
    }

    /// Refuses what cannot be.
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn check(&self) -> Result<(), LiftError> {
        let ranges = [
            ("iterations", f64::from(self.iterations), 0.0..=1e7, "0 to 1e7 steps"),
            ("learning_rate", self.learning_rate, 1e-12..=1e3, "1e-12 to 1e3"),
            ("lambda_2d", self.lambda_2d, 0.0..=1e6, "0 to 1e6"),
            ("lambda_3d", self.lambda_3d, 0.0..=1e6, "0 to 1e6"),
            ("neighbours", f64::from(self.neighbours), 1.0..=64.0, "1 to 64 neighbours"),
            ("width", f64::from(self.width), 1.0..=4096.0, "1 to 4096"),
            ("features", f64::from(self.features), 1.0..=4096.0, "1 to 4096"),
            ("left_out", self.left_out, 0.0..=0.5, "0 to 0.5"),
        ];
        match ranges.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
            Some((field, value, _, remedy)) => Err(LiftError::Setting { field, value, remedy }),
            None => Ok(()),
        }
    }
}

/// Labels first, then a field that learns them: continuous in time and small, without a picture drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DistilSettings {
    /// Where the labels come from.
    pub labels: ClosedSettings,
    /// The field; losses, neighbours and pictures do not matter.
    pub field: FieldSettings,
    /// Gaussians of a step.
    pub rows: u32,
}

impl DistilSettings {
    /// 400 steps of 2000 Gaussians.
    pub fn usual() -> Self {
        let field = FieldSettings {
            iterations: 400,
            learning_rate: 2e-3,
            read_out: ReadOut::Hard3d,
            ..FieldSettings::paper()
        };
        Self { labels: ClosedSettings::robust(), field, rows: 2000 }
    }
}
