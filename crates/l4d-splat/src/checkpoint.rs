//! How a model reaches a disk and comes back.
//!
//! Three families of files: our own checkpoint ([`own`]), the model folders of 4DGaussians ([`foreign`]), and the bare
//! PLY of 3D Gaussians ([`ply`]). All numbers are raw, before any activation; `docs/splats.md` is the reference of the
//! formats.

pub mod cfg_args;
pub mod foreign;
pub mod own;
pub mod ply;

use std::collections::BTreeMap;

use crate::deform::{DeformConfig, DeformError, DeformationField};
use crate::gaussians::Gaussians;

pub use l4d_formats::Fault;
use l4d_formats::Tensor;
use l4d_formats::fault::quoted;
use l4d_formats::tensor::REMEDY_NOT_FINITE;

/// No file of a checkpoint is larger, bytes: a thousand times what a model of this project needs.
pub const MAX_BYTES: u64 = 8 << 30;

/// The field with these sizes whose parameters are `tensors`; others may are beside them.
///
/// Shapes come first: a field makes room for what its configuration says, and that came from a file too.
fn build_field(config: DeformConfig, tensors: &BTreeMap<String, Tensor>) -> Result<DeformationField, Fault> {
    let broken = |error: DeformError| Fault::new("deformation field", error.to_string(), REMEDY_PAIR);
    config.validate().map_err(broken)?;
    let shapes: BTreeMap<String, Vec<usize>> = foreign::keys::field_shapes(&config).into_iter().collect();
    for (name, shape) in &shapes {
        let fault = |message: String| Fault::new(format!("parameter `{name}`"), message, REMEDY_PAIR);
        let tensor = tensors.get(name).ok_or_else(|| fault("is missing".to_owned()))?;
        if tensor.shape != *shape {
            return Err(fault(format!(
                "has the shape {:?}, but the configuration needs {shape:?}",
                tensor.shape
            )));
        }
    }
    let unknown = |name: &&String| name.starts_with(foreign::keys::PREFIX) && !shapes.contains_key(*name);
    if let Some(name) = tensors.keys().find(unknown) {
        let message = "is no part of a field with this configuration";
        return Err(Fault::new(format!("parameter {}", quoted(name)), message, REMEDY_PAIR));
    }
    DeformationField::from_tensors(config, |name| tensors.get(name)).map_err(broken)
}

const REMEDY_PAIR: &str = "take configuration and parameters from the same training run";

/// Refuses Gaussians whose lists have different lengths or hold a value that is not finite.
fn check_gaussians(gaussians: &Gaussians) -> Result<(), Fault> {
    let count = gaussians.len();
    let lists = [
        ("log_scales", gaussians.log_scales.len(), count),
        ("rotations", gaussians.rotations.len(), count),
        ("opacity_logits", gaussians.opacity_logits.len(), count),
        ("sh", gaussians.sh.len(), count * gaussians.sh_degree.coefficients()),
    ];
    if let Some((field, found, expected)) = lists.iter().find(|(_, found, expected)| found != expected) {
        return Err(Fault::new(
            format!("field `{field}`"),
            format!("has {found} entries, but {count} Gaussians need {expected}"),
            "keep all lists of a model the same length",
        ));
    }
    match gaussians.bad_value() {
        Some(bad) => Err(Fault::new(
            format!("Gaussian {}, field `{}`", bad.index, bad.field),
            format!("is {}, but parameters are finite", bad.value),
            REMEDY_NOT_FINITE,
        )),
        None => Ok(()),
    }
}
