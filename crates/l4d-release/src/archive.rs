//! Archives whose bytes follow from the files in them alone: sorted, no dates, no owners, not compressed.
//!
//! Plain tar, because the pictures are compressed already and because a compressor's next version may write other
//! bytes for the same files.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use l4d_data::DataError;
use l4d_data::digest::RunningDigest;
use l4d_data::store::AtomicFile;
use tar::{Builder, EntryType, Header};

use crate::gather::Source;

/// Writes an archive; it appears when it is whole. Files whose bytes are not those of their digest are refused.
/// `progress` gets bytes as they are written.
///
/// # Errors
/// If a file cannot be read, changed meanwhile, or the archive cannot be written.
pub fn write(path: &Path, files: &[Source], progress: &(dyn Fn(u64) + Sync)) -> Result<(), DataError> {
    let mut sorted: Vec<&Source> = files.iter().collect();
    sorted.sort_by(|a, b| a.name.cmp(&b.name));
    let mut archive = Archive::create(path)?;
    sorted.into_iter().try_for_each(|source| archive.append(source, progress))?;
    archive.commit()
}

/// An archive on its way.
pub(crate) struct Archive {
    path: PathBuf,
    builder: Builder<Sink>,
}

impl Archive {
    /// Starts one; it appears when it is committed.
    pub(crate) fn create(path: &Path) -> Result<Self, DataError> {
        Ok(Self { path: path.to_owned(), builder: Builder::new(Sink(AtomicFile::create(path)?)) })
    }

    /// Appends a file from memory.
    pub(crate) fn add(&mut self, name: &str, bytes: &[u8]) -> Result<(), DataError> {
        header(name, bytes.len() as u64)
            .and_then(|header| self.builder.append(&header, bytes))
            .map_err(|source| DataError::io(&self.path, "write", source))
    }

    /// Appends a file from the disk.
    fn append(&mut self, source: &Source, progress: &(dyn Fn(u64) + Sync)) -> Result<(), DataError> {
        let file = File::open(&source.path).map_err(|error| DataError::io(&source.path, "open", error))?;
        let mut reader = Watched { file, digest: RunningDigest::default(), bytes: 0, progress };
        // What the file has more or less than its header says would shift all that follows.
        let rest = header(&source.name, source.bytes)
            .and_then(|header| self.builder.append(&header, (&mut reader).take(source.bytes)))
            .and_then(|()| io::copy(&mut reader, &mut io::sink()))
            .map_err(|error| DataError::io(&self.path, "write", error))?;
        if rest > 0 || reader.bytes != source.bytes || reader.digest.hex() != source.sha256 {
            return Err(changed(&source.path));
        }
        Ok(())
    }

    /// Puts it in place.
    pub(crate) fn commit(self) -> Result<(), DataError> {
        let path = self.path;
        self.builder.into_inner().map_err(|source| DataError::io(&path, "write", source))?.0.commit()
    }
}

/// The refusal of a file that changed since it was listed.
pub(crate) fn changed(path: &Path) -> DataError {
    let hint = "nothing may change while a release is made: run `l4d check-scenes`, then run it again";
    DataError::invalid(path, "bytes", "are not those of its digest", hint)
}

fn header(name: &str, bytes: u64) -> io::Result<Header> {
    let mut header = Header::new_ustar();
    header.set_path(name)?;
    header.set_entry_type(EntryType::Regular);
    header.set_mode(0o644);
    header.set_uid(0);
    header.set_gid(0);
    header.set_mtime(0);
    header.set_size(bytes);
    header.set_cksum();
    Ok(header)
}

/// A file that is digested while it is read.
struct Watched<'a> {
    file: File,
    digest: RunningDigest,
    bytes: u64,
    progress: &'a (dyn Fn(u64) + Sync),
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.digest.add(&buffer[..count]);
        self.bytes += count as u64;
        (self.progress)(count as u64);
        Ok(count)
    }
}

/// The archive on disk.
struct Sink(AtomicFile);

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes).map_err(io::Error::other)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(folder: &Path, names: &[&str]) -> Vec<Source> {
        let source = |name: &&str| {
            let path = folder.join(name.replace('/', "_"));
            std::fs::write(&path, format!("content of {name}")).unwrap();
            Source::read((*name).to_owned(), path).unwrap()
        };
        names.iter().map(source).collect()
    }

    fn bytes(path: &Path, files: &[Source]) -> Vec<u8> {
        write(path, files, &|_| {}).unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn the_same_files_give_the_same_bytes_in_any_order_at_any_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.tar");
        let mut files = sources(folder.path(), &["b/2.txt", "a.txt", "b/1.txt"]);
        let first = bytes(&path, &files);
        files.reverse();
        std::fs::File::open(&files[0].path).unwrap().set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
        assert_eq!(bytes(&path, &files), first);
        let mut archive = tar::Archive::new(first.as_slice());
        let mut names: Vec<PathBuf> = Vec::new();
        for entry in archive.entries().unwrap() {
            let mut entry = entry.unwrap();
            let header = entry.header();
            assert_eq!(
                (header.mtime().unwrap(), header.uid().unwrap(), header.mode().unwrap()),
                (0, 0, 0o644)
            );
            names.push(entry.path().unwrap().into_owned());
            let mut text = String::new();
            entry.read_to_string(&mut text).unwrap();
            assert!(text.starts_with("content of"));
        }
        assert_eq!(names, ["a.txt", "b/1.txt", "b/2.txt"].map(PathBuf::from));
    }

    #[test]
    fn a_file_that_changed_is_refused_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        for other in ["content of A.txt", "longer than it was before", "short"] {
            let files = sources(folder.path(), &["a.txt"]);
            std::fs::write(&files[0].path, other).unwrap();
            let error = write(&out.join("a.tar"), &files, &|_| {}).unwrap_err();
            assert!(error.to_string().contains("a.txt") && !error.hint().is_empty(), "{error}");
            assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0, "{other}");
        }
    }
}
