//! `l4d bench lift`: seconds against mIoU of every lift.

use anyhow::Result;
use l4d_data::{Benchmark, Report};
use l4d_experiments::lift::{LiftRequest, bench, text};
use l4d_ground::oracle::NoisePreset;
use l4d_score::{EvalSet, QuerySet};
use serde_json::json;

use super::claim;
use crate::cli::solver::BenchLiftArgs;
use crate::out::{ExitStatus, Printer};
use crate::{figures, rasterizer};

pub(crate) fn run(args: &BenchLiftArgs, out: &Printer) -> Result<ExitStatus> {
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let bench_folder = Benchmark::open(&args.bench)?;
    let space = args.work.space(args.profile);
    let eval_set =
        EvalSet::open(bench_folder, args.profile, QuerySet::Queries, &args.scenes, &mut Report::default())?;
    let folder = args.out.clone().unwrap_or_else(|| space.shared().bench("lift"));
    let request = LiftRequest {
        eval_set: &eval_set,
        space: &space,
        noise: args.noise.as_deref().map(NoisePreset::read).transpose()?,
        views: args.view_count as usize,
        queries: args.queries as usize,
        is_quick: args.quick,
        folder: &folder,
        rasterizer: opened.rasterizer.as_ref(),
        adapter: opened.adapter.clone(),
    };
    let _claim = claim(&folder, "lift", args.force)?;
    let benched = bench(&request, out)?;
    let figures = figures::publish_lift(&benched, &opened.rasterizer.name(), &folder, out)?;
    match args.json {
        true => out.json(&json!({ "about": benched.about, "rows": benched.rows }))?,
        false => out.data(text(&benched.rows))?,
    }
    out.note(benched.about);
    for path in std::iter::once(&folder.join("lift.csv")).chain(&figures) {
        out.note(path.display());
    }
    Ok(ExitStatus::Success)
}
