//! What can be wrong with a file, always with its path, the field and a hint.

use std::io;
use std::path::{Path, PathBuf};

/// An error about one file or folder on disk; what it quotes is [`inert`].
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The operating system refused.
    #[error("{}: cannot {action}", shown(path))]
    #[non_exhaustive]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What was attempted, as a verb phrase ("read", "write").
        action: &'static str,
        source: io::Error,
    },
    /// The file is not the format that its name says.
    #[error("{}: {location}: {message}", shown(path))]
    #[non_exhaustive]
    Format {
        path: PathBuf,
        /// Field, line or offset ("line 3, field `referents`").
        location: String,
        /// What is wrong there.
        message: String,
    },
    /// The file parses but says something that cannot be.
    #[error("{}: {location}: {message}", shown(path))]
    #[non_exhaustive]
    Invalid {
        /// File or folder.
        path: PathBuf,
        /// Field, line or entry.
        location: String,
        /// What is wrong there.
        message: String,
        /// What to do about it.
        hint: String,
    },
}

/// Text of others on one line, in which nothing can steer the terminal that shows it or pass for a line of its own.
pub fn inert(text: &str) -> String {
    text.replace(is_hidden, "\u{fffd}")
}

/// The same for text of several lines.
pub fn inert_lines(text: &str) -> String {
    text.replace(|letter| letter != '\n' && is_hidden(letter), "\u{fffd}")
}

/// Whether a letter steers a terminal or hides its neighbours.
pub fn is_hidden(letter: char) -> bool {
    let is_mark = matches!(
        letter,
        '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
    );
    letter.is_control() || is_mark
}

/// Whether a text is one line of 1 to `longest` bytes that says something and hides nothing.
pub fn is_line(text: &str, longest: usize) -> bool {
    !text.trim().is_empty() && text.len() <= longest && !text.contains(is_hidden)
}

fn shown(path: &Path) -> String {
    inert(&path.display().to_string())
}

impl DataError {
    /// An I/O error that knows its path.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), action, source }
    }

    /// An error of the format of a file.
    pub fn format(path: &Path, location: impl Into<String>, message: impl ToString) -> Self {
        let (location, message) = (inert(&location.into()), inert(&message.to_string()));
        Self::Format { path: path.to_owned(), location, message }
    }

    /// A semantic error with its hint.
    pub fn invalid(
        path: &Path,
        location: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        let (location, message) = (inert(&location.into()), inert(&message.into()));
        Self::Invalid { path: path.to_owned(), location, message, hint: inert(&hint.into()) }
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

    /// What the user can do.
    pub fn hint(&self) -> &str {
        match self {
            Self::Io { source, .. } => match source.kind() {
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
                io::ErrorKind::ReadOnlyFilesystem => "choose a path on a writable disk",
                io::ErrorKind::NotFound => "check the path and the working folder",
                io::ErrorKind::InvalidFilename => "choose shorter names: most disks take 255 bytes each",
                io::ErrorKind::OutOfMemory => "check that this is the intended file, or allow more memory",
                _ => "check the path, the links in it and the disk, then run the command again",
            },
            Self::Format { .. } => "see docs/formats.md for the format of this file",
            Self::Invalid { hint, .. } => hint,
        }
    }
}
