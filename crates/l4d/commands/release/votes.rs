//! What people's votes say of a benchmark, for those who only carry it: by the logic of `l4d verdict`.

use std::path::Path;

use anyhow::{Context as _, Result};
use l4d_data::store::list_folder;
use l4d_data::{Benchmark, QueryId};
use l4d_release::Votes;
use l4d_release::gather::Source;
use l4d_release::votes::Round;
use l4d_votes::RoundDir;
use l4d_votes::agreement::measure;
use l4d_votes::verdict::Outcome;

use crate::commands::verdict::{Evidence, Judged};

/// Judges every sealed round of people in a folder of rounds; others are left where they are.
pub(in crate::commands) fn of_people(rounds: &Path, bench: &Benchmark) -> Result<Votes> {
    let mut votes = Votes::default();
    let mut evidence = Evidence::default();
    if !rounds.exists() {
        return Ok(votes);
    }
    for name in list_folder(rounds)? {
        if !RoundDir::new(rounds.join(&name)).settings().exists() {
            continue;
        }
        let judged = Judged::read(rounds, &name, bench).with_context(|| format!("round {name}"))?;
        if judged.round.simulated || !judged.now.is_final {
            continue;
        }
        evidence.add(&judged);
        votes.rounds.push(facts(&judged));
        votes.add_files(&format!("annotation/rounds/{name}"), judged.dir.root())?;
    }
    let guidelines = rounds.with_file_name("GUIDELINES.md");
    if !votes.rounds.is_empty() && guidelines.is_file() {
        votes.files.push(Source::read("annotation/GUIDELINES.md".to_owned(), guidelines)?);
    }
    for query in queries(bench)? {
        if let Some(status) = evidence.status(&query) {
            votes.statuses.insert(query, status);
        }
    }
    Ok(votes)
}

/// The queries that rounds ask about; what cannot be read is reported by whoever gathers the benchmark.
fn queries(bench: &Benchmark) -> Result<Vec<QueryId>> {
    let mut ids = Vec::new();
    for scene in bench.manifest.scenes.iter().filter(|scene| bench.dir.queries(scene).exists()) {
        let all = [bench.queries(scene)?, bench.composites(scene)?].concat();
        ids.extend(all.into_iter().map(|query| query.id));
    }
    Ok(ids)
}

/// The round as it was pronounced, agreement before anything was left out.
fn facts(judged: &Judged) -> Round {
    let Judged { round, key, responses, verdicts, .. } = judged;
    let overall = measure(round, key, responses).overall;
    Round {
        name: round.name.to_string(),
        rule: round.rule.to_string(),
        annotators: round.annotators.len(),
        prompts: verdicts.items.len(),
        valid: verdicts.count(Outcome::Valid),
        rejected: verdicts.count(Outcome::Rejected),
        ceiling: overall.ceiling.value,
        raw: overall.right.raw.value,
        alpha: overall.right.alpha.value,
        ac1: overall.right.ac1.value,
    }
}
