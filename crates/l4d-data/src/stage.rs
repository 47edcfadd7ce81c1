//! What library stages share with their callers: progress, shards, and why a stage stopped.

use std::error::Error;
use std::fmt::Display;
use std::str::FromStr;

use crate::DataError;
use crate::name::NameError;
use crate::query::QueryIdError;

/// Hears how far a stage is. A binary draws bars; tests hear nothing.
pub trait Progress: Sync {
    /// A part of the stage begins: `total` steps, 0 if unknown.
    fn start(&self, what: &'static str, total: u64);
    /// Which item is worked on.
    fn item(&self, name: &dyn Display);
    /// So many steps are done.
    fn advance(&self, steps: u64);
    /// The part that began last is over.
    fn finish(&self);
    /// One line worth knowing.
    fn note(&self, line: &dyn Display);
    /// One line that must be seen.
    fn warn(&self, line: &dyn Display);
}

#[derive(Debug, Clone, Copy)]
pub struct Silent;

impl Progress for Silent {
    fn start(&self, _: &'static str, _: u64) {}
    fn item(&self, _: &dyn Display) {}
    fn advance(&self, _: u64) {}
    fn finish(&self) {}
    fn note(&self, _: &dyn Display) {}
    fn warn(&self, _: &dyn Display) {}
}

/// Why a stage stopped, causes included, and what the user can do about it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct StageError {
    message: String,
    hint: String,
}

impl StageError {
    /// A refusal with its hint.
    pub fn new(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { message: message.into(), hint: hint.into() }
    }

    /// Another error with its causes, as `a: b: c`.
    pub fn of(error: &dyn Error, hint: impl Into<String>) -> Self {
        let mut message = error.to_string();
        let mut source = error.source();
        while let Some(cause) = source {
            message.push_str(&format!(": {cause}"));
            source = cause.source();
        }
        Self { message, hint: hint.into() }
    }

    /// What the user can do.
    pub fn hint(&self) -> &str {
        &self.hint
    }
}

impl From<DataError> for StageError {
    fn from(error: DataError) -> Self {
        Self::of(&error, error.hint())
    }
}

impl From<NameError> for StageError {
    fn from(error: NameError) -> Self {
        Self::of(&error, "choose another name")
    }
}

impl From<QueryIdError> for StageError {
    fn from(error: QueryIdError) -> Self {
        Self::of(&error, "name a query of the benchmark")
    }
}

/// What keeps l4d from writing a document of its own.
fn unwritable(error: &dyn Error) -> StageError {
    StageError::of(error, "report the command that ended so: this should not happen")
}

impl From<serde_json::Error> for StageError {
    fn from(error: serde_json::Error) -> Self {
        unwritable(&error)
    }
}

impl From<toml::ser::Error> for StageError {
    fn from(error: toml::ser::Error) -> Self {
        unwritable(&error)
    }
}

impl From<csv::Error> for StageError {
    fn from(error: csv::Error) -> Self {
        unwritable(&error)
    }
}

/// `Result::at`: where an error happened.
pub trait At<T> {
    /// Puts a place before the message.
    ///
    /// # Errors
    /// The same error, with its place.
    fn at(self, place: impl Display) -> Result<T, StageError>;
}

impl<T, E: Into<StageError>> At<T> for Result<T, E> {
    fn at(self, place: impl Display) -> Result<T, StageError> {
        self.map_err(|error| {
            let StageError { message, hint } = error.into();
            StageError { message: format!("{place}: {message}"), hint }
        })
    }
}

/// Part `index` of `count`, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    pub index: usize,
    /// Of how many.
    pub count: usize,
}

impl Shard {
    /// Keeps the entries of a list that belong to the shard: shard i of n has every n-th entry.
    pub fn keep<T>(self, list: &mut Vec<T>) {
        let mut places = 0..;
        list.retain(|_| places.next().is_some_and(|place| self.has(place)));
    }

    /// Whether the entry at this place of a list, counted from 0, belongs to the shard.
    pub fn has(self, place: usize) -> bool {
        place % self.count == self.index - 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            Some((index.parse().ok()?, count.parse().ok()?))
        };
        match parse() {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(format!("`{text}` is not a shard: write i/n with 1 <= i <= n, for example 2/8")),
        }
    }
}

/// The most memory that this process has had, where the system tells.
pub fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.split_ascii_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024)
}
