//! What is asked: an item shows a prompt and a scene, and nothing of what it was drawn from.

use std::fmt;
use std::str::FromStr;

use l4d_data::Name;
use serde::{Deserialize, Serialize};

/// `q` and four to six digits. Drawn by lot, so that it says nothing about the kind of the item.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct ItemId(String);

/// Why a string is no [`ItemId`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{}` is not an item: write `q` and four to six digits, for example `q0007`", .0.escape_debug())]
pub struct ItemIdError(String);

impl ItemId {
    /// The item of that number among `count`; ids of a round are equally long, so they sort like numbers.
    pub(crate) fn numbered(number: usize, count: usize) -> Self {
        let width = count.to_string().len().max(4);
        Self(format!("q{number:0width$}"))
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for ItemId {
    type Err = ItemIdError;

    fn from_str(text: &str) -> Result<Self, ItemIdError> {
        let is_number = |digits: &str| {
            (4..=6).contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
        };
        match text.strip_prefix('q') {
            Some(digits) if is_number(digits) => Ok(Self(text.to_owned())),
            _ => Err(ItemIdError(text.chars().take(40).collect())),
        }
    }
}

impl TryFrom<String> for ItemId {
    type Error = ItemIdError;

    fn try_from(text: String) -> Result<Self, ItemIdError> {
        text.parse()
    }
}

impl From<ItemId> for String {
    fn from(id: ItemId) -> Self {
        id.0
    }
}

impl fmt::Display for ItemId {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(&self.0)
    }
}

/// One line of `items.jsonl`: all that an annotator may see, and the digest of what it was drawn from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Item {
    /// Its name in the round.
    #[serde(rename = "item")]
    pub id: ItemId,
    /// Where to look.
    pub scene: Name,
    /// What to look for.
    pub text: String,
    /// SHA-256 over prompt, meaning and scene: what a vote is bound to.
    pub digest: String,
}
