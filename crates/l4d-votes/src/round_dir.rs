//! The files of a round.

use std::path::{Path, PathBuf};

use l4d_data::store::{Claim, Earlier};
use l4d_data::{DataError, Name};

/// `annotation/rounds/<round>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoundDir(PathBuf);

impl RoundDir {
    /// The folder of a round.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self(root.into())
    }

    pub fn root(&self) -> &Path {
        &self.0
    }

    /// The right to write some of its files.
    ///
    /// # Errors
    /// Files that l4d did not write, unless `force`, and a round that another run writes into.
    pub fn claim(&self, files: &[PathBuf], earlier: Earlier<'_>, force: bool) -> Result<Claim, DataError> {
        let names = files.iter().filter_map(|path| path.file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned()).collect();
        Claim::take(&self.0, names, Some(earlier), force)
    }

    /// `round.toml`: what the round is.
    pub fn settings(&self) -> PathBuf {
        self.0.join("round.toml")
    }

    /// `items.jsonl`: what is asked.
    pub fn items(&self) -> PathBuf {
        self.0.join("items.jsonl")
    }

    /// `key.jsonl`: what the items were drawn from. No annotator's process opens it.
    pub fn key(&self) -> PathBuf {
        self.0.join("key.jsonl")
    }

    /// `votes`: the logs.
    pub fn votes(&self) -> PathBuf {
        self.0.join("votes")
    }

    /// `votes/<annotator>.jsonl`.
    pub fn ballot(&self, annotator: &Name) -> PathBuf {
        self.votes().join(format!("{annotator}.jsonl"))
    }

    /// `verdicts.csv`.
    pub fn verdicts(&self) -> PathBuf {
        self.0.join("verdicts.csv")
    }

    /// `agreement.json`.
    pub fn agreement(&self) -> PathBuf {
        self.0.join("agreement.json")
    }

    /// `refine.jsonl`: rejected prompts with what people said about them.
    pub fn refine(&self) -> PathBuf {
        self.0.join("refine.jsonl")
    }
}
