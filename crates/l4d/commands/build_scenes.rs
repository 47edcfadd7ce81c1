//! `l4d build-scenes`: plan, render what is missing, settle.

use std::path::PathBuf;

use anyhow::Result;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::{Benchmark, Name, Profile, Report};

use crate::blender::env::{BlenderEnv, scripts_folder};
use crate::blender::plan::{Draw, plan};
use crate::blender::render::{PlannedScene, recipes, render};
use crate::blender::settle::{commit, join_names, settle};
use crate::cli::BuildScenesArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &BuildScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let scenes = chosen_scenes(args)?;
    let env = BlenderEnv::find_or_make(&args.python, out)?;
    let data = data_folder(args);
    let bench = bench_folder(args, &data);
    let draw = Draw { variant: args.variant, seed: args.seed };
    let mut report = Report::default();
    let mut planned = Vec::new();
    for name in scenes {
        let dir = SceneDir::new(&data, &name);
        out.note(format!("planning {name}"));
        let plan = plan(&env, &dir, &name, draw, &args.python.work, out)?;
        commit(&bench.tracks(&name), &plan.tracks, args.update_benchmark, &mut report)?;
        planned.push(PlannedScene::new(name, dir, plan, args.bench.profile, draw, samples(args)));
    }
    if args.tracks_only {
        out.note(format!("tracks are in {}", bench.root().join("scenes").display()));
        return out.findings(report, false);
    }
    for scene in &planned {
        scene.claim(args.overwrite)?;
    }
    let rendered = render(&env, &planned, args.shard, args.jobs, &args.python.work, out)?;
    out.note(format!("rendered {rendered} pictures"));
    if args.shard.is_some() {
        let is_unfinished = |scene: &&PlannedScene| !scene.missing().is_empty();
        let unfinished: Vec<Name> =
            planned.iter().filter(is_unfinished).map(|scene| scene.name.clone()).collect();
        if !unfinished.is_empty() {
            let names = join_names(&unfinished);
            out.note(format!(
                "other shards are still at {names}; run once without --shard when all are done"
            ));
            return out.findings(report, false);
        }
    }
    for scene in &planned {
        scene.sweep()?;
        let truth = settle(scene)?;
        commit(&bench.truth(args.bench.profile, &scene.name), &truth, args.update_benchmark, &mut report)?;
        out.data(scene.dir.root().display())?;
    }
    out.findings(report, false)
}

/// The benchmark's scenes, or those asked for; variants and new recipes need not be in the benchmark.
fn chosen_scenes(args: &BuildScenesArgs) -> Result<Vec<Name>> {
    let known = recipes(&scripts_folder(&args.python.blender_scripts)?)?;
    let wanted = match args.bench.scenes.as_slice() {
        [] => Benchmark::open(&args.bench.bench)?.manifest.scenes.iter().map(Name::to_string).collect(),
        wanted => wanted.to_vec(),
    };
    let choose = |name: String| match known.contains(&name) {
        true => Ok(Name::new(name)?),
        false => Err(refusal(
            format!("there is no scene `{}`", name.escape_debug()),
            format!("choose among {}", known.join(", ")),
        )),
    };
    wanted.into_iter().map(choose).collect()
}

fn samples(args: &BuildScenesArgs) -> u32 {
    args.samples.unwrap_or(match args.bench.profile {
        Profile::Tiny => 8,
        Profile::Small => 4,
        Profile::Full => 16,
    })
}

fn data_folder(args: &BuildScenesArgs) -> PathBuf {
    let profile = args.bench.profile;
    let default = match args.variant {
        0 => format!("data/{profile}"),
        variant => format!("data/{profile}-v{variant}"),
    };
    args.data.clone().unwrap_or_else(|| PathBuf::from(default))
}

/// Variants and other seeds are private draws: their tracks and truth stay beside their frames.
fn bench_folder(args: &BuildScenesArgs, data: &std::path::Path) -> BenchDir {
    match (args.variant, args.seed) {
        (0, 0) => BenchDir::new(&args.bench.bench),
        _ => BenchDir::new(data.join("benchmark")),
    }
}
