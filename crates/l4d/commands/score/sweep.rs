//! `l4d score --sweep`: curves over thresholds, in tables and files of their own.

use anyhow::Result;
use l4d_data::Report;
use l4d_data::workspace::default_scores;
use l4d_score::sweep::{LABEL, render, sweep_results};
use l4d_score::{Exam, Options};
use serde_json::json;

use crate::cli::judging::ScoreArgs;
use crate::out::{ExitStatus, Printer};

pub(super) fn run(
    args: &ScoreArgs,
    exam: &Exam,
    options: &Options,
    mut report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    let folder = args.scores.clone().unwrap_or_else(|| default_scores(exam.set.as_str(), Some("sweep")));
    let progress = |name: &str| out.note(format!("read {name}"));
    let sweeps = sweep_results(&args.results, exam, options, &folder, &mut report, progress)?;
    if args.json {
        let document = json!({
            "sweep": LABEL,
            "is_headline": false,
            "profile": exam.profile,
            "set": exam.set,
            "benchmark_version": exam.bench.manifest.version,
            "truth_digest": exam.truth_digest,
            "methods": sweeps,
        });
        return out.document(document, report);
    }
    if !sweeps.is_empty() {
        out.data(render(&sweeps))?;
    }
    let status = out.any_findings(report)?;
    if !sweeps.is_empty() {
        out.note(format!("all thresholds are in {}/<method>/sweep.csv", folder.display()));
    }
    Ok(status)
}
