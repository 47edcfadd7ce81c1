//! `.pth` files: what `torch.save` makes of tensors, and of dicts, lists and tuples of them.
//!
//! Such a file is a zip of a pickle, a program for a small stack machine that can call anything in Python, and of one
//! entry of raw numbers a storage. The machine here knows the 33 opcodes and the few globals that tensors need. It calls
//! nothing: each allowed global has one meaning that is spelled out in this crate, and any other is refused by name,
//! before anything that follows it is read.
//!
//! Memory stays in proportion to the file: storages are slices of it, a value that the pickle shares may be written
//! out again only as far as the pickle is long, and tensors together hold no more numbers than the file has bytes.
//! Existing readers (candle's, burn's) turn what they don't know into opaque values, allow tensors of any size that
//! strides of zero can claim, and don't write; the container is left to a crate.

mod archive;
mod global;
mod machine;
mod node;
mod storage;
mod value;
mod write;

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use crate::checkpoint::fault::{Fault, quoted};
use crate::checkpoint::{MAX_BYTES, REMEDY_NOT_FINITE};
use crate::tensor::Tensor;

pub use value::Value;
pub use write::{Numbers, encode_state_dict, encode_tensor};

/// What to do about a file that this module refuses.
const REMEDY: &str =
    "save the parameters alone, with torch 1.6 or newer: torch.save(model.state_dict(), path)";

/// Reads whatever tensors and plain values a file holds.
pub fn read(path: &Path) -> Result<Value, DataError> {
    decode(&read_bounded(path, MAX_BYTES)?).map_err(|fault| fault.at(path))
}

/// Reads a state dict: finite tensors by name.
pub fn read_state_dict(path: &Path) -> Result<BTreeMap<String, Tensor>, DataError> {
    read(path)?.into_state_dict().map_err(|fault| fault.at(path))
}

/// Reads a single finite tensor.
pub fn read_tensor(path: &Path) -> Result<Tensor, DataError> {
    read(path)?.into_tensor().map_err(|fault| fault.at(path))
}

/// The value in the bytes of a file.
pub fn decode(bytes: &[u8]) -> Result<Value, Fault> {
    let archive = archive::Archive::open(bytes)?;
    let pickle = machine::run(archive.pickle())?;
    value::expand(&pickle, &archive)
}

impl Value {
    /// The finite tensors of a dict with names as keys.
    pub fn into_state_dict(self) -> Result<BTreeMap<String, Tensor>, Fault> {
        let Self::Dict(entries) = self else {
            return Err(Fault::new(
                "top level",
                format!("is {}, but a state dict is a dict", self.kind()),
                REMEDY,
            ));
        };
        let mut tensors = BTreeMap::new();
        for (key, value) in entries {
            let Self::Text(name) = key else {
                return Err(Fault::new(
                    "top level",
                    format!("has {} for a key, but names are strings", key.kind()),
                    REMEDY,
                ));
            };
            let Self::Tensor(tensor) = value else {
                return Err(Fault::new(
                    quoted(&name),
                    format!("is {}, but a state dict holds tensors", value.kind()),
                    REMEDY,
                ));
            };
            check_finite(&quoted(&name), &tensor)?;
            tensors.insert(name, tensor);
        }
        Ok(tensors)
    }

    /// The finite tensor that is the whole value.
    pub fn into_tensor(self) -> Result<Tensor, Fault> {
        let Self::Tensor(tensor) = self else {
            return Err(Fault::new(
                "top level",
                format!("is {}, but a tensor belongs here", self.kind()),
                REMEDY,
            ));
        };
        check_finite("tensor", &tensor)?;
        Ok(tensor)
    }
}

/// Refuses numbers that are not finite, naming the first.
pub(super) fn check_finite(name: &str, tensor: &Tensor) -> Result<(), Fault> {
    match tensor.data.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((index, value)) => Err(Fault::new(
            format!("{name}, number {index}"),
            format!("is {value}, but parameters are finite"),
            REMEDY_NOT_FINITE,
        )),
        None => Ok(()),
    }
}
