//! What can be wrong with a file, always with its path, the field and a remedy.

use std::io;
use std::path::{Path, PathBuf};

/// An error about one file or folder on disk.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The operating system refused.
    #[error("{}: cannot {action}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What was attempted, as a verb phrase ("read", "write").
        action: &'static str,
        /// The refusal.
        source: io::Error,
    },
    /// The file is not the format that its name says.
    #[error("{}: {location}: {message}", path.display())]
    Format {
        /// File.
        path: PathBuf,
        /// Field, line or offset ("line 3, field `referents`").
        location: String,
        /// What is wrong there.
        message: String,
    },
    /// The file parses but says something that cannot be.
    #[error("{}: {location}: {message}", path.display())]
    Invalid {
        /// File or folder.
        path: PathBuf,
        /// Field, line or entry.
        location: String,
        /// What is wrong there.
        message: String,
        /// What to do about it.
        remedy: String,
    },
}

/// Text that quotes a file, so that nothing in the file can steer the terminal that shows it.
pub fn inert(text: &str) -> String {
    text.replace(|character: char| character.is_control() && character != '\n', "\u{fffd}")
}

/// The same for a name, which must not look like a line of its own either.
pub fn inert_name(text: &str) -> String {
    text.replace(char::is_control, "\u{fffd}")
}

impl DataError {
    /// An I/O error that knows its path.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), action, source }
    }

    /// An error of the format of a file.
    pub fn format(path: &Path, location: impl Into<String>, message: impl ToString) -> Self {
        Self::Format { path: path.to_owned(), location: location.into(), message: message.to_string() }
    }

    /// A semantic error with its remedy.
    pub fn invalid(
        path: &Path,
        location: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            location: location.into(),
            message: message.into(),
            remedy: remedy.into(),
        }
    }

    /// The file or folder concerned.
    pub fn path(&self) -> &Path {
        match self {
            Self::Io { path, .. } | Self::Format { path, .. } | Self::Invalid { path, .. } => path,
        }
    }

    /// Where in the file, and what is wrong there.
    pub fn place_and_message(&self) -> (String, String) {
        match self {
            Self::Io { action, source, .. } => (String::new(), format!("cannot {action}: {source}")),
            Self::Format { location, message, .. } | Self::Invalid { location, message, .. } => {
                (location.clone(), message.clone())
            }
        }
    }

    /// What the user can do, where more can be said than the message does.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Io { source, .. } => {
                let hint = match source.kind() {
                    io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                        "free some disk space and run the command again"
                    }
                    io::ErrorKind::FileTooLarge => {
                        "files of that size are not allowed here: raise the limit (ulimit -f), or choose another disk"
                    }
                    io::ErrorKind::PermissionDenied => {
                        "make the path readable and writable for this user, or choose another"
                    }
                    io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
                        "a file is where a folder is needed: move it away, or choose another path"
                    }
                    io::ErrorKind::IsADirectory => {
                        "a folder is where a file is needed: move it away, or choose another path"
                    }
                    io::ErrorKind::InvalidFilename => "choose shorter names: most disks take 255 bytes each",
                    io::ErrorKind::ReadOnlyFilesystem => "choose a path on a writable disk",
                    io::ErrorKind::NotFound => "check the path and the working folder",
                    _ => "check the path and the disk, then run the command again",
                };
                Some(hint.to_owned())
            }
            Self::Format { .. } => Some("see docs/formats.md for the format of this file".to_owned()),
            Self::Invalid { remedy, .. } => Some(remedy.clone()),
        }
    }
}
