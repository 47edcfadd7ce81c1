//! `l4d import-scene`: a capture that others recorded, with the object masks that people drew on it.

use std::path::Path;

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::{Name, Profile, Workspace};
use l4d_import::capture::masks::{self, MaskSet};
use l4d_import::capture::publish::{Published, publish};
use l4d_import::capture::{CAPTURE, Capture, CaptureRequest, import};
use serde_json::json;

use crate::cli::interop::ImportSceneArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::shipped;

pub(crate) fn run(args: &ImportSceneArgs, out: &Printer) -> Result<ExitStatus> {
    args.bench.as_deref().map(shipped::require_own).transpose()?;
    let name = scene_name(args)?;
    let folder = args.out.clone().unwrap_or_else(|| space().capture(&name).root().to_owned());
    let capture = match args.masks_only {
        true => Capture::read(&folder)?,
        false => read(args, &name, &folder, out)?,
    };
    let drawn = masks_of(args, &capture, out)?;
    // Other masks are refused before anything is written.
    drawn.as_ref().map(|set| set.is_in(&folder, args.force)).transpose()?;
    let published = match (&args.bench, args.scale, &drawn) {
        (Some(bench), Some(scale), Some(set)) => Some(publish(&capture, set, scale, bench, args.force)?),
        _ => None,
    };
    let masks = drawn.as_ref().map(|set| set.write(&folder, args.force)).transpose()?;
    if let Some(published) = &published {
        tell_next(args, &capture, published, out);
    }
    if args.json {
        let pictures = capture.cameras.len() * capture.frames.len();
        let unseen: usize = capture.unseen.values().map(Vec::len).sum();
        out.json(&json!({
            "capture": folder.join(CAPTURE),
            "views": capture.cameras.len(),
            "frames": capture.frames.len(),
            "pictures": pictures - unseen,
            "substituted": capture.substituted.len(),
            "depth": capture.depth,
            "masks": masks,
            "truth": published.as_ref().map(|published| &published.truth),
            "annotated": published.as_ref().map(|published| published.annotated),
        }))?;
    } else {
        out.data(folder.join(CAPTURE).display())?;
        if let Some(masks) = masks {
            out.data(masks.display())?;
        }
        if let Some(published) = published {
            out.data(published.truth.display())?;
        }
    }
    Ok(ExitStatus::Success)
}

/// Where captures go by default.
fn space() -> Workspace {
    Workspace::new(Profile::Real)
}

fn read(args: &ImportSceneArgs, name: &Name, folder: &Path, out: &Printer) -> Result<Capture> {
    let request = CaptureRequest {
        source: args.source,
        input: &args.input,
        name,
        out: folder,
        held_out: &args.held_out,
        moments: args.moments.map(|moments| moments.0),
        ffmpeg: &args.ffmpeg,
    };
    out.start("importing", 0);
    let capture = import(request, &|| out.advance(1))?;
    out.finish();
    capture.notes.iter().for_each(|note| out.note(note));
    out.note("the capture has neither depth nor ids, and says so: what needs them refuses it");
    for gone in &capture.substituted {
        out.warn(format!(
            "{} at {} {}: the picture at {} takes its place",
            gone.view, gone.frame, gone.why, gone.shows
        ));
    }
    Ok(capture)
}

fn masks_of(args: &ImportSceneArgs, capture: &Capture, out: &Printer) -> Result<Option<MaskSet>> {
    let (Some(path), Some(format)) = (&args.masks, args.masks_format) else { return Ok(None) };
    let set = masks::read(capture, path, format)?;
    set.notes.iter().for_each(|note| out.note(note));
    Ok(Some(set))
}

/// What can be done with a published scene.
fn tell_next(args: &ImportSceneArgs, capture: &Capture, published: &Published, out: &Printer) {
    let Published { annotated, frames, queries, .. } = published;
    out.note(format!("{annotated} of {frames} frames of the held-out view are annotated, and judged"));
    let bench = args.bench.as_deref().unwrap_or(Path::new("benchmark")).display();
    out.note(format!(
        "next: write queries into {} and run `l4d check-queries --bench {bench} --profile real --scenes {}`",
        queries.display(),
        capture.name
    ));
}

fn scene_name(args: &ImportSceneArgs) -> Result<Name> {
    if let Some(name) = &args.name {
        return Ok(name.clone());
    }
    let folder = args.input.file_name().unwrap_or_default().to_string_lossy();
    Name::new(folder.clone()).map_err(|error| refusal(error.to_string(), "name the scene with --name"))
}
