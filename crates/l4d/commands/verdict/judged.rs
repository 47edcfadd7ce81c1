//! A round with everything that follows from its files: the same for the verdict, its check and the next round.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use l4d_data::{Benchmark, Finding, Name};
use l4d_votes::files::remembered;
use l4d_votes::key::{Change, changes};
use l4d_votes::verdict::{Verdicts, judge, require_sealed};
use l4d_votes::{ItemId, Key, Responses, Round, RoundDir, read_responses};

/// A judged round.
pub(crate) struct Judged {
    pub(crate) dir: RoundDir,
    pub(crate) round: Round,
    pub(crate) key: Key,
    pub(crate) responses: Vec<Responses>,
    /// What has changed until now.
    pub(crate) changes_now: BTreeMap<ItemId, Change>,
    /// What had changed when the verdict was pronounced; if it was not yet, what has changed now.
    pub(crate) changes: BTreeMap<ItemId, Change>,
    /// The verdict that was or would be pronounced.
    pub(crate) verdicts: Verdicts,
    /// What the votes say of the benchmark as it is now: the same, unless something was edited since.
    pub(crate) now: Verdicts,
    /// What reading the ballots found.
    pub(crate) notices: Vec<Finding>,
}

impl Judged {
    /// Reads and judges a round.
    pub(crate) fn read(rounds: &Path, name: &str, bench: &Benchmark) -> Result<Self> {
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

    /// Refuses a round in which somebody may still vote.
    pub(crate) fn require_sealed(&self) -> Result<()> {
        Ok(require_sealed(&self.dir, &self.round, &self.responses)?)
    }
}
