//! `l4d cluster init`: settings, profile and estimate for a run of the workflow.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_blender::env::scripts_folder;
use l4d_blender::python::Environment;
use l4d_cluster::estimate::Estimate;
use l4d_cluster::limits::Limits;
use l4d_cluster::settings::{Engine, Settings};
use l4d_cluster::sizes::CORES;
use l4d_data::store::{holds, write_atomic};
use l4d_data::{Benchmark, DataError, Name, Workspace};

use crate::cli::cluster::{ClusterCommand, ClusterInitArgs};
use crate::out::{ExitStatus, Printer, refusal, table};

/// Of a cluster, where nothing else is said.
const JOBS: u64 = 100;

pub(crate) fn run(command: &ClusterCommand, out: &Printer) -> Result<ExitStatus> {
    match command {
        ClusterCommand::Init(args) => init(args, out),
    }
}

fn init(args: &ClusterInitArgs, out: &Printer) -> Result<ExitStatus> {
    let is_slurm = args.engine == Engine::Slurm;
    let bench = Benchmark::open(&args.bench.bench)?;
    let scenes = bench.select(&args.bench.scenes)?;
    let queries = scenes.iter().map(|scene| Ok(bench.queries(scene)?.len())).collect::<Result<Vec<_>>>()?;
    let estimate = Estimate::new(args.bench.profile, &queries, args.runtime)?;
    let limits = is_slurm.then(|| Limits::ask(args.account.as_deref()));
    let settings = settings(args, &scenes, limits.as_ref())?;

    let environment = environment(&settings);
    let python = if args.install { Some(environment.python()?) } else { None };
    let commands = commands(&settings, python.as_deref());
    let rows = table(&estimate.rows());
    let hint = "pass --force to replace it, or name another folder";
    let files = settings.files(&estimate, &rows, &commands)?;
    // All are looked at before the first is written.
    let mut stale = Vec::new();
    for (path, text) in &files {
        if !holds(path, text.as_bytes(), args.force, hint)? {
            stale.push((path, text));
        }
    }
    stale.iter().try_for_each(|(path, text)| write_atomic(path, text.as_bytes()))?;
    if args.install {
        environment.find_or_make(out)?;
    }

    out.data(&rows)?;
    estimate.remarks().iter().try_for_each(|remark| out.data(remark))?;
    limits.iter().flat_map(Limits::sentences).for_each(|sentence| out.note(sentence));
    if args.jobs.is_some_and(|asked| asked > settings.jobs) {
        out.warn(format!(
            "--jobs: the cluster lets you submit {} at once, which is what was written",
            settings.jobs
        ));
    }
    for (path, _) in &files {
        out.data(path.display())?;
    }
    out.note(format!("to be typed:\n{commands}"));
    if args.engine == Engine::Kubernetes {
        out.note(format!(
            "what is in capitals in {} has to be yours; no cluster has tried this profile",
            settings.profile_folder().join("config.yaml").display()
        ));
    }
    Ok(ExitStatus::Success)
}

fn settings<'a>(
    args: &'a ClusterInitArgs,
    scenes: &'a [Name],
    limits: Option<&Limits>,
) -> Result<Settings<'a>> {
    let profile = args.bench.profile;
    let space = Workspace::new(profile).with_data(args.data.as_deref());
    let workflow = absolute(&args.workflow)?;
    if !workflow.join("Snakefile").is_file() {
        return Err(refusal(
            format!("{}: the workflow is not there", workflow.join("Snakefile").display()),
            "run l4d in the project's root folder, or name the folder with --workflow",
        ));
    }
    let program = std::env::current_exe().map_err(|error| DataError::io(Path::new("l4d"), "find", error))?;
    let here = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let (jobs, cores) = match (args.engine, args.jobs) {
        (Engine::Local, jobs) => (1, (here / usize::try_from(jobs.unwrap_or(1)).unwrap_or(here)).max(1)),
        (_, jobs) => {
            (limits.map_or(jobs.unwrap_or(JOBS), |limits| limits.at_most(jobs.unwrap_or(JOBS))), CORES)
        }
    };
    Ok(Settings {
        folder: absolute(&args.dir)?,
        engine: args.engine,
        partition: args.partition.as_deref(),
        account: args.account.as_deref(),
        jobs,
        minutes: args.runtime,
        cores,
        has_accounting: limits.is_some_and(|limits| limits.has_accounting),
        l4d: program,
        workflow,
        blender_scripts: scripts_folder(&args.python.blender_scripts)?,
        python: args.python.python.as_deref().map(absolute).transpose()?,
        profile,
        bench: absolute(&args.bench.bench)?,
        scenes: if args.bench.scenes.is_empty() { &[] } else { scenes },
        data: absolute(space.data())?,
        training: absolute(Path::new("data/training"))?,
        work: absolute(&args.python.work)?,
        results: absolute(&args.results)?,
        scores: absolute(&args.scores)?,
        leaderboard: absolute(&args.leaderboard)?,
    })
}

/// Of the workflow, as the Blender environment is made.
fn environment(settings: &Settings<'_>) -> Environment {
    Environment {
        requirements: settings.workflow.join("requirements.txt"),
        kind_folder: settings.folder.join("env"),
        name: "the environment of the workflow",
        holds: "Snakemake and its plugins; about 400 MB",
    }
}

/// What starts the workflow, and what makes its environment if that has not been done.
fn commands(settings: &Settings<'_>, python: Option<&Path>) -> String {
    let profile = settings.profile_folder();
    let start =
        |bin: &Path| format!("{} --workflow-profile {}", bin.join("snakemake").display(), profile.display());
    if let Some(bin) = python.and_then(Path::parent) {
        return start(bin);
    }
    let (env, requirements) = (settings.folder.join("env"), settings.workflow.join("requirements.txt"));
    let bin = env.join("bin");
    format!(
        "python3.11 -m venv {}\n{} install -r {}\n{}",
        env.display(),
        bin.join("pip").display(),
        requirements.display(),
        start(&bin)
    )
}

fn absolute(path: &Path) -> Result<PathBuf> {
    Ok(std::path::absolute(path).map_err(|error| DataError::io(path, "resolve", error))?)
}
