//! Files that Python wrote (`crates/l4d-splat/tests/fixtures/checkpoint/make.py`) and hostile ones.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod arrays;
mod pickle;
mod ply;
mod poison;
mod python;
mod truncated;

use std::path::PathBuf;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(fixture(name)).unwrap()
}

/// Entries of an archive, in its order.
fn entries(file: &[u8]) -> Vec<(String, Vec<u8>)> {
    let archive = rawzip::ZipArchive::from_slice(file).unwrap();
    let entry = |record: Result<rawzip::ZipFileHeaderRecord<'_>, rawzip::Error>| {
        let record = record.unwrap();
        let name = String::from_utf8(record.file_path().as_bytes().to_vec()).unwrap();
        (name, archive.get_entry(record.wayfinder()).unwrap().data().to_vec())
    };
    archive.entries().map(entry).collect()
}
