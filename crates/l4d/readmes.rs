//! A README in each folder that verbs fill, so that who opens it sees what its files are.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::write_atomic;

pub(crate) const DATA: &str = include_str!("readmes/data.md");
pub(crate) const WORK: &str = include_str!("readmes/work.md");
pub(crate) const RESULTS: &str = include_str!("readmes/results.md");
pub(crate) const SCORES: &str = include_str!("readmes/scores.md");
pub(crate) const LEADERBOARD: &str = include_str!("readmes/leaderboard.md");

/// Leaves a README in a folder that is there and has none.
pub(crate) fn leave(folder: &Path, text: &str) -> Result<(), DataError> {
    let path = folder.join("README.md");
    if folder.is_dir() && !path.exists() { write_atomic(&path, text.as_bytes()) } else { Ok(()) }
}
