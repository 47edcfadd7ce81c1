//! `l4d sheet`: one picture that shows a scene, its instances and its queries to a person.

use anyhow::Result;
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::query::{Query, read_queries};
use l4d_data::scene::Scene;
use l4d_data::{Camera, Name};
use l4d_frames::sheet::{Sheet, default_frames, default_views};

use super::check_scenes::data_folder;
use crate::cli::SheetArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &SheetArgs, out: &Printer) -> Result<ExitStatus> {
    let name = Name::new(args.scene.as_str())?;
    let dir = SceneDir::new(&data_folder(args.data.as_deref(), args.bench.profile), &name);
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
    let path = args.output.clone().unwrap_or_else(|| dir.root().join("sheet.png"));
    sheet.save(&path)?;
    out.data(path.display())?;
    Ok(ExitStatus::Success)
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
