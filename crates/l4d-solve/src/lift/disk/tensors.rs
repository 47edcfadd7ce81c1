//! The safetensors of an answer. Knows types, shapes and that numbers are finite; not what they mean.

use std::borrow::Cow;
use std::collections::BTreeMap;

use l4d_data::error::inert;
use safetensors::tensor::{Dtype, SafeTensors, TensorView, View};

/// Bytes of a header: that of an answer takes about a thousand.
const LONGEST_HEADER: usize = 1 << 16;

/// Numbers with a shape.
pub(super) enum Column {
    F32(Vec<usize>, Vec<f32>),
    U32(Vec<usize>, Vec<u32>),
}

impl View for Column {
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
            Self::F32(_, values) => size_of_val(values.as_slice()),
            Self::U32(_, values) => size_of_val(values.as_slice()),
        }
    }
}

/// The bytes of a file.
pub(super) fn encode(columns: Vec<(String, Column)>) -> Result<Vec<u8>, String> {
    safetensors::serialize(columns, None).map_err(|error| format!("cannot be written: {error}"))
}

/// Tensors of a file that nobody has claimed yet.
pub(super) struct Found<'a>(BTreeMap<String, TensorView<'a>>);

impl<'a> Found<'a> {
    /// Those of these bytes.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, String> {
        check_header(bytes)?;
        let tensors = SafeTensors::deserialize(bytes)
            .map_err(|error| format!("the header is none: {}", inert(&error.to_string())))?;
        Ok(Self(tensors.tensors().into_iter().collect()))
    }

    pub(super) fn f32(&mut self, name: &str, shape: &[usize]) -> Result<Vec<f32>, String> {
        let view = self.take(name, Dtype::F32, shape)?;
        let numbers: Vec<f32> =
            view.data().as_chunks().0.iter().map(|&word| f32::from_le_bytes(word)).collect();
        match numbers.iter().position(|number| !number.is_finite()) {
            Some(index) => Err(format!("`{name}`: number {index} is {}", numbers[index])),
            None => Ok(numbers),
        }
    }

    pub(super) fn u32(&mut self, name: &str, shape: &[usize]) -> Result<Vec<u32>, String> {
        let view = self.take(name, Dtype::U32, shape)?;
        Ok(view.data().as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)).collect())
    }

    /// Refuses what nobody claimed.
    pub(super) fn finish(self) -> Result<(), String> {
        match self.0.keys().next() {
            Some(name) => Err(format!("`{}` is no part of an answer", inert(name))),
            None => Ok(()),
        }
    }

    fn take(&mut self, name: &str, dtype: Dtype, shape: &[usize]) -> Result<TensorView<'a>, String> {
        let view = self.0.remove(name).ok_or_else(|| format!("`{name}` is missing"))?;
        if view.dtype() != dtype || view.shape() != shape {
            let found = format!("{:?} {:?}", view.dtype(), view.shape());
            return Err(format!("`{name}` is {found}, but lift.json needs {dtype:?} {shape:?}"));
        }
        Ok(view)
    }
}

/// Holds sizes against the file first: the crate adds up what a header claims, which can go over the largest integer.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let (length, rest) = bytes.split_first_chunk().ok_or("the header is cut")?;
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
    if length > LONGEST_HEADER {
        return Err(format!("the header claims {length} bytes, but {LONGEST_HEADER} hold any answer's"));
    }
    let (header, data) = rest.split_at_checked(length).ok_or("the header is cut")?;
    let entries: serde_json::Map<String, serde_json::Value> =
        serde_json::from_slice(header).map_err(|error| format!("the header is no JSON: {error}"))?;
    let ends_inside = |entry: &serde_json::Value| {
        let end = entry.pointer("/data_offsets/1").and_then(serde_json::Value::as_u64);
        end.is_some_and(|end| end <= data.len() as u64)
    };
    match entries.iter().find(|(name, entry)| *name != "__metadata__" && !ends_inside(entry)) {
        Some((name, _)) => Err(format!("`{}` does not lie inside the file", inert(name))),
        None => Ok(()),
    }
}
