//! What is wrong inside a file, before it is known which file.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;

/// What is wrong at a place within a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct Fault {
    /// Line, byte, field or entry.
    pub place: String,
    /// What is wrong there.
    pub message: String,
    /// What to do about it.
    pub hint: &'static str,
}

impl Fault {
    /// A fault; text that quotes the file belongs through [`quoted`] first.
    pub fn new(place: impl Into<String>, message: impl Into<String>, hint: &'static str) -> Self {
        Self { place: place.into(), message: message.into(), hint }
    }

    /// The same fault as an error about a file.
    pub fn at(self, path: &Path) -> DataError {
        DataError::invalid(path, self.place, self.message, self.hint)
    }
}

/// Words of a file for a message: marked, on one line, at most 60 characters, unable to steer a terminal.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut short: String = text.chars().take(LONGEST).collect();
    if short.len() < text.len() {
        short.push('\u{2026}');
    }
    format!("`{}`", inert(&short))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_are_short_and_inert() {
        assert_eq!(quoted("os.system"), "`os.system`");
        assert_eq!(quoted("\u{1b}[2J\na"), "`\u{fffd}[2J\u{fffd}a`");
        assert_eq!(quoted(&"x".repeat(1000)).chars().count(), 63);
    }
}
