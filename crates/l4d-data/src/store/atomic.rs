//! A file that appears whole or not at all, written piece by piece.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::make_folder;
use crate::error::DataError;

/// Writes to a temporary neighbour; [`AtomicFile::commit`] moves it into place, dropping removes it.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
    writer: Option<BufWriter<File>>,
}

impl AtomicFile {
    /// Starts the file; makes its folder if it is missing.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn create(path: &Path) -> Result<Self, DataError> {
        make_folder(path.parent().unwrap_or(Path::new(".")))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let temporary = path.with_file_name(format!(".{name}.{}.tmp", std::process::id()));
        let file = File::create(&temporary).map_err(|source| DataError::io(path, "write", source))?;
        Ok(Self { path: path.to_owned(), temporary, writer: Some(BufWriter::new(file)) })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), DataError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        writer.write_all(bytes).map_err(|source| DataError::io(&self.path, "write", source))
    }

    /// Puts the file in place.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn commit(mut self) -> Result<(), DataError> {
        let finish = |writer: BufWriter<File>| -> io::Result<()> {
            writer.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
            fs::rename(&self.temporary, &self.path)
        };
        match self.writer.take() {
            Some(writer) => finish(writer).map_err(|source| DataError::io(&self.path, "write", source))?,
            None => return Ok(()),
        }
        // The rename itself must survive a power cut; a filesystem that cannot sync folders is no error.
        if let Ok(folder) = File::open(self.path.parent().unwrap_or(Path::new("."))) {
            folder.sync_all().ok();
        }
        Ok(())
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        // After a commit there is nothing any more, which is no error.
        fs::remove_file(&self.temporary).ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_commit_replaces_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/file.csv");
        let write = |text: &str| {
            let mut file = AtomicFile::create(&path).unwrap();
            file.write(text.as_bytes()).unwrap();
            file
        };
        write("old").commit().unwrap();
        drop(write("torn"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        write("new").commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }
}
