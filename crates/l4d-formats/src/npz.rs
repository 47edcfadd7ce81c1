//! Archives of arrays: a zip of `.npy` entries, stored or deflated.

use std::path::Path;

use l4d_data::DataError;

use crate::fault::{Fault, quoted};
use crate::npy::{self, Contents};
use crate::zip::{self, Archive};

/// An opened archive; nothing is inflated before it is read.
#[derive(Debug)]
pub struct Npz<'a>(Archive<'a>);

impl<'a> Npz<'a> {
    /// Opens the bytes of a file.
    ///
    /// # Errors
    /// No whole zip, and entries that numpy does not write.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        Archive::open(bytes).map(Self)
    }

    /// Names of the arrays, sorted, without `.npy`.
    pub fn names(&self) -> Vec<String> {
        self.0.names().map(|name| name.strip_suffix(".npy").unwrap_or(name).to_owned()).collect()
    }

    /// An array by its name.
    ///
    /// # Errors
    /// A missing or damaged entry, and one that is no plain array.
    pub fn read(&self, name: &str) -> Result<Contents, Fault> {
        let file = format!("{name}.npy");
        let entry = if self.0.names().any(|known| known == file) { &file } else { name };
        let bytes = self.0.read(entry)?;
        npy::decode(&bytes)
            .map_err(|fault| Fault { place: format!("array {}, {}", quoted(name), fault.place), ..fault })
    }
}

/// An uncompressed archive of the bytes of `.npy` files, as `numpy.savez` writes it; `path` is for errors.
///
/// # Errors
/// More bytes than a zip holds.
pub fn encode(path: &Path, arrays: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, DataError> {
    let entries: Vec<(String, &[u8])> =
        arrays.iter().map(|(name, bytes)| (format!("{name}.npy"), bytes.as_slice())).collect();
    zip::encode(&entries).map_err(|error| {
        DataError::invalid(path, "archive", format!("cannot be written: {error}"), "use fewer --points")
    })
}
