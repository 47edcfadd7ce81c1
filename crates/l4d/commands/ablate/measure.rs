//! One row: `solve` into a folder of the ablation's own, judged by `score`.

use std::path::Path;

use anyhow::{Context as _, Result};
use l4d_score::metrics::QueryTally;
use l4d_score::score::{counts_path, tallies_of_counts};
use l4d_score::{Exam, Options, Scored, counts, score_results};

use super::grid::Variant;
use crate::cli::BenchArgs;
use crate::cli::solver::{AblateArgs, SolveArgs};
use crate::commands::solve;
use crate::out::{Printer, refusal};

/// What came of a run.
#[derive(Debug)]
pub(super) struct Measured {
    /// The row.
    pub(super) setting: String,
    /// Query by query.
    pub(super) tallies: Vec<QueryTally>,
    /// Whether the truth was looked at.
    pub(super) uses_truth: bool,
}

/// Answers what is not answered yet, and scores all of it.
pub(super) fn measure(
    variant: &Variant,
    args: &AblateArgs,
    exam: &Exam,
    folder: &Path,
    out: &Printer,
) -> Result<Measured> {
    let (results, scores) = (folder.join("results"), folder.join("scores"));
    let solve = SolveArgs {
        bench: BenchArgs {
            scenes: exam.scenes.iter().map(|scene| scene.name.to_string()).collect(),
            ..args.bench.clone()
        },
        method: variant.method.clone(),
        work: args.work.clone(),
        set: args.grid.asked(),
        queries: Vec::new(),
        name: Some(variant.name.to_string()),
        results: results.clone(),
        answers: Some(folder.join("answers").join(variant.name.as_str())),
        jobs: args.jobs,
        shard: None,
        used_depth: false,
        overwrite: args.overwrite,
        dry_run: false,
        json: false,
    };
    out.note(format!("\n{}", variant.setting));
    solve::answer_quietly(&solve, out).with_context(|| format!("row `{}`", variant.setting))?;

    let options = Options::default();
    let Scored { summaries, report } =
        score_results(&results.join(variant.name.as_str()), exam, &options, &scores, |_| {})?;
    let Some(summary) = summaries.into_iter().next() else {
        let findings = report.into_sorted();
        let first = findings.iter().find(|finding| finding.severity == l4d_data::Severity::Error);
        let why = first.map(|finding| format!("{}: {}", finding.path, finding.message)).unwrap_or_default();
        return Err(refusal(
            format!("row `{}` cannot be scored: {why}", variant.setting),
            "replace its answers with --overwrite",
        ));
    };
    let rows = counts::read(&counts_path(&scores, &summary.name))?;
    Ok(Measured {
        setting: variant.setting.clone(),
        tallies: tallies_of_counts(&rows, exam, &options),
        uses_truth: summary.used.ground_truth,
    })
}
