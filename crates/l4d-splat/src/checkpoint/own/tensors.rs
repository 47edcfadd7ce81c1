//! The tensors of a checkpoint: `gaussians/<field>`, `dynamic`, `deformation/<key>` and `training/<name>`.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_formats::tensor_file::{Column, Found};
use l4d_formats::{Fault, Tensor};

use crate::gaussians::{Gaussians, ShDegree};

use super::Checkpoint;

const GAUSSIANS: &str = "gaussians/";
const DYNAMIC: &str = "dynamic";
pub(super) const DEFORMATION: &str = "deformation/";
pub(super) const TRAINING: &str = "training/";

/// Everything but the parameters of the field.
pub(super) fn columns(checkpoint: &Checkpoint) -> Vec<(String, Column<'_>)> {
    let gaussians = &checkpoint.gaussians;
    let (count, coefficients) = (gaussians.len(), gaussians.sh_degree.coefficients());
    let fraction = |field: &str, shape: &[usize], values| {
        (format!("{GAUSSIANS}{field}"), Column::F32(shape.to_vec(), Cow::Borrowed(values)))
    };
    let dynamic = Column::U32(vec![checkpoint.dynamic.len()], Cow::Borrowed(&checkpoint.dynamic));
    let mut columns = vec![
        (DYNAMIC.to_owned(), dynamic),
        fraction("means", &[count, 3], gaussians.means.as_flattened()),
        fraction("log_scales", &[count, 3], gaussians.log_scales.as_flattened()),
        fraction("rotations", &[count, 4], gaussians.rotations.as_flattened()),
        fraction("opacity_logits", &[count], &gaussians.opacity_logits),
        fraction("sh", &[count, coefficients, 3], gaussians.sh.as_flattened()),
    ];
    columns.extend(named(TRAINING, &checkpoint.training.tensors));
    columns
}

/// Tensors below a prefix.
pub(super) fn named<'a>(
    prefix: &'a str,
    tensors: &'a BTreeMap<String, Tensor>,
) -> impl Iterator<Item = (String, Column<'a>)> {
    tensors.iter().map(move |(name, tensor)| {
        (format!("{prefix}{name}"), Column::F32(tensor.shape.clone(), Cow::Borrowed(&tensor.data)))
    })
}

pub(super) fn gaussians(found: &mut Found<'_>, count: usize, degree: ShDegree) -> Result<Gaussians, Fault> {
    let mut floats = |field: &str, shape: &[usize]| found.f32(&format!("{GAUSSIANS}{field}"), shape);
    Ok(Gaussians {
        sh_degree: degree,
        means: rows(floats("means", &[count, 3])?),
        log_scales: rows(floats("log_scales", &[count, 3])?),
        rotations: rows(floats("rotations", &[count, 4])?),
        opacity_logits: floats("opacity_logits", &[count])?,
        sh: rows(floats("sh", &[count, degree.coefficients(), 3])?),
    })
}

pub(super) fn dynamic(found: &mut Found<'_>, count: usize) -> Result<Vec<u32>, Fault> {
    found.u32(DYNAMIC, &[count])
}

fn rows<const N: usize>(numbers: Vec<f32>) -> Vec<[f32; N]> {
    numbers.as_chunks::<N>().0.to_vec()
}
