//! `l4d verdict`: what the votes of a round say, and what follows from it for the queries.

use anyhow::Result;
use l4d_data::{Benchmark, Finding, Severity};
use l4d_votes::judged::{JudgedRound, files, render, status_line, statuses};
use l4d_votes::measure;

use crate::cli::annotation::VerdictArgs;
use crate::out::{ExitStatus, Printer};
use crate::shipped;

pub(crate) fn run(args: &VerdictArgs, out: &Printer) -> Result<ExitStatus> {
    if !args.unsealed && !args.check {
        shipped::require_own(&args.bench)?;
    }
    let bench = Benchmark::open(&args.bench)?;
    let judged = JudgedRound::read(&args.rounds, &args.round, &bench)?;
    if !args.unsealed
        && let Err(error) = judged.require_sealed()
    {
        // Why a ballot does not count as sealed may be among them: it was edited, or cut.
        warn(judged.notices.iter().filter(|notice| notice.severity == Severity::Error), out);
        return Err(error.into());
    }
    if args.check {
        return out.findings(files::check(&judged, &args.rounds, &bench)?, args.json);
    }
    let agreement = measure(&judged.round, &judged.key, &judged.responses);
    let changes = if args.unsealed { Vec::new() } else { statuses::changes(&judged, &args.rounds, &bench)? };
    let findings = judged.findings();
    if args.json {
        out.json(&files::document(&judged, &agreement, &changes))?;
    } else {
        out.data(render(&judged, &agreement))?;
        warn(findings.iter(), out);
    }
    if args.unsealed {
        out.note("only a look: nothing was written, and no status was set");
    } else {
        let claim = files::claim(&judged, args.force)?;
        files::write(&judged, &agreement, &bench)?;
        files::pronounce(&judged)?;
        drop(claim);
        let folder = judged.dir.root().display();
        out.note(format!("verdicts.csv, agreement.json and refine.jsonl are in {folder}"));
        statuses::apply(&changes)?;
        out.note(status_line(&judged, &changes));
    }
    let failed = findings.iter().any(|finding| finding.severity == Severity::Error);
    Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success })
}

fn warn<'a>(findings: impl Iterator<Item = &'a Finding>, out: &Printer) {
    for Finding { path, location, code, message, hint, .. } in findings {
        out.warn(format!("[{code}] {path}: {location}: {message}; {hint}"));
    }
}
