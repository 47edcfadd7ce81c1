//! The safetensors of a checkpoint: `gaussians/<field>`, `dynamic`, `deformation/<key>` and `training/<name>`.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::error::inert;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, View};

use super::{Checkpoint, REMEDY};
use crate::checkpoint::fault::{Fault, quoted};
use crate::deform::DeformationField;
use crate::gaussians::{Gaussians, ShDegree};
use crate::tensor::Tensor;

const GAUSSIANS: &str = "gaussians/";
const DYNAMIC: &str = "dynamic";
const DEFORMATION: &str = "deformation/";
const TRAINING: &str = "training/";

/// Bytes of a header: a model's takes about 10 000.
const LONGEST_HEADER: usize = 1 << 20;

type Named = BTreeMap<String, Tensor>;

enum Column<'a> {
    F32(Vec<usize>, &'a [f32]),
    U32(Vec<usize>, &'a [u32]),
}

impl View for Column<'_> {
    fn dtype(&self) -> Dtype {
        match self {
            Self::F32(..) => Dtype::F32,
            Self::U32(..) => Dtype::U32,
        }
    }

    fn shape(&self) -> &[usize] {
        match self {
            Self::F32(shape, _) | Self::U32(shape, _) => shape,
        }
    }

    fn data(&self) -> Cow<'_, [u8]> {
        match self {
            Self::F32(_, values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::U32(_, values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }

    fn data_len(&self) -> usize {
        match self {
            Self::F32(_, values) => size_of_val(*values),
            Self::U32(_, values) => size_of_val(*values),
        }
    }
}

pub(super) fn encode(checkpoint: &Checkpoint) -> Result<Vec<u8>, Fault> {
    let gaussians = &checkpoint.gaussians;
    let (count, coefficients) = (gaussians.len(), gaussians.sh_degree.coefficients());
    let field = checkpoint.field.as_ref().map(DeformationField::tensors).unwrap_or_default();
    let mut columns = vec![
        (DYNAMIC.to_owned(), Column::U32(vec![checkpoint.dynamic.len()], &checkpoint.dynamic)),
        (format!("{GAUSSIANS}means"), Column::F32(vec![count, 3], gaussians.means.as_flattened())),
        (format!("{GAUSSIANS}log_scales"), Column::F32(vec![count, 3], gaussians.log_scales.as_flattened())),
        (format!("{GAUSSIANS}rotations"), Column::F32(vec![count, 4], gaussians.rotations.as_flattened())),
        (format!("{GAUSSIANS}opacity_logits"), Column::F32(vec![count], &gaussians.opacity_logits)),
        (format!("{GAUSSIANS}sh"), Column::F32(vec![count, coefficients, 3], gaussians.sh.as_flattened())),
    ];
    let field = field.iter().map(|entry| (DEFORMATION, entry));
    let training = checkpoint.training.tensors.iter().map(|entry| (TRAINING, entry));
    columns.extend(field.chain(training).map(|(prefix, (name, tensor))| {
        (format!("{prefix}{name}"), Column::F32(tensor.shape.clone(), &tensor.data))
    }));
    safetensors::serialize(columns, None)
        .map_err(|error| Fault::new("tensors", format!("cannot be written: {error}"), REMEDY))
}

/// Tensors of a file that nobody has claimed yet.
pub(super) struct Found<'a>(BTreeMap<String, TensorView<'a>>);

pub(super) fn decode(bytes: &[u8]) -> Result<Found<'_>, Fault> {
    check_header(bytes)?;
    let tensors = SafeTensors::deserialize(bytes).map_err(|error| {
        Fault::new("header", format!("is no safetensors header: {}", inert(&error.to_string())), REMEDY)
    })?;
    Ok(Found(tensors.tensors().into_iter().collect()))
}

