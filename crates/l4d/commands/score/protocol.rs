//! `l4d score --protocol`: the sums of other evaluations, in tables and files of their own.

use anyhow::Result;
use l4d_data::Report;
use l4d_data::workspace::default_scores;
use l4d_score::protocols::{Protocolled, judge_results, render};
use l4d_score::{EvalSet, Options, Protocol};

use crate::cli::judging::ScoreArgs;
use crate::out::{ExitStatus, Printer};

pub(super) fn run(
    args: &ScoreArgs,
    protocol: Protocol,
    eval_set: &EvalSet,
    options: &Options,
    mut report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    let scores =
        args.scores.clone().unwrap_or_else(|| default_scores(eval_set.set.as_str(), Some(protocol.as_str())));
    let progress = |name: &str| out.note(format!("read {name}"));
    let mut judged =
        judge_results(&args.results, eval_set, protocol, options, &scores, args.force, progress)?;
    report.extend(std::mem::take(&mut judged.report));
    let status = Printer::status(&report);
    if args.json {
        out.json(&Protocolled { report, ..judged }.into_document(eval_set))?;
        return Ok(status);
    }
    if !judged.sheets.is_empty() {
        out.data(render(protocol, &judged.sheets))?;
    }
    super::tell(report, out)?;
    if !judged.sheets.is_empty() {
        out.note(format!("values of every query are in {}/<method>/", scores.display()));
    }
    Ok(status)
}
