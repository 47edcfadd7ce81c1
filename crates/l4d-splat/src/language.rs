//! Language features of 4D LangSplat: latents that Gaussians carry, blended like colours.
//!
//! Owns what they are at a time. What a latent means, a decoder outside of the model knows.

mod drift;

use std::collections::BTreeMap;

use l4d_formats::{Fault, Tensor};

use self::drift::Drift;
use crate::checkpoint::build_field;
use crate::deform::{DeformConfig, DeformError, DeformationField, PREFIX};

const HINT: &str = "take all files of a save from the same run of 4D LangSplat";
/// Keeps zero from being divided by zero, as the original does.
const LEAST_NORM: f32 = 1e-9;
/// Numbers that the head has room for which a field keeps for harmonics.
const MOST_STATES: usize = 48;

/// Latents of all Gaussians of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Language {
    /// Numbers of a latent.
    pub width: usize,
    /// Of unit length, one a Gaussian; or one for each state, then as long as the number of states.
    latents: Vec<f32>,
    change: Change,
}

/// How latents change with time.
#[derive(Debug, Clone, PartialEq)]
enum Change {
    None,
    /// How much of each state there is at a time: the first harmonics of what this field adds.
    States(Box<DeformationField>),
    /// What is added to the latents at a time.
    Drift(Drift),
}

impl Language {
    /// Latents that stay the same: columns `f_lang_*` of a save.
    pub(crate) fn constant(mut columns: Vec<f32>, width: usize) -> Self {
        columns.chunks_mut(width).for_each(normalise);
        Self { width, latents: columns, change: Change::None }
    }

    /// Latents that the layers `lang_deform` change: columns `f_lang_*` of a save, and the parameters of the model.
    pub(crate) fn drifting(
        columns: Vec<f32>,
        width: usize,
        tensors: &BTreeMap<String, Tensor>,
    ) -> Result<Self, Fault> {
        let change = Change::Drift(Drift::new(width, tensors)?);
        Ok(Self { change, ..Self::constant(columns, width) })
    }

    /// Latents between states: `config` and `tensors` are those of the model's field.
    pub(crate) fn between_states(
        mut columns: Vec<f32>,
        total: usize,
        config: &DeformConfig,
        tensors: &BTreeMap<String, Tensor>,
    ) -> Result<Self, Fault> {
        let name = |part: &str| format!("{PREFIX}discrete_coff_generator.{part}");
        let part = |part: &str| {
            tensors.get(&name(part)).cloned().ok_or_else(|| Fault::new(name(part), "is missing", HINT))
        };
        let count = part("3.bias")?.data.len();
        if count == 0 || count > MOST_STATES || total == 0 || !total.is_multiple_of(count) {
            let message = format!("has {count} states for {total} columns `f_lang_*`");
            return Err(Fault::new(name("3.bias"), message, HINT));
        }
        // The generator is built like a head of the field, so that the field computes it in place of its last one.
        let mut tensors: BTreeMap<_, _> = tensors
            .iter()
            .filter(|(name, _)| !is_language(name))
            .map(|(name, tensor)| (name.clone(), tensor.clone()))
            .collect();
        for list in ["1.weight", "1.bias", "3.weight", "3.bias"] {
            let mut tensor = part(list)?;
            if list.starts_with('3') {
                let rows = tensor.shape.first_mut().filter(|rows| **rows == count);
                let rows =
                    rows.ok_or_else(|| Fault::new(name(list), format!("has not {count} rows"), HINT))?;
                *rows = MOST_STATES;
                tensor.data.resize(tensor.data.len() / count * MOST_STATES, 0.0);
            }
            tensors.insert(format!("{PREFIX}shs_deform.{list}"), tensor);
        }
        let config = DeformConfig {
            no_dx: true,
            no_ds: true,
            no_dr: true,
            no_do: true,
            no_dshs: false,
            sh_coefficients: MOST_STATES / 3,
            ..config.clone()
        };
        let change = Change::States(Box::new(build_field(config, &tensors)?));
        let width = total / count;
        // All states of a Gaussian together first, as the original does before it takes them apart.
        columns.chunks_mut(total).for_each(normalise);
        columns.chunks_mut(width).for_each(normalise);
        Ok(Self { width, latents: columns, change })
    }

    /// The latents at a time that the field knows, one a Gaussian.
    ///
    /// # Errors
    /// A time outside of 0 to 1.
    pub fn at(&self, means: &[[f32; 3]], time: f32) -> Result<Vec<f32>, DeformError> {
        let states = match &self.change {
            Change::None => return Ok(self.latents.clone()),
            Change::States(states) => states,
            Change::Drift(drift) => {
                let mut latents = drift.at(&self.latents, self.width, time);
                latents.iter_mut().zip(&self.latents).for_each(|(sum, latent)| *sum += latent);
                latents.chunks_mut(self.width).for_each(normalise);
                return Ok(latents);
            }
        };
        let shares = states.offsets(means, time)?.sh;
        let shares = shares.as_flattened().chunks(MOST_STATES);
        let total = self.latents.len() / means.len().max(1);
        let latent = |(shares, latents): (&[f32], &[f32])| {
            let mut sum = vec![0.0; self.width];
            for (share, latent) in shares.iter().zip(latents.chunks(self.width)) {
                sum.iter_mut().zip(latent).for_each(|(sum, value)| *sum += share * value);
            }
            normalise(&mut sum);
            sum
        };
        Ok(shares.zip(self.latents.chunks(total.max(1))).flat_map(latent).collect())
    }
}

/// Whether a parameter of a field is about language.
pub(crate) fn is_language(name: &str) -> bool {
    let name = name.strip_prefix(PREFIX).unwrap_or_default();
    name.starts_with("lang_deform.") || name.starts_with("discrete_coff_generator.")
}

fn normalise(latent: &mut [f32]) {
    let norm = latent.iter().map(|value| value * value).sum::<f32>().sqrt() + LEAST_NORM;
    latent.iter_mut().for_each(|value| *value /= norm);
}
