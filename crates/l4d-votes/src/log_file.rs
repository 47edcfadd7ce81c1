//! Appending to a file so that it survives a power cut, and undoing an append that failed.

use std::fmt;
use std::fs::{File, Metadata};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::PathBuf;

/// Where the lines of a ballot go: a file, or a disk that fails when a test wants it.
pub(crate) trait LogFile: fmt::Debug + Send {
    /// Whether the file is still the one that was opened and has this length.
    fn is_intact(&self, length: u64) -> bool;
    /// Writes at the end and waits until it is on the disk.
    fn append(&mut self, length: u64, bytes: &[u8]) -> io::Result<()>;
    /// Cuts the file back to a length and waits until that is on the disk.
    fn cut(&mut self, length: u64) -> io::Result<()>;
    /// The first `length` bytes, as they are on the disk now.
    fn read(&mut self, length: u64) -> io::Result<Vec<u8>>;
}

/// A locked file.
#[derive(Debug)]
pub(crate) struct LockedFile {
    file: File,
    path: PathBuf,
}

impl LockedFile {
    pub(crate) fn new(file: File, path: PathBuf) -> Self {
        Self { file, path }
    }
}

impl LogFile for LockedFile {
    fn is_intact(&self, length: u64) -> bool {
        // A synced write into a file that was replaced or removed meanwhile would be lost all the same.
        match (self.file.metadata(), std::fs::metadata(&self.path)) {
            (Ok(open), Ok(there)) => open.len() == length && is_same_file(&open, &there),
            _ => false,
        }
    }

    fn append(&mut self, length: u64, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(length))?;
        self.file.write_all(bytes)?;
        self.file.sync_all()
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        self.file.set_len(length)?;
        self.file.sync_all()
    }

    fn read(&mut self, length: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.file.seek(SeekFrom::Start(0))?;
        (&self.file).take(length).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        // A child that is just being started holds a copy of the handle, and with it the lock, for a moment longer.
        self.file.unlock().ok();
    }
}

#[cfg(unix)]
fn is_same_file(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same_file(a: &Metadata, b: &Metadata) -> bool {
    a.len() == b.len()
}
