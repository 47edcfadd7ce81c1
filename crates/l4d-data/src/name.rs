//! Names that become file names: scenes, views, instances, methods.
//!
//! A [`Name`] can be joined to a path without leaving the folder, so nothing behind this type validates again.

use std::borrow::Borrow;
use std::fmt;
use std::ops::Deref;
use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

const MAX_LENGTH: usize = 80;

/// 1 to 80 ASCII letters, digits, `_`, `-` or `.`, not starting with `.` or `-`. Clones share their text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Name(Arc<str>);

/// Why a string is no [`Name`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{}` is not a name: use 1 to {MAX_LENGTH} letters, digits, `_`, `-` or `.`, not starting with `.` or `-`", .0.escape_debug())]
pub struct NameError(String);

impl Name {
    /// Checks and wraps.
    ///
    /// # Errors
    /// Text that is no name.
    pub fn new(text: impl Into<String>) -> Result<Self, NameError> {
        let text = text.into();
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.');
        let starts_well = !text.starts_with(['.', '-']);
        if text.is_empty() || text.len() > MAX_LENGTH || !starts_well || !text.bytes().all(allowed) {
            return Err(NameError(text.chars().take(MAX_LENGTH).collect()));
        }
        Ok(Self(text.into()))
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl Borrow<str> for Name {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Name {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(&self.0)
    }
}

impl FromStr for Name {
    type Err = NameError;

    fn from_str(text: &str) -> Result<Self, NameError> {
        Self::new(text)
    }
}

impl TryFrom<String> for Name {
    type Error = NameError;

    fn try_from(text: String) -> Result<Self, NameError> {
        Self::new(text)
    }
}

impl From<Name> for String {
    fn from(name: Name) -> Self {
        name.0.as_ref().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_leave_their_folder() {
        for bad in [
            "",
            ".",
            "..",
            "../x",
            "a/b",
            "a\\b",
            "/etc",
            ".hidden",
            "-rf",
            "a b",
            "ä",
            "a\0",
            &"x".repeat(81),
        ] {
            assert!(Name::new(bad).is_err(), "{bad:?} was taken for a name");
        }
        for good in ["outdoor_farm_buckets", "4DLangSplat-v1.2", "cam00"] {
            assert!(Name::new(good).is_ok(), "{good:?} was refused");
        }
    }
}
