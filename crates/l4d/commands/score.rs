//! `l4d score`: masks of methods in, counts and tables out.

mod protocol;

use std::path::Path;

use anyhow::Result;
use l4d_data::workspace::default_scores;
use l4d_data::{Benchmark, DataError, Report, counted};
use l4d_score::results::MEGABYTE;
use l4d_score::score::{counts_path, tallies_of_counts};
use l4d_score::{EvalSet, Group, Options, QuerySet, Scored, Summary, counts, groups, score_results, table};
use serde_json::Value;

use crate::cli::judging::{ProtocolArg, ScoreArgs};
use crate::out::{ExitStatus, Printer};
use crate::readmes;

pub(crate) fn run(args: &ScoreArgs, out: &Printer) -> Result<ExitStatus> {
    let options = Options {
        missing: args.missing,
        hit_iou: args.hit_iou,
        verified_only: args.verified_only,
        resize: args.resize,
    };
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let set = match args.protocol {
        ProtocolArg::L4d => args.set,
        ProtocolArg::Other(protocol) => protocol.set(args.set),
    };
    let mut eval_set = EvalSet::open(bench, args.bench.profile, set, &args.bench.scenes, &mut report)?;
    eval_set.most_bytes = args.max_megabytes.saturating_mul(MEGABYTE);
    if let ProtocolArg::Other(protocol) = args.protocol {
        return protocol::run(args, protocol, &eval_set, &options, report, out);
    }
    let scores = args.scores.clone().unwrap_or_else(|| default_scores(eval_set.set.as_str(), None));
    let mut scored = score_results(&args.results, &eval_set, &options, &scores, args.force, |name| {
        out.note(format!("read {name}"));
    })?;
    report.extend(std::mem::take(&mut scored.report));
    readmes::leave(&scores, readmes::SCORES)?;
    let status = Printer::status(&report);
    let grouped: Vec<Vec<Group>> = match args.groups {
        true => grouped(&scored.summaries, &eval_set, &scores, args.seed)?,
        false => Vec::new(),
    };
    if args.json {
        let mut document = Scored { report, ..scored }.into_document(&eval_set);
        add_groups(&mut document, &grouped)?;
        out.json(&document)?;
        return Ok(status);
    }
    let summaries = scored.summaries;
    if !summaries.is_empty() {
        out.data(table::render(&summaries))?;
        for (summary, groups) in summaries.iter().zip(&grouped) {
            out.data(table::render_groups(&summary.name, groups))?;
        }
        out.data(footer(&summaries, &eval_set))?;
    }
    tell(report, out)?;
    if !summaries.is_empty() {
        out.note(format!("counts and summaries are in {}/<method>/", scores.display()));
    }
    Ok(status)
}

/// What was found, by cause.
fn tell(report: Report, out: &Printer) -> Result<()> {
    if !report.is_empty() {
        out.causes(report, "`l4d check-results --all` lists each")?;
    }
    Ok(())
}

/// From the rows that were just written, as anyone else has them.
fn grouped(
    summaries: &[Summary],
    eval_set: &EvalSet,
    scores: &Path,
    seed: u64,
) -> Result<Vec<Vec<Group>>, DataError> {
    let of_method = |summary: &Summary| {
        let rows = counts::read(&counts_path(scores, &summary.name))?;
        Ok(groups(&tallies_of_counts(&rows, eval_set, &summary.options), eval_set, |_| true, seed))
    };
    summaries.iter().map(of_method).collect()
}

/// Beside the other numbers of each method.
fn add_groups(document: &mut Value, grouped: &[Vec<Group>]) -> Result<()> {
    let methods = document["methods"].as_array_mut().into_iter().flatten();
    for (method, groups) in methods.zip(grouped) {
        method["groups"] = serde_json::to_value(groups)?;
    }
    Ok(())
}

/// What the numbers rest on.
fn footer(summaries: &[Summary], eval_set: &EvalSet) -> String {
    let Some(first) = summaries.first() else { return String::new() };
    let mut text = format!(
        "{} {}, profile {}, {}: {} of {} scored prompts are verified by people.",
        eval_set.bench.manifest.name,
        eval_set.bench.manifest.version,
        eval_set.profile,
        counted(eval_set.scenes.len(), "scene"),
        first.verified_queries,
        first.asked_queries,
    );
    if first.set != QuerySet::default() {
        text.push_str(&format!("\nOf the set `{}`, which is no part of the headline.", first.set.as_str()));
    }
    if first.options.verified_only {
        text.push_str("\nOnly verified prompts are scored.");
    }
    if first.rejected_queries > 0 {
        let noun = if first.rejected_queries == 1 { "prompt" } else { "prompts" };
        text.push_str(&format!("\nLeft out: {} {noun} that people rejected.", first.rejected_queries));
    }
    if first.options.hit_iou > 0.0 {
        text.push_str(&format!("\nmAcc counts frames whose IoU is above {}.", first.options.hit_iou));
    }
    let missing: Vec<&Summary> = summaries.iter().filter(|summary| summary.missing_frames > 0).collect();
    for summary in missing {
        let how = if summary.partial { "left out" } else { "counted as empty" };
        text.push_str(&format!(
            "\n{}: {} without an answer {how}.",
            summary.name,
            counted(summary.missing_frames as usize, "frame")
        ));
    }
    text
}
