//! What a release and a hosted benchmark say beside the data: by whom and when, and what people voted.

use std::path::Path;

use anyhow::Result;
use l4d_data::{Benchmark, QueryId};
use l4d_release::contents::Publication;
use l4d_release::gather::Source;
use l4d_release::votes::Round;
use l4d_release::{Day, Votes};
use l4d_votes::Outcome;
use l4d_votes::measure;
use l4d_votes::{Evidence, JudgedRound};

use crate::out::refusal;

/// What the data do not say.
pub(crate) fn publication(date: &Day, url: &str, creators: &[String]) -> Result<Publication> {
    if !url.starts_with("https://") && !url.starts_with("http://") {
        return Err(refusal(format!("`{url}` is no page"), "give --url as https://..."));
    }
    Ok(Publication { date: date.clone(), url: url.to_owned(), creators: creators.to_vec() })
}

/// Judges every sealed round of people in a folder of rounds; others are left where they are.
pub(crate) fn votes_of_people(rounds: &Path, bench: &Benchmark) -> Result<Votes> {
    let mut votes = Votes::default();
    let mut evidence = Evidence::default();
    for judged in JudgedRound::read_all(rounds, bench)?.iter().filter(|judged| judged.counts()) {
        evidence.add(judged);
        votes.rounds.push(facts(judged));
        votes.add_files(&format!("annotation/rounds/{}", judged.round.name), judged.dir.root())?;
    }
    if votes.rounds.is_empty() {
        return Ok(votes);
    }
    let guidelines = rounds.with_file_name("GUIDELINES.md");
    if guidelines.is_file() {
        votes.files.push(Source::read("annotation/GUIDELINES.md".to_owned(), guidelines)?);
    }
    for query in queries(bench)? {
        if let Some(status) = evidence.status(&query) {
            votes.statuses.insert(query, status);
        }
    }
    Ok(votes)
}

/// The queries that rounds ask about; what cannot be read is reported where the benchmark is read.
fn queries(bench: &Benchmark) -> Result<Vec<QueryId>> {
    let mut ids = Vec::new();
    for scene in bench.manifest.scenes.iter().filter(|scene| bench.dir.queries(scene).exists()) {
        let all = [bench.queries(scene)?, bench.composites(scene)?].concat();
        ids.extend(all.into_iter().map(|query| query.id));
    }
    Ok(ids)
}

/// The round as it was pronounced, agreement before anything was left out.
fn facts(judged: &JudgedRound) -> Round {
    let JudgedRound { round, key, responses, verdicts, .. } = judged;
    let overall = measure(round, key, responses).overall;
    Round {
        name: round.name.to_string(),
        rule: format!("unanimous:{}", round.annotators.len()),
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
