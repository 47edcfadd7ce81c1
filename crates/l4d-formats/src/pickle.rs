//! `.pth` files: what `torch.save` makes of tensors, and of dicts, lists and tuples of them.
//!
//! Such a file is a zip of a pickle, a program for a small stack machine that can call anything in Python, and of one
//! entry of raw numbers per storage. The machine here knows the 33 opcodes and the few globals that tensors need. It
//! calls nothing: each allowed global has one meaning that is spelled out in this crate, and any other is refused by
//! name, before anything that follows it is read.
//!
//! Memory stays in proportion to the file: storages are slices of it, a value that the pickle shares may be written
//! out again only as far as the pickle is long, and tensors together hold no more numbers than the file has bytes.
//! Existing readers (candle's, burn's) turn what they don't know into opaque values and allow tensors of any size that
//! strides of zero can claim; the container is left to a crate.

mod global;
mod machine;
mod node;
mod storage;
mod tensors;
mod value;

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use crate::fault::{Fault, quoted};
use crate::tensor::Tensor;
use crate::zip::Archive;

pub use value::Value;

/// No such file is larger, bytes: a thousand times what a model of this project needs.
const MAX_BYTES: u64 = 8 << 30;
/// Bytes of a pickle: names and shapes of a model's tensors take about 10 000.
const LONGEST_PICKLE: usize = 1 << 20;
/// First bytes of what torch wrote before version 1.6.
const OLD_TORCH: &[u8] = b"\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";

/// What to do about a file that this module refuses.
const REMEDY: &str =
    "save the parameters alone, with torch 1.6 or newer: torch.save(model.state_dict(), path)";

/// Reads whatever tensors and plain values a file holds.
///
/// # Errors
/// As [`decode`], and a file that cannot be read.
pub fn read(path: &Path) -> Result<Value, DataError> {
    decode(&read_bounded(path, MAX_BYTES)?).map_err(|fault| fault.at(path))
}

/// Reads a state dict: finite tensors by name.
///
/// # Errors
/// As [`read`], and other values.
pub fn read_state_dict(path: &Path) -> Result<BTreeMap<String, Tensor>, DataError> {
    read(path)?.into_state_dict().map_err(|fault| fault.at(path))
}

/// Reads a single finite tensor.
///
/// # Errors
/// As [`read`], and other values.
pub fn read_tensor(path: &Path) -> Result<Tensor, DataError> {
    read(path)?.into_tensor().map_err(|fault| fault.at(path))
}

/// The value in the bytes of a file.
///
/// # Errors
/// Anything but tensors and plain values, and a file that claims more than it holds.
pub fn decode(bytes: &[u8]) -> Result<Value, Fault> {
    if bytes.starts_with(OLD_TORCH) {
        return Err(Fault::new("first bytes", "are those of a torch older than 1.6", REMEDY));
    }
    let archive = Archive::open(bytes)?;
    let refuse = |message: &str| Err(Fault::new("archive", message, REMEDY));
    if archive.names().any(|name| name.contains("/code/") || name.ends_with("/constants.pkl")) {
        return refuse("is a TorchScript program, not a dict of tensors");
    }
    let mut roots = archive.names().filter_map(|name| name.strip_suffix("data.pkl"));
    let root = match (roots.next(), roots.next()) {
        (Some(root), None) => root.to_owned(),
        (None, _) => return refuse("has no entry `data.pkl`, so torch did not write it"),
        (Some(_), Some(_)) => return refuse("has more than one entry `data.pkl`"),
    };
    let program = archive.stored(&format!("{root}data.pkl"), true)?;
    if program.len() > LONGEST_PICKLE {
        let message = format!(
            "has {} bytes, but the names and shapes of tensors fit into {LONGEST_PICKLE}",
            program.len()
        );
        return Err(Fault::new("entry `data.pkl`", message, REMEDY));
    }
    let order = format!("{root}byteorder");
    if archive.names().any(|name| name == order) && archive.stored(&order, true)? != b"little" {
        let remedy = "save the file on a little-endian machine";
        return Err(Fault::new("entry `byteorder`", "is not `little`", remedy));
    }
    value::expand(&machine::run(program)?, &archive, &root, bytes.len())
}

impl Value {
    /// The finite tensors of a dict with names as keys.
    ///
    /// # Errors
    /// Other values, and numbers that are not finite.
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
            tensor.check_finite(&quoted(&name))?;
            tensors.insert(name, tensor);
        }
        Ok(tensors)
    }

    /// The finite tensor that is the whole value.
    ///
    /// # Errors
    /// Other values, and numbers that are not finite.
    pub fn into_tensor(self) -> Result<Tensor, Fault> {
        let Self::Tensor(tensor) = self else {
            return Err(Fault::new(
                "top level",
                format!("is {}, but a tensor belongs here", self.kind()),
                REMEDY,
            ));
        };
        tensor.check_finite("tensor")?;
        Ok(tensor)
    }
}
