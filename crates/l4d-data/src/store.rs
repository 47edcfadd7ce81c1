//! Reading whole files with a bound, and writing them so that a kill leaves the old file or the new one.

mod atomic;
mod claim;
mod lock;

use std::fs::{self, File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

pub use self::atomic::{AtomicFile, Temporary, folder_of, sweep};
pub use self::claim::{Claim, Earlier};
pub use self::lock::FolderLock;
use crate::error::DataError;

/// Opens a file of at most `limit` bytes for reading.
///
/// # Errors
/// Pipes, devices and folders, a file that cannot be opened, or is larger.
pub fn open_bounded(path: &Path, limit: u64) -> Result<File, DataError> {
    let require_file = |metadata: io::Result<Metadata>| {
        let metadata = metadata.map_err(|source| DataError::io(path, "open", source))?;
        if !metadata.is_file() {
            return Err(DataError::invalid(
                path,
                "file",
                "is not a regular file",
                "put a regular file there",
            ));
        }
        Ok(metadata)
    };
    // Asked before it is opened, since opening a pipe waits for a writer, and once more of what was
    // opened, since it may have been exchanged.
    require_file(fs::metadata(path))?;
    let file = File::open(path).map_err(|source| DataError::io(path, "open", source))?;
    if require_file(file.metadata())?.len() > limit {
        return Err(too_large(path, limit));
    }
    Ok(file)
}

/// Reads a file of at most `limit` bytes.
///
/// # Errors
/// A file that cannot be read, is larger, or does not fit into memory.
pub fn read_bounded(path: &Path, limit: u64) -> Result<Vec<u8>, DataError> {
    let file = open_bounded(path, limit)?;
    let read = || -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        // Memory that is lacking is an error here, and not the end of the process.
        bytes.try_reserve_exact(file.metadata()?.len() as usize + 1)?;
        (&file).take(limit + 1).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let bytes = read().map_err(|source| DataError::io(path, "read", source))?;
    if bytes.len() as u64 > limit {
        return Err(too_large(path, limit));
    }
    Ok(bytes)
}

fn too_large(path: &Path, limit: u64) -> DataError {
    let message = format!("is larger than the {limit} bytes that such a file may have");
    DataError::invalid(path, "size", message, "check that this is the intended file")
}

/// Writes a file through a temporary neighbour, fsync and rename; makes the folder if it is missing.
///
/// # Errors
/// What the disk refuses.
pub fn write_atomic(path: &Path, bytes: &[u8]) -> Result<(), DataError> {
    let mut file = AtomicFile::create(path)?;
    file.write(bytes)?;
    file.commit()
}

/// Whether the file is there with just these bytes.
///
/// # Errors
/// A file with other bytes, unless they may be replaced; `hint` says how.
pub fn holds(path: &Path, bytes: &[u8], force: bool, hint: &str) -> Result<bool, DataError> {
    if fs::symlink_metadata(path).is_err() {
        return Ok(false);
    }
    let is_same = read_bounded(path, bytes.len() as u64).is_ok_and(|found| found == bytes);
    if !is_same && !force {
        return Err(DataError::invalid(path, "file", "is there with other content", hint));
    }
    Ok(is_same)
}

/// Writes a file unless it is there with just these bytes; whether it was written.
///
/// # Errors
/// As [`holds`] and [`write_atomic`].
pub fn write_unless_held(path: &Path, bytes: &[u8], force: bool, hint: &str) -> Result<bool, DataError> {
    let is_new = !holds(path, bytes, force, hint)?;
    if is_new {
        write_atomic(path, bytes)?;
    }
    Ok(is_new)
}

/// Makes a folder and its parents.
///
/// # Errors
/// What the disk refuses.
pub fn make_folder(path: &Path) -> Result<(), DataError> {
    fs::create_dir_all(path).map_err(|source| DataError::io(path, "create the folder", source))
}

/// Removes a folder with all that it holds; one that is not there is no error.
///
/// # Errors
/// What the disk refuses.
pub fn remove_folder(path: &Path) -> Result<(), DataError> {
    match fs::remove_dir_all(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(DataError::io(path, "remove the folder", source))
        }
        _ => Ok(()),
    }
}

/// Names of the visible entries of a folder, sorted. A missing folder is an error.
///
/// # Errors
/// A folder that cannot be listed.
pub fn list_folder(path: &Path) -> Result<Vec<String>, DataError> {
    let read = || -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in fs::read_dir(path)? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        Ok(names)
    };
    let mut names = read().map_err(|source| DataError::io(path, "list the folder", source))?;
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_atomic_write_replaces_and_leaves_no_temporary() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/file.json");
        write_atomic(&path, b"one").unwrap();
        write_atomic(&path, b"two").unwrap();
        assert_eq!(read_bounded(&path, 10).unwrap(), b"two");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_write_keeps_the_old_file_and_says_where() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("file");
        fs::write(&blocked, "a file, not a folder").unwrap();
        let error = write_atomic(&blocked.join("child.json"), b"x").unwrap_err();
        assert!(error.to_string().contains("file"), "{error}");
        assert_eq!(fs::read(&blocked).unwrap(), b"a file, not a folder");
    }

    #[test]
    fn oversized_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("big");
        fs::write(&path, [0; 11]).unwrap();
        assert!(read_bounded(&path, 10).unwrap_err().to_string().contains("larger"));
    }
}
