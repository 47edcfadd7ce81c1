//! What all rounds of people together say about the benchmark as it reads now.
//!
//! A wording that one panel rejected stays rejected: asking again until it passes would make any prompt unambiguous.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::{Benchmark, QueryId, StageError, Status};

use super::Judged;
use crate::verdict::Outcome;

/// For each query whose present wording people have judged: verified or rejected, where and how.
#[derive(Debug, Default)]
pub struct Evidence(BTreeMap<QueryId, (Status, String)>);

impl Evidence {
    /// Judges every sealed round of people in a folder of rounds.
    ///
    /// # Errors
    /// As [`Judged::read`].
    pub fn gather(rounds: &Path, bench: &Benchmark) -> Result<Self, StageError> {
        let mut evidence = Self::default();
        Judged::read_all(rounds, bench)?.iter().for_each(|judged| evidence.add(judged));
        Ok(evidence)
    }

    /// Takes in what a round says, if people have sealed it.
    pub fn add(&mut self, judged: &Judged) {
        if !judged.counts() {
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
    pub fn status(&self, query: &QueryId) -> Option<Status> {
        self.0.get(query).map(|(status, _)| *status)
    }

    /// How people rejected the present wording of a query.
    pub fn why_rejected(&self, query: &QueryId) -> Option<&str> {
        self.0.get(query).filter(|(status, _)| *status == Status::Rejected).map(|(_, how)| how.as_str())
    }
}
