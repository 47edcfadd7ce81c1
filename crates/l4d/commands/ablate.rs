//! `l4d ablate`: the grids of the paper's ablations, beside the numbers that the paper prints.

use std::path::Path;

use anyhow::Result;
use l4d_data::store::Claim;
use l4d_data::{Benchmark, Report, StageError};
use l4d_experiments::ablation::{Ablation, Cell, Grid, ablate};
use l4d_ground::oracle::NoisePreset;
use l4d_score::EvalSet;
use serde_json::json;

use crate::cli::solver::{AblateArgs, GrounderArg, MethodArgs};
use crate::out::{ExitStatus, Printer, hint_of};
use crate::{figures, rasterizer, solver};

pub(crate) fn run(args: &AblateArgs, out: &Printer) -> Result<ExitStatus> {
    let is_oracle = args.method.grounder == GrounderArg::Oracle;
    let grid = args.grid;
    let bench = Benchmark::open(&args.bench.bench)?;
    let space = args.work.space(args.bench.profile);
    let mut report = Report::default();
    let eval_set = EvalSet::open(bench, args.bench.profile, grid.set(), &args.bench.scenes, &mut report)?;
    out.warnings(report);
    let noise = args.method.noise.as_deref().map(NoisePreset::read).transpose()?;
    let opened = rasterizer::open(&args.method.adapter.adapter)?;
    let folder = args.out.clone().unwrap_or_else(|| space.ablation(grid.table()));
    let open_grounders = |file: Option<&Path>| {
        let method = match file {
            Some(file) => MethodArgs {
                grounder: GrounderArg::Model,
                grounder_file: Some(file.to_owned()),
                ..args.method.clone()
            },
            None => args.method.clone(),
        };
        solver::open_one_of(&method, &space.shared(), out).map_err(|error| {
            StageError::of(
                error.as_ref(),
                hint_of(&error).unwrap_or_else(|| "see docs/panopticquery.md".to_owned()),
            )
        })
    };
    let names = ["csv", "md"].map(|ending| format!("{}.{ending}", grid.table()));
    let others = ["views.svg", "views.png", "calibration.csv"].map(str::to_owned);
    let _claim = Claim::take(&folder, names.into_iter().chain(others).collect(), None, args.force)?;
    let ablated = ablate(
        &Ablation {
            grid,
            eval_set: &eval_set,
            space: &space,
            folder: &folder,
            grounder: args.method.grounder.as_str(),
            oracle: is_oracle.then_some(noise),
            open_grounders: &open_grounders,
            method: args.method.choice(),
            correlations: args.correlations.clone(),
            calibrate: args.calibrate,
            view_counts: args.view_counts.clone(),
            grounder_files: args.grounder_files.clone(),
            seed: args.seed,
            jobs: args.jobs as usize,
            overwrite: args.force,
            rasterizer: opened.rasterizer.as_ref(),
            adapter: opened.adapter,
        },
        out,
    )?;
    let mut paths = ablated.paths.clone();
    if grid == Grid::Views {
        paths.extend(figures::publish_views(&ablated, &folder, out)?);
    }
    if args.json {
        let rows: Vec<&Cell> = ablated.cells.iter().chain(&ablated.differences).collect();
        out.json(&json!({
            "grid": grid.table(),
            "about": ablated.about,
            "left_out": ablated.left_out,
            "rows": rows,
        }))?;
    } else {
        out.data(&ablated.text)?;
    }
    paths.iter().for_each(|path| out.note(path.display()));
    Ok(ExitStatus::Success)
}
