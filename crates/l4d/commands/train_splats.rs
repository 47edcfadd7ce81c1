//! `l4d train-splats`: a 4D model of a scene, learned from its training cameras.

use std::path::Path;
use std::time::Duration;

use anyhow::Result;
use l4d_data::name::meant;
use l4d_data::results::Track;
use l4d_data::{Benchmark, Name};
use l4d_splat::checkpoint::own::Sampling;
use l4d_splat::training_run::{Settings, TrainingRequest, train_scene};

use crate::cli::splats::TrainSplatsArgs;
use crate::out::{ExitStatus, Printer};
use crate::{rasterizer, readmes, stopping};

pub(crate) fn run(args: &TrainSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(&args.scene)?;
    let space = args.work.space(args.profile);
    if !space.scene(&name).root().exists() {
        refuse_misspelt(&args.scene, &args.bench)?;
    }
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let request = TrainingRequest {
        scene: &name,
        profile: args.profile,
        dir: &space.scene(&name),
        folder: args.out.clone().unwrap_or_else(|| space.work(&name).splats()),
        settings: settings(args),
        sees_depth: args.depth,
        points: args.points.clone(),
        sampling: Sampling { shrink: args.shrink, every: args.every },
        between_checkpoints: Duration::from_secs_f64(args.checkpoint_seconds),
        overwrite: args.force,
        stop: stopping::asked(),
        rasterizer: opened.rasterizer.as_ref(),
        adapter: opened.adapter,
    };
    let trained = train_scene(&request, out)?;
    readmes::leave(&args.work.work, readmes::WORK)?;
    out.note(match trained.track {
        Track::Colour => "track: colour",
        Track::ColourDepth => "track: colour + depth (learned from rendered depth)",
    });
    match args.json {
        true => out.json(&trained.manifest)?,
        false => out.data(trained.table())?,
    }
    Ok(ExitStatus::Success)
}

/// Refuses a name that misspells a scene of the benchmark; one that does not may be a scene of its own.
fn refuse_misspelt(scene: &str, bench: &Path) -> Result<()> {
    let Ok(bench) = Benchmark::open(bench) else { return Ok(()) };
    let known: Vec<&str> = bench.manifest.scenes.iter().map(Name::as_str).collect();
    if !known.contains(&scene) && meant(scene, &known).is_some() {
        bench.scene(scene)?;
    }
    Ok(())
}

fn settings(args: &TrainSplatsArgs) -> Settings {
    let default = Settings::of(args.preset, args.profile);
    Settings {
        seed: args.seed,
        gaussians: args.gaussians.unwrap_or(default.gaussians),
        sh_degree: args.sh_degree.unwrap_or(default.sh_degree),
        dynamic_threshold: args.dynamic_threshold.unwrap_or(default.dynamic_threshold),
        coarse: args.coarse.unwrap_or(default.coarse),
        unfold: args.unfold.unwrap_or(default.unfold),
        fine: args.fine.unwrap_or(default.fine),
        views: args.views_per_iteration.unwrap_or(default.views),
        depth_weight: args.depth_weight.unwrap_or(default.depth_weight),
        patience: args.patience.unwrap_or(default.patience),
        ..default
    }
}
