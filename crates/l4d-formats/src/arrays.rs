//! Arrays of numbers in `.npy`, `.npz`, `.pt` and `.pth` files.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use crate::fault::{Fault, quoted};
use crate::npy::{self, Contents};
use crate::pickle::{self, Saved};
use crate::tensor::Tensor;
use crate::zip::{self, Archive};

/// No file of arrays is larger: latents of 8 channels at 4K fit.
const MAX_BYTES: u64 = 512 << 20;

/// Reads the array in a file, or the one called `key` of a file with several.
///
/// # Errors
/// Files that cannot be opened, and everything that is no plain array of numbers.
pub fn read(path: &Path, key: Option<&str>) -> Result<Tensor, DataError> {
    read_contents(path, key)?.into_numbers().map_err(|fault| fault.at(path))
}

/// Reads numbers or texts.
///
/// # Errors
/// As [`read`].
pub fn read_contents(path: &Path, key: Option<&str>) -> Result<Contents, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let contents = match extension(path).as_str() {
        "npy" => npy::decode(&bytes),
        "npz" => from_npz(&bytes, key),
        "pt" | "pth" => pickle::decode(&bytes).and_then(|saved| from_pickle(saved, key)),
        other => {
            let message = format!("ends with `.{other}`, but arrays are in .npy, .npz, .pt or .pth files");
            Err(Fault::new("name", message, "name the file as its format is called"))
        }
    };
    contents.map_err(|fault| fault.at(path))
}

/// Names of the arrays in an `.npz`, sorted.
///
/// # Errors
/// A file that is no such archive.
pub fn names(path: &Path) -> Result<Vec<String>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let archive = Archive::open(&bytes).map_err(|fault| fault.at(path))?;
    Ok(archive.names().map(|name| without_suffix(name).to_owned()).collect())
}

/// The end of a file's name, in lower case.
pub fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// An array in the bytes of an `.npz`: a zip of `.npy` entries, stored or deflated.
///
/// # Errors
/// No whole zip, entries that numpy does not write, a missing or damaged entry, and one that is no plain array.
pub fn from_npz(bytes: &[u8], key: Option<&str>) -> Result<Contents, Fault> {
    let archive = Archive::open(bytes)?;
    let entry = choose(archive.names(), |name| without_suffix(name), key)?;
    npy::decode(&archive.read(entry)?).map_err(|fault| {
        let place = format!("array {}, {}", quoted(without_suffix(entry)), fault.place);
        Fault { place, ..fault }
    })
}

/// An uncompressed archive of the bytes of `.npy` files, as `numpy.savez` writes it; `path` is for errors.
///
/// # Errors
/// More bytes than a zip holds.
pub fn encode_npz(path: &Path, arrays: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, DataError> {
    zip::encode(arrays.iter().map(|(name, bytes)| (format!("{name}.npy"), bytes.as_slice()))).map_err(
        |error| {
            DataError::invalid(path, "archive", format!("cannot be written: {error}"), "use fewer --points")
        },
    )
}

fn without_suffix(entry: &str) -> &str {
    entry.strip_suffix(".npy").unwrap_or(entry)
}

/// The entry that is called `key`, or the only one.
fn choose<T>(
    entries: impl Iterator<Item = T>,
    name: impl Fn(&T) -> &str,
    key: Option<&str>,
) -> Result<T, Fault> {
    let mut entries: Vec<T> = entries.collect();
    let found = match key {
        Some(key) => entries.iter().position(|entry| name(entry) == key),
        None => (entries.len() == 1).then_some(0),
    };
    found.map(|index| entries.swap_remove(index)).ok_or_else(|| {
        let known: Vec<String> = entries.iter().take(20).map(|entry| quoted(name(entry))).collect();
        let known = known.join(", ");
        let message = match key {
            Some(key) => format!("has no array `{key}`, but {known}"),
            None => format!("has {} arrays, and nothing says which is meant: {known}", entries.len()),
        };
        Fault::new("archive", message, "give the name of one of them")
    })
}

fn from_pickle(saved: Saved, key: Option<&str>) -> Result<Contents, Fault> {
    let tensor = match saved {
        Saved::Tensor(tensor) => tensor,
        Saved::Dict(entries) => {
            let tensors = entries.into_iter().filter_map(|(name, value)| Some((name, value.ok()?)));
            choose(tensors, |(name, _)| name, key)?.1
        }
    };
    Ok(Contents::Numbers(tensor))
}
