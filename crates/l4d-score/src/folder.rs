//! Untrusted folders: what is in them, without following a link out of them, and never more of it than any sound
//! folder has.

use std::fs;
use std::io;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, Report};

use crate::codes;

/// No folder of results has more entries: frames have four digits, and there are fewer queries.
pub(crate) const MAX_ENTRIES: usize = 20_000;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    File,
    Folder,
    Link,
    Other,
}

impl From<fs::FileType> for Kind {
    fn from(kind: fs::FileType) -> Self {
        match kind {
            kind if kind.is_symlink() => Self::Link,
            kind if kind.is_file() => Self::File,
            kind if kind.is_dir() => Self::Folder,
            _ => Self::Other,
        }
    }
}

pub(crate) fn kind_of(path: &Path) -> Result<Kind, DataError> {
    let metadata = fs::symlink_metadata(path).map_err(|source| DataError::io(path, "read", source))?;
    Ok(metadata.file_type().into())
}

/// Visible entries of a folder with their kinds, sorted. A missing folder has none; links to folders are refused, and so
/// are folders with more entries than [`MAX_ENTRIES`].
pub(crate) fn entries(folder: &Path, report: &mut Report) -> Vec<(String, Kind)> {
    match kind_of(folder) {
        Ok(Kind::Folder) => {}
        Ok(Kind::Link | Kind::Other) => {
            report_link(folder, report);
            return Vec::new();
        }
        // A file in the place of a folder is reported where its parent is listed.
        Ok(Kind::File) => return Vec::new(),
        Err(DataError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => return Vec::new(),
        Err(error) => {
            report.data_error(codes::UNREADABLE, &error);
            return Vec::new();
        }
    }
    list(folder, report)
}

/// The same of a folder that the user named, who may have put a link there.
pub(crate) fn list(folder: &Path, report: &mut Report) -> Vec<(String, Kind)> {
    let read = || -> io::Result<Vec<(String, Kind)>> {
        let mut found = Vec::new();
        // Hidden entries count as well: what is never read may still be without end.
        for entry in fs::read_dir(folder)?.take(MAX_ENTRIES + 1) {
            let entry = entry?;
            found.push((entry.file_name().to_string_lossy().into_owned(), entry.file_type()?.into()));
        }
        Ok(found)
    };
    match read() {
        Ok(found) if found.len() > MAX_ENTRIES => {
            let message = format!("holds more than {MAX_ENTRIES} entries, so nothing in it was read");
            report.error(codes::TOO_MANY, folder, "folder", message, "keep one file a frame or query");
            Vec::new()
        }
        Ok(mut found) => {
            found.retain(|(name, _)| !name.starts_with('.'));
            found.sort_by(|a, b| a.0.cmp(&b.0));
            found
        }
        Err(source) => {
            report.data_error(codes::UNREADABLE, &DataError::io(folder, "list the folder", source));
            Vec::new()
        }
    }
}

/// Size of a file that [`read_sized`] would read; none of links and of what is larger.
pub(crate) fn sound_bytes(path: &Path, limit: u64) -> u64 {
    let metadata = fs::symlink_metadata(path).ok().filter(fs::Metadata::is_file);
    metadata.map(|metadata| metadata.len()).filter(|bytes| *bytes <= limit).unwrap_or_default()
}

pub(crate) fn read_sized(path: &Path, limit: u64, report: &mut Report) -> Option<Vec<u8>> {
    match read_bounded(path, limit) {
        Ok(bytes) => Some(bytes),
        Err(error @ DataError::Invalid { .. }) => {
            report.data_error(codes::TOO_LARGE, &error);
            None
        }
        Err(error) => {
            report.data_error(codes::UNREADABLE, &error);
            None
        }
    }
}

pub(crate) fn report_link(path: &Path, report: &mut Report) {
    let message = "is a link or a special file, which could lead out of the results";
    report.error(codes::LINK, path, "", message, "put a real file or folder there");
}
