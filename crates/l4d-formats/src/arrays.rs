//! Arrays of numbers in `.npy`, `.npz`, `.pt` and `.pth` files.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use crate::npy::{self, Array, Contents, REMEDY};
use crate::npz::Npz;
use crate::pickle::{self, Value};

/// No file of arrays is larger: latents of 8 channels at 4K fit.
pub const MAX_BYTES: u64 = 512 << 20;

impl Array {
    /// Where the first number that is not finite is, and what it is.
    pub fn bad_value(&self) -> Option<(usize, f32)> {
        self.data.iter().copied().enumerate().find(|(_, value)| !value.is_finite())
    }
}

/// Reads the array in a file, or the one called `key` of a file with several.
///
/// # Errors
/// Files that cannot be opened, and everything that is no plain array of numbers.
pub fn read(path: &Path, key: Option<&str>) -> Result<Array, DataError> {
    match read_contents(path, key)? {
        Contents::Numbers(array) => Ok(array),
        Contents::Text(_) => Err(DataError::invalid(path, "dtype", "is text where numbers belong", REMEDY)),
    }
}

/// Reads numbers or texts.
///
/// # Errors
/// As [`read`].
pub fn read_contents(path: &Path, key: Option<&str>) -> Result<Contents, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    match extension(path).as_str() {
        "npy" => npy::decode(&bytes).map_err(|fault| fault.at(path)),
        "npz" => {
            let archive = Npz::open(&bytes).map_err(|fault| fault.at(path))?;
            let name = choose(path, &archive.names(), key)?;
            archive.read(&name).map_err(|fault| fault.at(path))
        }
        "pt" | "pth" => {
            let value = pickle::decode(&bytes).map_err(|fault| fault.at(path))?;
            from_pickle(path, value, key).map(Contents::Numbers)
        }
        other => Err(DataError::invalid(
            path,
            "name",
            format!("ends with `.{other}`, but arrays are in .npy, .npz, .pt or .pth files"),
            "name the file as its format is called",
        )),
    }
}

/// Names of the arrays in an `.npz`, sorted.
///
/// # Errors
/// A file that is no such archive.
pub fn names(path: &Path) -> Result<Vec<String>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let archive = Npz::open(&bytes).map_err(|fault| fault.at(path))?;
    Ok(archive.names())
}

/// The end of a file's name, in lower case.
pub fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

fn choose(path: &Path, names: &[String], key: Option<&str>) -> Result<String, DataError> {
    let found = match key {
        Some(key) => names.iter().find(|name| *name == key),
        None if names.len() == 1 => names.first(),
        None => None,
    };
    found.cloned().ok_or_else(|| {
        let message = match key {
            Some(key) => format!("has no array `{key}`"),
            None => format!("has {} arrays, and nothing says which is meant", names.len()),
        };
        let known: Vec<&str> = names.iter().take(20).map(String::as_str).collect();
        let remedy = format!("choose one of: {}", l4d_data::error::inert(&known.join(", ")));
        DataError::invalid(path, "archive", message, remedy)
    })
}

fn from_pickle(path: &Path, value: Value, key: Option<&str>) -> Result<Array, DataError> {
    let tensor = match value {
        Value::Tensor(tensor) => tensor,
        Value::Dict(entries) => {
            let mut tensors = Vec::new();
            for (name, value) in entries {
                if let (Value::Text(name), Value::Tensor(tensor)) = (name, value) {
                    tensors.push((name, tensor));
                }
            }
            let names: Vec<String> = tensors.iter().map(|(name, _)| name.clone()).collect();
            let name = choose(path, &names, key)?;
            let found = tensors.into_iter().find(|(other, _)| *other == name);
            found.map(|(_, tensor)| tensor).unwrap_or_default()
        }
        other => {
            let message = format!("holds {}, but a tensor or a dict of tensors belongs here", other.kind());
            return Err(DataError::invalid(
                path,
                "top level",
                message,
                "save the tensor alone: torch.save(mask, path)",
            ));
        }
    };
    Ok(Array { shape: tensor.shape, data: tensor.data })
}
