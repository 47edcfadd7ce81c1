//! One row: answered into a folder of the ablation's own, then judged.

use l4d_data::{At as _, Progress, QueryId, Severity, StageError};
use l4d_score::metrics::QueryTally;
use l4d_score::score::{counts_path, tallies_of_counts};
use l4d_score::{Options, Scored, counts, score_results};
use l4d_solve::batch::{Batch, pick};
use l4d_solve::grounders::Grounders;
use l4d_splat::source::ReaderOptions;

use super::Ablation;
use super::grid::Variant;
use crate::Result;

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
pub(super) fn measure(variant: &Variant, order: &Ablation<'_>, progress: &dyn Progress) -> Result<Measured> {
    let Ablation { eval_set, folder, .. } = order;
    let (results, scores) = (folder.join("results"), folder.join("scores"));
    progress.note(&format_args!("\n{}", variant.setting));
    answer(variant, order, progress).at(format_args!("row `{}`", variant.setting))?;

    let options = Options::default();
    let Scored { summaries, report } =
        score_results(&results.join(variant.name.as_str()), eval_set, &options, &scores, false, |_| {})?;
    let Some(summary) = summaries.into_iter().next() else {
        let findings = report.into_sorted();
        let first = findings.iter().find(|finding| finding.severity == Severity::Error);
        let why = first.map(|finding| format!("{}: {}", finding.path, finding.message)).unwrap_or_default();
        return Err(StageError::new(
            format!("row `{}` cannot be scored: {why}", variant.setting),
            "replace its answers with --force",
        ));
    };
    let rows = counts::read(&counts_path(&scores, &summary.name))?;
    Ok(Measured {
        setting: variant.setting.clone(),
        tallies: tallies_of_counts(&rows, eval_set, &options),
        uses_truth: summary.used.ground_truth,
    })
}

fn answer(variant: &Variant, order: &Ablation<'_>, progress: &dyn Progress) -> Result<()> {
    let grounders = match &variant.noise {
        Some(noise) => Grounders::Oracle(noise.clone()),
        None => (order.open_grounders)(variant.grounder_file.as_deref())?,
    };
    let batch = Batch {
        name: variant.name.clone(),
        space: order.space.clone(),
        results: order.folder.join("results"),
        answers: Some(order.folder.join("answers").join(variant.name.as_str())),
        grounders: &grounders,
        settings: variant.method.solve_settings(),
        clips: variant.method.clip_settings(None),
        rasterizer: order.rasterizer,
        adapter: order.adapter.clone(),
        control: None,
        jobs: order.jobs,
        overwrite: order.overwrite,
        used_depth: false,
        reader_options: ReaderOptions::default(),
    };
    let scenes: Vec<_> = order.eval_set.scenes.iter().map(|scene| scene.name.clone()).collect();
    let everything: &[QueryId] = &[];
    let picked = pick(&order.eval_set.bench, order.eval_set.set, &scenes, everything, None)?;
    batch.run(&order.eval_set.bench, &scenes, &picked, progress)?.tell(progress);
    Ok(())
}
