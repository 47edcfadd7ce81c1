//! `l4d build-scenes`: plan, render what is missing, settle.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::{Benchmark, Draw, Name, Profile, Report};
use rayon::prelude::*;

use crate::blender::env::{BlenderEnv, scripts_folder};
use crate::blender::plan::{Plan, plan};
use crate::blender::render::{PlannedScene, recipes, render};
use crate::blender::settle::{commit, join_names, settle};
use crate::cli::scenes::BuildScenesArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &BuildScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let scenes = chosen_scenes(args)?;
    let env = BlenderEnv::find_or_make(&args.python, out)?;
    let draw = chosen_draw(args);
    let data = data_folder(args.data.as_deref(), args.bench.profile, draw);
    let bench = bench_folder(args, &data, draw);
    let mut report = Report::default();
    let plans = plan_all(&env, &scenes, &data, draw, args, out)?;
    let mut planned = Vec::new();
    for (name, plan) in scenes.into_iter().zip(plans) {
        commit(&bench.tracks(&name), &plan.tracks, args.update_benchmark, &mut report)?;
        let dir = SceneDir::new(&data, &name);
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

/// Plans, some scenes at once: a plan is mostly one thread's work.
fn plan_all(
    env: &BlenderEnv,
    scenes: &[Name],
    data: &Path,
    draw: Draw,
    args: &BuildScenesArgs,
    out: &Printer,
) -> Result<Vec<Plan>> {
    let crew = rayon::ThreadPoolBuilder::new().num_threads(args.jobs.max(1)).build()?;
    let one = |name: &Name| {
        out.note(format!("planning {name}"));
        plan(env, &SceneDir::new(data, name), name, draw, &args.python.work, out)
    };
    crew.install(|| scenes.par_iter().with_max_len(1).map(one).collect())
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
        Profile::Tiny | Profile::Small => 4,
        Profile::Full | Profile::Real => 16,
    })
}

/// That of the command line, else that of the benchmark folder.
fn chosen_draw(args: &BuildScenesArgs) -> Draw {
    let own = own_draw(&args.bench.bench);
    Draw { variant: args.variant.unwrap_or(own.variant), seed: args.seed.unwrap_or(own.seed) }
}

/// A folder that is no benchmark yet becomes the benchmark's.
fn own_draw(bench: &Path) -> Draw {
    Benchmark::open(bench).map(|bench| bench.manifest.draw()).unwrap_or_default()
}

/// Where the frames of a draw, or captures, stand if nobody says otherwise.
pub(crate) fn data_folder(given: Option<&Path>, profile: Profile, draw: Draw) -> PathBuf {
    let default = match draw.variant {
        _ if !profile.is_rendered() => "data/captures".to_owned(),
        0 => format!("data/{profile}"),
        variant => format!("data/{profile}-v{variant}"),
    };
    given.map_or_else(|| PathBuf::from(default), Path::to_owned)
}

/// Tracks and truth of another draw than the benchmark folder's stay beside their frames.
fn bench_folder(args: &BuildScenesArgs, data: &Path, draw: Draw) -> BenchDir {
    match draw == own_draw(&args.bench.bench) {
        true => BenchDir::new(&args.bench.bench),
        false => BenchDir::new(data.join("benchmark")),
    }
}
