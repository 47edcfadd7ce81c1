//! From verdicts to the `status` of queries: the one place that changes it.
//!
//! What people understood becomes verified, what they did not is rejected; a query whose present wording was never
//! judged is a candidate again. A wording that one panel rejected stays rejected: asking again until it passes would
//! make any prompt unambiguous.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::status::set_statuses;
use l4d_data::{Benchmark, DataError, Query, QueryId, StageError, Status};

use super::JudgedRound;
use crate::verdict::Outcome;

/// For each query whose present wording people have judged: verified or rejected, where and how.
#[derive(Debug, Default)]
pub struct Evidence(BTreeMap<QueryId, (Status, String)>);

impl Evidence {
    /// Judges every sealed round of people in a folder of rounds.
    ///
    /// # Errors
    /// As [`JudgedRound::read`].
    pub fn gather(rounds: &Path, bench: &Benchmark) -> Result<Self, StageError> {
        let mut evidence = Self::default();
        JudgedRound::read_all(rounds, bench)?.iter().for_each(|judged| evidence.add(judged));
        Ok(evidence)
    }

    /// Takes in what a round says, if people have sealed it.
    pub fn add(&mut self, judged: &JudgedRound) {
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

/// A query whose status is not the one that the votes give it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StatusChange {
    pub query: QueryId,
    /// Where it is written.
    pub file: PathBuf,
    /// What it is.
    pub from: Status,
    /// What the votes make it.
    pub to: Status,
}

/// What has to change in the queries that a round of people asked about. Votes of programs change nothing.
///
/// # Errors
/// Queries or rounds that cannot be read.
pub fn changes(
    judged: &JudgedRound,
    rounds: &Path,
    bench: &Benchmark,
) -> Result<Vec<StatusChange>, StageError> {
    if judged.round.simulated {
        return Ok(Vec::new());
    }
    let evidence = Evidence::gather(rounds, bench)?;
    let asked: BTreeSet<&QueryId> = judged.now.items.iter().map(|item| &item.query).collect();
    let mut changes = Vec::new();
    for scene in judged.scenes(bench) {
        let files = [
            (bench.dir.queries(scene), bench.queries(scene)?),
            (bench.dir.composites(scene), bench.composites(scene)?),
        ];
        for (file, queries) in files {
            for Query { id: query, status: from, .. } in
                queries.into_iter().filter(|query| asked.contains(&query.id))
            {
                let to = match (evidence.status(&query), from) {
                    (Some(status), _) => status,
                    (None, Status::Verified) => Status::Candidate,
                    (None, from) => from,
                };
                if to != from {
                    changes.push(StatusChange { query, file: file.clone(), from, to });
                }
            }
        }
    }
    Ok(changes)
}

/// Writes the changes, one file at a time; a killed run is finished by the next.
///
/// # Errors
/// A file of queries that cannot be read or written.
pub fn apply(changes: &[StatusChange]) -> Result<(), DataError> {
    let mut files: BTreeMap<&Path, BTreeMap<QueryId, Status>> = BTreeMap::new();
    for StatusChange { query, file, to, .. } in changes {
        files.entry(file).or_default().insert(query.clone(), *to);
    }
    for (file, wanted) in files {
        set_statuses(file, &wanted)?;
    }
    Ok(())
}
