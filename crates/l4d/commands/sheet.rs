//! `l4d sheet`: one picture that shows a scene with its instances and queries, or all scenes, to a person.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::layout::BenchDir;
use l4d_data::query::{Query, read_queries};
use l4d_data::scene::Scene;
use l4d_data::store::Claim;
use l4d_data::{Benchmark, Camera, Name, Workspace};
use l4d_frames::drawn::RgbImage;
use l4d_frames::sheet::{Rendered, Sheet, default_frames, default_views, overview, save};

use crate::cli::scenes::SheetArgs;
use crate::out::{ExitStatus, Printer, refusal};

/// Moments of the overview: the clip's quarters.
const OVERVIEW_FRAMES: [u32; 3] = [24, 48, 72];

pub(crate) fn run(args: &SheetArgs, out: &Printer) -> Result<ExitStatus> {
    let space = Workspace::new(args.bench.profile).with_data(args.data.as_deref());
    let path = match &args.scene {
        Some(scene) => draw_scene(args, &space, scene)?,
        None => draw_overview(args, &space, out)?,
    };
    out.data(path.display())?;
    Ok(ExitStatus::Success)
}

fn draw_scene(args: &SheetArgs, space: &Workspace, scene: &str) -> Result<PathBuf> {
    let name = Name::new(scene)?;
    let dir = space.scene(&name);
    let scene = Scene::read(&dir.scene())?;
    let views = chosen_views(args, &scene)?;
    let frames = chosen_frames(args, &scene)?;
    let queries = queries_of(args, &name)?;
    let sheet = Sheet {
        scene: &scene,
        dir: &dir,
        views: &views,
        frames: &frames,
        queries: &queries,
        plain: args.plain,
    };
    let path = args.out.clone().unwrap_or_else(|| dir.sheet());
    save_ours(&sheet.draw()?, &path, args.force)?;
    Ok(path)
}

fn draw_overview(args: &SheetArgs, space: &Workspace, out: &Printer) -> Result<PathBuf> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let chosen = bench.select(&args.bench.scenes)?;
    let built = |name: &&Name| space.scene(name).scene().is_file();
    let scenes: Vec<Rendered> = chosen
        .iter()
        .filter(built)
        .map(|name| {
            let dir = space.scene(name);
            let scene = Scene::read(&dir.scene())?;
            chosen_frames(args, &scene)?;
            Ok((scene, dir))
        })
        .collect::<Result<_>>()?;
    if scenes.is_empty() {
        let message = format!("no scene of the benchmark is in {}", space.data().display());
        return Err(refusal(message, args.bench.build_hint()));
    }
    if scenes.len() < chosen.len() {
        let missing = chosen.len() - scenes.len();
        out.note(format!("not built, so not shown: {missing} of {} scenes", chosen.len()));
    }
    let frames = if args.frames.is_empty() { OVERVIEW_FRAMES.to_vec() } else { args.frames.clone() };
    let path = args.out.clone().unwrap_or_else(|| space.overview());
    save_ours(&overview(&scenes, &frames)?, &path, args.force)?;
    Ok(path)
}

/// Writes a picture, but not over one of somebody else.
fn save_ours(page: &RgbImage, path: &Path, force: bool) -> Result<()> {
    let _claim = Claim::of_file(path, force)?;
    Ok(save(page, path)?)
}

fn chosen_views<'a>(args: &SheetArgs, scene: &'a Scene) -> Result<Vec<&'a Camera>> {
    if args.views.is_empty() {
        return Ok(default_views(scene));
    }
    let find = |view: &String| {
        scene.camera(view).ok_or_else(|| {
            let known: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
            refusal(
                format!("{} has no view `{}`", scene.name, view.escape_debug()),
                format!("choose among {}", known.join(", ")),
            )
        })
    };
    args.views.iter().map(find).collect()
}

fn chosen_frames(args: &SheetArgs, scene: &Scene) -> Result<Vec<u32>> {
    let profile = scene.profile;
    if let Some(frame) =
        args.frames.iter().find(|frame| !profile.frames().any(|rendered| rendered == **frame))
    {
        let hint = format!("profile {profile} renders every {}. frame from 0 to 96", profile.stride());
        return Err(refusal(format!("frame {frame} is not rendered"), hint));
    }
    Ok(if args.frames.is_empty() { default_frames(scene) } else { args.frames.clone() })
}

/// A scene without queries yet gets a sheet without them.
fn queries_of(args: &SheetArgs, scene: &Name) -> Result<Vec<Query>> {
    let path = BenchDir::new(&args.bench.bench).queries(scene);
    if args.plain || !path.exists() {
        return Ok(Vec::new());
    }
    Ok(read_queries(&path, scene)?)
}
