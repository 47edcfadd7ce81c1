//! The files of a verdict: what `l4d verdict` writes, and whether what is there follows from the votes.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{Benchmark, Query, QueryId, Report, StageError, json};
use serde_json::{Value, json};

use super::Judged;
use super::statuses::{self, StatusChange};
use crate::agreement::{Agreement, measure};
use crate::files::{Refine, agreement_json, verdicts_csv};
use crate::verdict::{ItemVerdict, Outcome};

/// No derived file is larger.
const MAX_BYTES: u64 = 64 << 20;

/// Writes `agreement.json` and `refine.jsonl`. The verdicts come last ([`pronounce`]): with them the verdict counts.
///
/// # Errors
/// Queries that cannot be read, or what the disk refuses.
pub fn write(judged: &Judged, agreement: &Agreement, bench: &Benchmark) -> Result<(), StageError> {
    let texts = current_texts(judged, bench)?;
    let open = judged.verdicts.items.iter().filter(|verdict| verdict.outcome != Outcome::Valid);
    let refine: Vec<Refine> =
        open.map(|verdict| Refine::of(verdict, texts.get(&verdict.query).cloned())).collect();
    write_atomic(&judged.dir.agreement(), &agreement_bytes(agreement)?)?;
    Ok(json::write_lines(&judged.dir.refine(), &refine)?)
}

/// Writes `verdicts.csv`.
///
/// # Errors
/// What the disk refuses.
pub fn pronounce(judged: &Judged) -> Result<(), StageError> {
    Ok(write_atomic(&judged.dir.verdicts(), &verdict_bytes(judged)?)?)
}

/// `l4d verdict --check`: L4D530 where a file differs from what the votes give, L4D531 where a status does.
///
/// # Errors
/// Files that cannot be read.
pub fn check(judged: &Judged, rounds: &Path, bench: &Benchmark) -> Result<Report, StageError> {
    let mut report = Report::default();
    judged.findings().into_iter().for_each(|finding| report.add(finding));
    let agreement = measure(&judged.round, &judged.key, &judged.responses);
    let hint = format!("run `l4d verdict --round {}`", judged.round.name);
    for (path, bytes) in [
        (judged.dir.verdicts(), verdict_bytes(judged)?),
        (judged.dir.agreement(), agreement_bytes(&agreement)?),
    ] {
        if !path.exists() {
            report.error("L4D530", &path, "file", "is missing", &hint);
        } else if read_bounded(&path, MAX_BYTES)? != bytes {
            report.error("L4D530", &path, "bytes", "are not what the votes give", &hint);
        }
    }
    for StatusChange { query, file, from, to } in statuses::changes(judged, rounds, bench)? {
        let (from, to) = (from.as_str(), to.as_str());
        let message = format!("is {from}, but by the votes of people it is {to}");
        let place = format!("query {query}, field `status`");
        report.error("L4D531", &file, place, message, format!("{hint}: nothing else sets it"));
    }
    Ok(report)
}

/// What `l4d verdict --json` prints.
pub fn document(judged: &Judged, agreement: &Agreement, changes: &[StatusChange]) -> Value {
    let Judged { round, verdicts, .. } = judged;
    let verdict = |verdict: &ItemVerdict| {
        json!({
            "item": verdict.item,
            "query": verdict.query,
            "outcome": verdict.outcome,
            "pattern": verdict.pattern(),
            "right": verdict.right(),
            "counted": verdict.counted(),
            "reasons": verdict.reasons,
        })
    };
    let change =
        |change: &StatusChange| json!({ "query": change.query, "from": change.from, "to": change.to });
    let counts: BTreeMap<&str, usize> =
        Outcome::ALL.into_iter().map(|outcome| (outcome.as_str(), verdicts.count(outcome))).collect();
    json!({
        "round": round.name,
        "simulated": round.simulated,
        "final": verdicts.is_final,
        "rule": round.rule,
        "queries": verdicts.items.len(),
        "outcomes": counts,
        "verdicts": verdicts.items.iter().map(verdict).collect::<Vec<_>>(),
        "agreement": agreement,
        "status": changes.iter().map(change).collect::<Vec<_>>(),
        "findings": judged.findings(),
    })
}

/// The prompts as they read now.
fn current_texts(judged: &Judged, bench: &Benchmark) -> Result<BTreeMap<QueryId, String>, StageError> {
    let mut texts = BTreeMap::new();
    for scene in judged.scenes(bench) {
        let queries: Vec<Query> = [bench.queries(scene)?, bench.composites(scene)?].concat();
        texts.extend(queries.into_iter().map(|query| (query.id, query.text)));
    }
    Ok(texts)
}

fn agreement_bytes(agreement: &Agreement) -> Result<Vec<u8>, StageError> {
    agreement_json(agreement).map_err(|error| StageError::of(&error, None))
}

fn verdict_bytes(judged: &Judged) -> Result<Vec<u8>, StageError> {
    let Judged { round, verdicts, changes, .. } = judged;
    verdicts_csv(round, verdicts, changes).map_err(|error| StageError::of(&error, None))
}
