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

/// The one of some names that another one misspells.
pub fn meant<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    /// Less alike, a name is another one rather than a misspelt one.
    const ALIKE: f64 = 0.75;
    let likeness = |known: &&str| strsim::normalized_damerau_levenshtein(name, known);
    let nearest = known.iter().copied().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    nearest.filter(|nearest| likeness(nearest) >= ALIKE)
}

/// The hint for a name that is none of those known: the one that is meant first, where it misspells one.
pub fn choose_among(name: &str, known: &[&str]) -> String {
    let question = meant(name, known).map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
    format!("{question}choose among {}", known.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_is_recognised_and_another_one_is_not() {
        let known = ["room_playroom", "tabletop_tea"];
        let all = "choose among room_playroom, tabletop_tea";
        assert_eq!(choose_among("room_plairoom", &known), format!("did you mean `room_playroom`? {all}"));
        assert_eq!(choose_among("tabletop_tae", &known), format!("did you mean `tabletop_tea`? {all}"));
        assert_eq!(choose_among("moon_base", &known), all);
    }

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
