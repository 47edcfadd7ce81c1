//! Which model an answer belongs to.

use l4d_data::digest::RunningDigest;
use l4d_splat::Model;
use serde::{Deserialize, Serialize};

use super::error::LiftError;

/// What tells a model from all others: an answer is a list of its Gaussians and means nothing for another one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDigest {
    /// Number of Gaussians.
    pub gaussians: usize,
    /// SHA-256 of all numbers of the model, little-endian, in the order of its fields.
    pub sha256: String,
}

impl ModelDigest {
    /// Of a model.
    pub fn of(model: &Model) -> Self {
        let mut digest = RunningDigest::default();
        let mut add = |numbers: &[f32]| {
            digest.add(&(numbers.len() as u64).to_le_bytes());
            let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
            digest.add(&bytes);
        };
        let gaussians = &model.gaussians;
        add(gaussians.means.as_flattened());
        add(gaussians.log_scales.as_flattened());
        add(gaussians.rotations.as_flattened());
        add(&gaussians.opacity_logits);
        add(gaussians.sh.as_flattened());
        if let Some(field) = &model.field {
            for tensor in field.tensors().values() {
                add(&tensor.data);
            }
        }
        let moving: Vec<u8> = model.dynamic.iter().flat_map(|index| index.to_le_bytes()).collect();
        digest.add(&moving);
        Self { gaussians: gaussians.len(), sha256: digest.hex() }
    }

    /// Refuses another model.
    pub(super) fn check(&self, model: &Model) -> Result<(), LiftError> {
        let found = Self::of(model);
        if found == *self {
            return Ok(());
        }
        let short = |digest: &str| digest.chars().take(12).collect();
        Err(LiftError::OtherModel {
            answered: self.gaussians,
            wanted: short(&self.sha256),
            found: found.gaussians,
            digest: short(&found.sha256),
        })
    }
}
