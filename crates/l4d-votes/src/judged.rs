//! A round with everything that follows from its files: the same for the verdict, its check, the next round and a
//! release.

pub mod files;
pub mod statuses;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use l4d_data::store::list_folder;
use l4d_data::{At as _, Benchmark, DataError, Finding, Name, StageError};

use self::files::remembered;
pub use self::statuses::Evidence;
pub use self::table::{render, status_line};
use crate::key::{Change, changes};
use crate::responses::{Responses, read_responses};
use crate::verdict::{Verdicts, judge, require_sealed};
use crate::{ItemId, Key, Round, RoundDir};

/// A judged round.
#[derive(Debug)]
pub struct JudgedRound {
    pub dir: RoundDir,
    /// What was asked.
    pub round: Round,
    /// What each item means.
    pub key: Key,
    /// What was answered.
    pub responses: Vec<Responses>,
    /// What has changed until now.
    pub changes_now: BTreeMap<ItemId, Change>,
    /// What had changed when the verdict was pronounced; if it was not yet, what has changed now.
    pub changes: BTreeMap<ItemId, Change>,
    /// The verdict that was or would be pronounced.
    pub verdicts: Verdicts,
    /// What the votes say of the benchmark as it is now: the same, unless something was edited since.
    pub now: Verdicts,
    /// What reading the ballots found.
    pub notices: Vec<Finding>,
}

impl JudgedRound {
    /// Reads and judges a round.
    ///
    /// # Errors
    /// A round whose files cannot be read or contradict each other.
    pub fn read(rounds: &Path, name: &str, bench: &Benchmark) -> Result<Self, StageError> {
        let name = Name::new(name)?;
        let dir = RoundDir::new(rounds.join(name.as_str()));
        let round = Round::open(&dir)?;
        let key = Key::read(&dir, &round)?;
        let (responses, notices) = read_responses(&dir, &round)?;
        let changes_now = changes(&round, &key, bench)?;
        let changes = remembered(&dir.verdicts())?.unwrap_or_else(|| changes_now.clone());
        let verdicts = judge(&round, &key, &responses, &changes);
        let now = judge(&round, &key, &responses, &changes_now);
        Ok(Self { dir, round, key, responses, changes_now, changes, verdicts, now, notices })
    }

    /// All rounds of a folder, in the order of their names; none without the folder.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_all(rounds: &Path, bench: &Benchmark) -> Result<Vec<Self>, StageError> {
        if !rounds.exists() {
            return Ok(Vec::new());
        }
        let names = list_folder(rounds)?.into_iter();
        let is_round = |name: &String| RoundDir::new(rounds.join(name)).settings().exists();
        let read = |name: String| Self::read(rounds, &name, bench).at(format_args!("round {name}"));
        names.filter(is_round).map(read).collect()
    }

    /// Whether people voted in it and have all sealed.
    pub fn counts(&self) -> bool {
        !self.round.simulated && self.now.is_final
    }

    /// Refuses a round in which somebody may still vote.
    ///
    /// # Errors
    /// A ballot that is not sealed.
    pub fn require_sealed(&self) -> Result<(), DataError> {
        require_sealed(&self.round, &self.responses)
    }

    /// What reading and judging found, sorted.
    pub fn findings(&self) -> Vec<Finding> {
        let mut all: Vec<Finding> = self.notices.iter().chain(&self.verdicts.findings).cloned().collect();
        all.sort();
        all.dedup();
        all
    }

    /// Scenes of the round that the benchmark still has.
    pub fn scenes<'a>(&self, bench: &'a Benchmark) -> Vec<&'a Name> {
        let asked: BTreeSet<&Name> = self.now.items.iter().map(|item| &item.query.scene).collect();
        bench.manifest.scenes.iter().filter(|scene| asked.contains(scene)).collect()
    }
}
