//! From verdicts to the `status` of queries: the one place that changes it.
//!
//! What people understood becomes verified, what they did not is rejected. A query whose present wording nobody has
//! judged cannot stay verified: it is a candidate again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::status::set_statuses;
use l4d_data::{Benchmark, Name, Query, QueryId, Status};

use super::evidence::Evidence;
use super::judged::Judged;

/// A query whose status is not the one that the votes give it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) query: QueryId,
    pub(super) file: PathBuf,
    pub(super) from: Status,
    pub(super) to: Status,
}

/// Scenes of a round that the benchmark still has.
pub(super) fn scenes<'a>(judged: &Judged, bench: &'a Benchmark) -> Vec<&'a Name> {
    let asked: BTreeSet<&Name> = judged.now.items.iter().map(|item| &item.query.scene).collect();
    bench.manifest.scenes.iter().filter(|scene| asked.contains(scene)).collect()
}

/// What has to change in the queries that a round of people asked about. Votes of programs change nothing.
pub(super) fn changes(judged: &Judged, rounds: &Path, bench: &Benchmark) -> Result<Vec<Change>> {
    if judged.round.simulated {
        return Ok(Vec::new());
    }
    let evidence = Evidence::gather(rounds, bench)?;
    let asked: BTreeSet<&QueryId> = judged.now.items.iter().map(|item| &item.query).collect();
    let mut changes = Vec::new();
    for scene in scenes(judged, bench) {
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
                    changes.push(Change { query, file: file.clone(), from, to });
                }
            }
        }
    }
    Ok(changes)
}

/// Writes the changes, one file at a time; a killed run is finished by the next.
pub(super) fn apply(changes: &[Change]) -> Result<()> {
    let mut files: BTreeMap<&Path, BTreeMap<QueryId, Status>> = BTreeMap::new();
    for Change { query, file, to, .. } in changes {
        files.entry(file).or_default().insert(query.clone(), *to);
    }
    for (file, wanted) in files {
        set_statuses(file, &wanted)?;
    }
    Ok(())
}
