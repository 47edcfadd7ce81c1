//! `l4d score --protocol`: the sums of other evaluations, in tables and files of their own.

use anyhow::Result;
use l4d_data::Report;
use l4d_data::workspace::default_scores;
use l4d_score::protocols::{OnMissing, Protocolled, judge_results, render};
use l4d_score::{Exam, Missing, Options, Protocol};

use crate::cli::judging::ScoreArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(super) fn run(
    args: &ScoreArgs,
    protocol: Protocol,
    exam: &Exam,
    options: &Options,
    mut report: Report,
    out: &Printer,
) -> Result<ExitStatus> {
    if options.hit_iou > 0.0 {
        return Err(refusal(
            format!("--hit-iou is no part of the protocol {protocol}"),
            "drop it, or score with --protocol l4d",
        ));
    }
    if options.missing != Missing::Error && protocol.rules().on_missing == OnMissing::OwnRule {
        return Err(refusal(
            format!("the protocol {protocol} says itself what a missing mask means"),
            "drop --missing",
        ));
    }
    let scores =
        args.scores.clone().unwrap_or_else(|| default_scores(exam.set.as_str(), Some(protocol.as_str())));
    let progress = |name: &str| out.note(format!("read {name}"));
    let mut judged = judge_results(&args.results, exam, protocol, options, &scores, args.force, progress)?;
    report.extend(std::mem::take(&mut judged.report));
    let status = Printer::status(&report);
    if args.json {
        out.json(&Protocolled { report, ..judged }.into_document(exam))?;
        return Ok(status);
    }
    if !judged.sheets.is_empty() {
        out.data(render(protocol, &judged.sheets))?;
    }
    out.any_findings(report)?;
    if !judged.sheets.is_empty() {
        out.note(format!("values of every query are in {}/<method>/", scores.display()));
    }
    Ok(status)
}
