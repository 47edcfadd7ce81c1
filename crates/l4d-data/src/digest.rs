//! SHA-256 digests, as lower-case hex.

use std::io::{self, Read as _};
use std::path::Path;

use sha2::{Digest as _, Sha256};

use crate::error::DataError;
use crate::store::open_bounded;

/// Digest of bytes in memory.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&sha256(bytes))
}

/// Digest of bytes in memory as it is: the seed of a generator.
pub fn sha256(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

/// Digest of bytes that arrive in pieces.
#[derive(Debug, Clone, Default)]
pub struct RunningDigest(Sha256);

impl RunningDigest {
    /// Takes the next piece.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Digest of all pieces so far.
    pub fn hex(&self) -> String {
        hex(&self.0.clone().finalize())
    }
}

/// Digest of a file's bytes, read in blocks.
///
/// # Errors
/// A file that cannot be read.
pub fn sha256_file(path: &Path) -> Result<String, DataError> {
    let mut file = open_bounded(path, u64::MAX)?;
    let mut read = || -> io::Result<String> {
        let mut digest = RunningDigest::default();
        let mut block = vec![0; 1 << 16];
        loop {
            let count = file.read(&mut block)?;
            if count == 0 {
                return Ok(digest.hex());
            }
            digest.add(&block[..count]);
        }
    };
    read().map_err(|source| DataError::io(path, "read", source))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn digest_of_abc_is_the_published_one() {
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(super::sha256_hex(b"abc"), expected);
        let mut pieces = super::RunningDigest::default();
        pieces.add(b"a");
        assert_ne!(pieces.hex(), expected);
        pieces.add(b"bc");
        assert_eq!(pieces.hex(), expected);
    }
}