/// Holds sizes against the file first: the crate adds up what a header claims, which can go over the largest integer.
fn check_header(bytes: &[u8]) -> Result<(), Fault> {
    let fault = |message: String| Fault::new("header", message, REMEDY);
    let (length, rest) = bytes.split_first_chunk().ok_or_else(|| fault("is cut".to_owned()))?;
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    if length > LONGEST_HEADER {
        return Err(fault(format!("claims {length} bytes, but {LONGEST_HEADER} hold any model's")));
    }
    let (header, data) =
        rest.split_at_checked(length).ok_or_else(|| fault(format!("claims {length} bytes and is cut")))?;
    let entries: serde_json::Map<String, serde_json::Value> = serde_json::from_slice(header)
        .map_err(|error| fault(format!("is no JSON: {}", inert(&error.to_string()))))?;
    for (name, entry) in entries {
        let end = entry.pointer("/data_offsets/1").and_then(serde_json::Value::as_u64);
        if name != "__metadata__" && end.is_none_or(|end| end > data.len() as u64) {
            return Err(Fault::new(
                format!("tensor {}", quoted(&name)),
                "does not lie inside the file",
                REMEDY,
            ));
        }
    }
    Ok(())
}

impl Found<'_> {
    pub(super) fn gaussians(&mut self, count: usize, degree: ShDegree) -> Result<Gaussians, Fault> {
        Ok(Gaussians {
            sh_degree: degree,
            means: rows(self.floats("means", &[count, 3])?),
            log_scales: rows(self.floats("log_scales", &[count, 3])?),
            rotations: rows(self.floats("rotations", &[count, 4])?),
            opacity_logits: self.floats("opacity_logits", &[count])?,
            sh: rows(self.floats("sh", &[count, degree.coefficients(), 3])?),
        })
    }

    pub(super) fn dynamic(&mut self, count: usize) -> Result<Vec<u32>, Fault> {
        let view = self.take(DYNAMIC, Dtype::U32, &[count])?;
        Ok(view.data().as_chunks::<4>().0.iter().map(|&word| u32::from_le_bytes(word)).collect())
    }

    /// The parameters of the field and the state of training; anything else is refused.
    pub(super) fn rest(self) -> Result<(Named, Named), Fault> {
        let (mut field, mut training) = (Named::new(), Named::new());
        for (name, view) in self.0 {
            let fault = |message: &str| Fault::new(format!("tensor {}", quoted(&name)), message, REMEDY);
            if view.dtype() != Dtype::F32 {
                return Err(fault("is not of type F32"));
            }
            let tensor = Tensor { shape: view.shape().to_vec(), data: numbers(view.data()) };
            if let Some(key) = name.strip_prefix(DEFORMATION) {
                field.insert(key.to_owned(), tensor);
            } else if let Some(key) = name.strip_prefix(TRAINING) {
                training.insert(key.to_owned(), tensor);
            } else {
                return Err(fault("is no part of a checkpoint"));
            }
        }
        Ok((field, training))
    }

    fn floats(&mut self, field: &str, shape: &[usize]) -> Result<Vec<f32>, Fault> {
        self.take(&format!("{GAUSSIANS}{field}"), Dtype::F32, shape).map(|view| numbers(view.data()))
    }

    fn take(&mut self, name: &str, dtype: Dtype, shape: &[usize]) -> Result<TensorView<'_>, Fault> {
        let fault = |message: String| Fault::new(format!("tensor `{name}`"), message, REMEDY);
        let view = self.0.remove(name).ok_or_else(|| fault("is missing".to_owned()))?;
        if view.dtype() != dtype || view.shape() != shape {
            let found = format!("{:?} {:?}", view.dtype(), view.shape());
            return Err(fault(format!("is {found}, but checkpoint.json needs {dtype:?} {shape:?}")));
        }
        Ok(view)
    }
}

fn numbers(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|&word| f32::from_le_bytes(word)).collect()
}

fn rows<const N: usize>(numbers: Vec<f32>) -> Vec<[f32; N]> {
    numbers.as_chunks::<N>().0.to_vec()
}
