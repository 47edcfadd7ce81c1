//! `l4d verdict`: what the votes of a round say, and what follows from it for the queries.

mod check;
mod evidence;
mod judged;
mod rejected;
mod status;
mod table;

use std::collections::BTreeMap;

use anyhow::Result;
use l4d_data::store::write_atomic;
use l4d_data::{Benchmark, Finding, Query, QueryId, Severity, json};
use l4d_votes::agreement::{Agreement, measure};
use l4d_votes::files::{Refine, agreement_json, verdicts_csv};
use l4d_votes::verdict::{ItemVerdict, Outcome};
use serde_json::{Value, json};

use crate::cli::annotation::VerdictArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) use evidence::Evidence;
pub(crate) use judged::Judged;
use status::Change;

pub(crate) fn run(args: &VerdictArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench)?;
    let judged = Judged::read(&args.rounds, &args.round, &bench)?;
    if !args.unsealed
        && let Err(error) = judged.require_sealed()
    {
        // Why a ballot does not count as sealed may stand here: it was edited, or cut.
        warn(judged.notices.iter().filter(|notice| notice.severity == Severity::Error), out);
        return Err(error);
    }
    if args.check {
        return check::run(args, &judged, &bench, out);
    }
    let agreement = measure(&judged.round, &judged.key, &judged.responses);
    let changes = if args.unsealed { Vec::new() } else { status::changes(&judged, &args.rounds, &bench)? };
    if args.json {
        out.json(&document(&judged, &agreement, &changes))?;
    } else {
        out.data(table::render(&judged, &agreement))?;
        warn(findings(&judged).iter(), out);
    }
    if args.unsealed {
        out.note("only a look: nothing was written, and no status was set");
    } else {
        write(args, &judged, &agreement, &bench, out)?;
        status::apply(&changes)?;
        out.note(table::status_line(&judged, &changes));
    }
    let failed = findings(&judged).iter().any(|finding| finding.severity == Severity::Error);
    Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success })
}

/// Writes what follows from the votes; the verdicts come last, since with them the verdict is pronounced.
fn write(
    args: &VerdictArgs,
    judged: &Judged,
    agreement: &Agreement,
    bench: &Benchmark,
    out: &Printer,
) -> Result<()> {
    let Judged { dir, round, verdicts, changes, .. } = judged;
    let texts = current_texts(judged, bench)?;
    let refine: Vec<Refine> = verdicts
        .items
        .iter()
        .filter(|verdict| verdict.outcome != Outcome::Valid)
        .map(|verdict| Refine::of(verdict, texts.get(&verdict.query).cloned()))
        .collect();
    write_atomic(&dir.agreement(), &agreement_json(agreement)?)?;
    json::write_lines(&dir.refine(), &refine)?;
    let sheet = rejected::draw(args, judged, bench, out)?;
    write_atomic(&dir.verdicts(), &verdicts_csv(round, verdicts, changes)?)?;
    let sheet = if sheet { ", rejected.png" } else { "" };
    out.note(format!("verdicts.csv, agreement.json, refine.jsonl{sheet} stand in {}", dir.root().display()));
    Ok(())
}

/// The prompts as they read now.
fn current_texts(judged: &Judged, bench: &Benchmark) -> Result<BTreeMap<QueryId, String>> {
    let mut texts = BTreeMap::new();
    for scene in status::scenes(judged, bench) {
        let queries: Vec<Query> = [bench.queries(scene)?, bench.composites(scene)?].concat();
        texts.extend(queries.into_iter().map(|query| (query.id, query.text)));
    }
    Ok(texts)
}

fn document(judged: &Judged, agreement: &Agreement, changes: &[Change]) -> Value {
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
    let change = |change: &Change| json!({ "query": change.query, "from": change.from, "to": change.to });
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
        "findings": findings(judged),
    })
}

/// What reading and judging found, sorted.
fn findings(judged: &Judged) -> Vec<Finding> {
    let mut all: Vec<Finding> = judged.notices.iter().chain(&judged.verdicts.findings).cloned().collect();
    all.sort();
    all.dedup();
    all
}

fn warn<'a>(findings: impl Iterator<Item = &'a Finding>, out: &Printer) {
    for Finding { path, location, code, message, hint, .. } in findings {
        out.warn(format!("[{code}] {path}: {location}: {message}; {hint}"));
    }
}
