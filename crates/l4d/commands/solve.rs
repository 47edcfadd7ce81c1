//! `l4d solve`: PanopticQuery over queries and scenes, into a folder of results.

use anyhow::{Context as _, Result};
use l4d_data::{Benchmark, Name, QueryId, Report};
use l4d_solve::batch::{Batch, Picked, pick};

use crate::cli::solver::SolveArgs;
use crate::models::print_estimate;
use crate::out::{ExitStatus, Printer, refusal};
use crate::{rasterizer, readmes, solver};

pub(crate) fn run(args: &SolveArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let selected = bench.select(&args.bench.scenes)?;
    let ids = args.queries.iter().map(|id| Ok(id.parse()?)).collect::<Result<Vec<QueryId>>>()?;
    let picked = pick(&bench, args.set, &selected, &ids, args.shard)?;
    let space = args.work.space(args.bench.profile);
    let grounders = solver::open_grounders(&args.method, &space.shared(), out)?;
    let opened = rasterizer::open(&args.method.adapter.adapter)?;
    let method = args.method.choice();
    let default_name = || {
        let name = method.default_name(args.method.grounder.as_str(), args.method.noise.is_some(), args.set);
        match args.control {
            Some(control) => format!("{name}-{}", control.as_str()),
            None => name,
        }
    };
    let batch = Batch {
        name: Name::new(args.name.clone().unwrap_or_else(default_name))?,
        space,
        results: args.results.clone(),
        answers: args.answers.clone(),
        grounders: &grounders,
        settings: method.solve_settings(),
        clips: method.clip_settings(None),
        rasterizer: opened.rasterizer.as_ref(),
        adapter: opened.adapter,
        control: args.control,
        jobs: args.jobs as usize,
        overwrite: args.force,
        used_depth: args.used_depth,
        reader_options: args.reader.options(),
    };
    if args.dry_run {
        return estimate(args, &batch, &picked, out);
    }
    let ledger = batch.run(&bench, &selected, &picked, out)?;
    readmes::leave(&args.results, readmes::RESULTS)?;
    match args.json {
        true => out.json(&ledger.document(&batch.name))?,
        false => out.data(ledger.table())?,
    }
    ledger.tell(out);
    out.note(format!("results are in {}", batch.results_dir().root().display()));
    Ok(ExitStatus::Success)
}

/// What a vision-language model would be asked about the queries that are not answered yet.
fn estimate(args: &SolveArgs, batch: &Batch<'_>, picked: &[Picked], out: &Printer) -> Result<ExitStatus> {
    let Some(vlm) = batch.grounders.vlm() else {
        return Err(refusal(
            format!("grounder {} asks no model server", args.method.grounder.as_str()),
            "leave out --dry-run, or ask a model with --grounder model",
        ));
    };
    let plan = |scene: &Picked| {
        let plan = batch.plan(scene, vlm).with_context(|| scene.name.to_string())?;
        Ok((scene.name.to_string(), plan))
    };
    let plans = picked.iter().map(plan).collect::<Result<Vec<_>>>()?;
    print_estimate("scene", &plans, vlm.endpoint(), args.json, Report::default(), out)
}
