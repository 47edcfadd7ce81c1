//! What all rounds of people together say about the benchmark as it reads now.
//!
//! A wording that one panel rejected stays rejected, however often others are asked: asking again until it passes
//! would make any prompt unambiguous. Edited words are new words, and nothing is known of them.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, Result};
use l4d_data::store::list_folder;
use l4d_data::{Benchmark, QueryId, Status};
use l4d_votes::RoundDir;
use l4d_votes::verdict::Outcome;

use super::judged::Judged;

/// For each query whose present wording people have judged: verified or rejected, where and how.
#[derive(Debug, Default)]
pub(crate) struct Evidence(BTreeMap<QueryId, (Status, String)>);

impl Evidence {
    /// Judges every sealed round of people in a folder of rounds.
    pub(crate) fn gather(rounds: &Path, bench: &Benchmark) -> Result<Self> {
        let mut evidence = Self::default();
        if !rounds.exists() {
            return Ok(evidence);
        }
        for name in list_folder(rounds)? {
            if RoundDir::new(rounds.join(&name)).settings().exists() {
                let judged = Judged::read(rounds, &name, bench).with_context(|| format!("round {name}"))?;
                evidence.add(&judged);
            }
        }
        Ok(evidence)
    }

    /// Takes in what a round says, if people have sealed it.
    pub(crate) fn add(&mut self, judged: &Judged) {
        if judged.round.simulated || !judged.now.is_final {
            return;
        }
        for verdict in &judged.now.items {
            let says = match verdict.outcome {
                Outcome::Valid => Status::Verified,
                Outcome::Rejected => Status::Rejected,
                Outcome::Incomplete | Outcome::Stale => continue,
            };
            let known = self.0.get(&verdict.query).map(|(status, _)| *status);
            if known.is_none() || (known == Some(Status::Verified) && says == Status::Rejected) {
                let how = format!(
                    "\"{}\" {} in round {} ({})",
                    verdict.text,
                    verdict.pattern(),
                    judged.round.name,
                    verdict.reasons.join("; ")
                );
                self.0.insert(verdict.query.clone(), (says, how));
            }
        }
    }

    /// The status that the votes give to a query.
    pub(crate) fn status(&self, query: &QueryId) -> Option<Status> {
        self.0.get(query).map(|(status, _)| *status)
    }

    /// How people rejected the present wording of a query.
    pub(crate) fn why_rejected(&self, query: &QueryId) -> Option<&str> {
        self.0.get(query).filter(|(status, _)| *status == Status::Rejected).map(|(_, how)| how.as_str())
    }
}
