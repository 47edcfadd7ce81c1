//! `cfg_args`: the options of a 4DGaussians run, the text that Python prints for an `argparse.Namespace`.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;
use l4d_formats::Fault;
pub use l4d_formats::python::Literal;
use l4d_formats::python::namespace;

/// No such file is longer, bytes: real ones have about 3000.
const MAX_BYTES: u64 = 1 << 16;

/// Options by name, in the order of the text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CfgArgs(Vec<(String, Literal)>);

impl CfgArgs {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, and everything but `Namespace(name=literal, ...)`.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let bytes = read_bounded(path, MAX_BYTES)?;
        Self::decode(&bytes).map_err(|fault| fault.at(path))
    }

    /// Parses the bytes of a file.
    ///
    /// # Errors
    /// Everything but `Namespace(name=literal, ...)`.
    pub fn decode(bytes: &[u8]) -> Result<Self, Fault> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let place = format!("byte {}", error.valid_up_to());
            Fault::new(place, "is no UTF-8 text", "give the file that training wrote")
        })?;
        namespace(text).map(Self)
    }

    /// The value of an option.
    pub fn get(&self, name: &str) -> Option<&Literal> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }
}
