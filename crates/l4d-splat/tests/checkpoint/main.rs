//! Checkpoints against files that Python wrote (`tests/fixtures/checkpoint/make.py`) and against hostile ones.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod foreign;
mod own;
mod ply;

use std::path::PathBuf;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/checkpoint").join(name)
}

/// A PLY file of the tests of `l4d-formats`, which has the other formats.
fn ply_file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../l4d-formats/tests/fixtures/ply").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(fixture(name)).unwrap()
}

/// SHA-256 of numbers as little-endian bytes.
fn digest(numbers: &[f32]) -> String {
    l4d_data::digest::sha256_hex(&numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>())
}
