//! A trained model in the formats of other viewers.

use std::path::PathBuf;

use anyhow::Result;
use l4d_data::store::Claim;
use l4d_data::{Name, Progress as _, StageError, json};
use l4d_splat::checkpoint::{ply, usd};
use l4d_splat::source::ReaderOptions;
use l4d_splat::splats::Splats;
use serde::Serialize;

use crate::cli::interop::{ExportArgs, SplatFormat};
use crate::out::{ExitStatus, Printer};
use crate::shown::open_splats;

const MANIFEST: &str = "l4d-export.json";
const TRAIN_AGAIN: &str = "give another model, or train this one again";

/// What the folder holds.
#[derive(Debug, Serialize)]
struct Manifest<'a> {
    schema: &'static str,
    scene: &'a Name,
    model: String,
    gaussians: usize,
    frames_per_second: f64,
    /// Canonical frame and its file.
    files: Vec<(u32, PathBuf)>,
}

pub(super) fn run(args: &ExportArgs, name: &Name, format: SplatFormat, out: &Printer) -> Result<ExitStatus> {
    let space = args.work.space(args.profile);
    let rig = space.rig(name)?;
    let timeline = rig.timeline();
    let splats = args.splats.clone().unwrap_or_else(|| space.work(name).splats());
    let source = open_splats(&splats, ReaderOptions::default(), (&rig, args.profile), out)?;
    let frames = timeline.chosen(&args.frames, &rig.clip(args.profile))?;

    let file = |frame: u32| match format {
        SplatFormat::Ply => PathBuf::from(format!("splats_{frame:05}.ply")),
        SplatFormat::Usd => PathBuf::from("splats.usda"),
    };
    let files: Vec<(u32, PathBuf)> = frames.iter().map(|&frame| (frame, file(frame))).collect();
    let mut names: Vec<String> = files.iter().map(|(_, path)| path.display().to_string()).collect();
    names.dedup();
    names.push(MANIFEST.to_owned());
    let _claim = Claim::take(&args.out, names, None, false)?;

    out.start("exporting", frames.len() as u64);
    let mut states: Vec<(u32, Splats)> = Vec::new();
    for (frame, path) in &files {
        let gaussians = source.model.gaussians_at(timeline.time(*frame));
        let gaussians = gaussians.map_err(|error| StageError::of(&error, TRAIN_AGAIN))?;
        match format {
            SplatFormat::Ply => ply::write(&args.out.join(path), &gaussians)?,
            SplatFormat::Usd => {
                let state = gaussians.activate().map_err(|error| StageError::of(&error, TRAIN_AGAIN))?;
                states.push((*frame, state));
            }
        }
        out.advance(1);
    }
    if format == SplatFormat::Usd {
        usd::write(&args.out.join(file(0)), &states, timeline)?;
    }
    out.finish();
    let manifest = Manifest {
        schema: "l4d/export-splats/1",
        scene: name,
        model: splats.display().to_string(),
        gaussians: source.model.gaussians.len(),
        frames_per_second: timeline.frames_per_second(),
        files,
    };
    let path = args.out.join(MANIFEST);
    json::write(&path, &manifest)?;
    match args.json {
        true => out.json(&manifest)?,
        false => out.data(path.display())?,
    }
    Ok(ExitStatus::Success)
}
