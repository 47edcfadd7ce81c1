//! How a model reaches a disk and comes back.
//!
//! Four families of files: our own checkpoint ([`own`]), the models of 4DGaussians ([`foreign`]), the bare PLY of 3D
//! Gaussians ([`ply`]), and what trainers keep with `torch.save` ([`torch`]). Their numbers are raw, before any
//! activation. [`usd`] is written only, and holds what is drawn. `docs/splats.md` is the reference of the formats.

pub mod foreign;
pub mod own;
pub mod ply;
pub(crate) mod torch;
pub mod usd;

use std::collections::BTreeMap;

use crate::deform::{DeformConfig, DeformationField};
use crate::gaussians::{FIELDS, Gaussians};

pub use l4d_formats::Fault;
use l4d_formats::Tensor;
use l4d_formats::tensor::HINT_NOT_FINITE;

/// No file of a checkpoint is larger, bytes: a thousand times what a model of this project needs.
pub const MAX_BYTES: u64 = 8 << 30;

/// The field with these sizes whose parameters are `tensors`; others may be beside them.
pub(crate) fn build_field(
    config: DeformConfig,
    tensors: &BTreeMap<String, Tensor>,
) -> Result<DeformationField, Fault> {
    DeformationField::from_tensors(config, tensors)
        .map_err(|error| Fault::new("deformation field", error.to_string(), HINT_PAIR))
}

const HINT_PAIR: &str = "take configuration and parameters from the same training run";

/// Refuses Gaussians whose lists have different lengths or hold a value that is not finite.
fn check_gaussians(gaussians: &Gaussians) -> Result<(), Fault> {
    if let Some((list, found, expected)) = gaussians.sh_degree.wrong_length(gaussians.lengths()) {
        return Err(Fault::new(
            format!("field `{}`", FIELDS[list]),
            format!("has {found} entries, but {} Gaussians need {expected}", gaussians.len()),
            "keep all lists of a model the same length",
        ));
    }
    match gaussians.bad_value() {
        Some(bad) => Err(Fault::new(
            format!("Gaussian {}, field `{}`", bad.index, bad.field),
            format!("is {}, but parameters are finite", bad.value),
            HINT_NOT_FINITE,
        )),
        None => Ok(()),
    }
}
