//! `l4d build-scenes`: plan, render what is missing, settle.

use anyhow::Result;
use l4d_blender::build::{BuildRequest, build};
use l4d_blender::env::{BlenderEnv, scripts_folder};
use l4d_blender::part::Part;
use l4d_blender::plan::recipes;
use l4d_data::layout::BenchDir;
use l4d_data::name::choose_among;
use l4d_data::store::list_folder;
use l4d_data::tracks::Tracks;
use l4d_data::{Benchmark, Name, Profile, Report, Workspace};

use crate::cli::scenes::BuildScenesArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::{readmes, shipped};

pub(crate) fn run(args: &BuildScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let profile = args.bench.profile;
    let scenes = chosen_scenes(args)?;
    require_nothing_new(args, &scenes)?;
    let bench = BenchDir::new(&args.bench.bench);
    let part = Part { views: args.views.clone(), frames: args.frames.clone(), shard: args.shard };
    check_part(args, &part, &scenes, &bench)?;
    let choice = args.python.choice();
    let env = BlenderEnv::find_or_make(&choice, out)?;
    // A folder that is no benchmark yet becomes the benchmark's.
    let seed = Benchmark::open(&args.bench.bench).map(|bench| bench.manifest.seed).unwrap_or_default();
    let space = Workspace::new(profile).with_data(args.data.as_deref());
    let request = BuildRequest {
        scenes: &scenes,
        seed,
        space: &space,
        bench: &bench,
        work: &choice.work,
        samples: args.samples.unwrap_or(match profile {
            Profile::Tiny | Profile::Small => 4,
            Profile::Full | Profile::Real => 16,
        }),
        tracks_only: args.tracks_only,
        overwrite: args.force,
        update_benchmark: args.update_benchmark,
        jobs: args.jobs,
        part: &part,
    };
    let mut report = Report::default();
    let built = build(&env, &request, out, &mut report)?;
    readmes::leave(space.data(), readmes::DATA)?;
    match built.rendered {
        Some(rendered) => out.note(format!("rendered {rendered} pictures")),
        None => out.note(format!("tracks are in {}", bench.root().join("scenes").display())),
    }
    if !built.unfinished.is_empty() {
        let names = built.unfinished.iter().map(Name::as_str).collect::<Vec<_>>().join(", ");
        out.note(format!(
            "pictures of {names} are still to be rendered; run without --views, --frames and --shard for the rest"
        ));
    }
    built.settled.iter().try_for_each(|folder| out.data(folder.display()))?;
    out.findings(report, false)
}

/// A build compares with an installed benchmark, and may have nothing to add to it.
fn require_nothing_new(args: &BuildScenesArgs, scenes: &[Name]) -> Result<()> {
    let bench = BenchDir::new(&args.bench.bench);
    let lacks = |scene: &Name| {
        let truth = bench.truth(args.bench.profile, scene);
        !bench.tracks(scene).exists() || !(args.tracks_only || truth.exists())
    };
    if args.update_benchmark || scenes.iter().any(lacks) {
        shipped::require_own(bench.root())
    } else {
        Ok(())
    }
}

/// Refuses views and frames that are not there before Blender is started, where the tracks of a scene are known. Tracks
/// that are to be replaced say nothing of the scene.
fn check_part(args: &BuildScenesArgs, part: &Part, scenes: &[Name], bench: &BenchDir) -> Result<()> {
    let of_bench = scenes.iter().map(|scene| bench.tracks(scene)).filter(|path| path.exists());
    for path in of_bench.filter(|_| !args.update_benchmark) {
        part.check(&Tracks::read(&path)?, args.bench.profile)?;
    }
    Ok(())
}

/// The benchmark's scenes, or those asked for; new recipes need not be in the benchmark.
fn chosen_scenes(args: &BuildScenesArgs) -> Result<Vec<Name>> {
    let mut known = recipes(&scripts_folder(&args.python.blender_scripts)?)?;
    let composed = BenchDir::new(&args.bench.bench).recipes();
    if composed.exists() {
        let files = list_folder(&composed)?;
        known.extend(files.iter().filter_map(|file| file.strip_suffix(".json")).map(str::to_owned));
    }
    let wanted = match args.bench.scenes.as_slice() {
        [] => Benchmark::open(&args.bench.bench)?.manifest.scenes.iter().map(Name::to_string).collect(),
        wanted => wanted.to_vec(),
    };
    let choose = |name: String| match known.contains(&name) {
        true => Ok(Name::new(name)?),
        false => Err(refusal(
            format!("there is no scene `{}`", name.escape_debug()),
            choose_among(&name, &known.iter().map(String::as_str).collect::<Vec<_>>()),
        )),
    };
    wanted.into_iter().map(choose).collect()
}
