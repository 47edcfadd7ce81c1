//! From a plan to the folder of a capture: pictures without distortion, points, and `capture.json` last.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::DVec2;
use l4d_data::capture::{CAPTURE, Capture, Depth, MASKS, SCHEMA, SPARSE, Substitution};
use l4d_data::digest::sha256_file;
use l4d_data::error::inert;
use l4d_data::store::{list_folder, make_folder, read_bounded, remove_folder, write_atomic};
use l4d_data::{Camera, DataError, json};
use l4d_frames::drawn::{RgbImage, encode_colour};
use l4d_frames::photo::{self, PhotoError};
use rayon::prelude::*;

use super::CaptureRequest;
use super::plan::{Plan, View};
use crate::points::{add_point, model_of_pinholes};

/// In the folder while an import writes it: what it left when it was killed is its own.
const CLAIM: &str = ".l4d-import";
/// No picture file is larger, bytes.
const MAX_BYTES: u64 = 256 << 20;

pub(super) fn write(
    request: &CaptureRequest<'_>,
    mut plan: Plan,
    tick: &(dyn Fn() + Sync),
) -> Result<Capture, DataError> {
    claim(request)?;
    plan.views.sort_by(|a, b| a.camera.name.cmp(&b.camera.name));
    if let Some(pair) = plan.views.windows(2).find(|pair| pair[0].camera.name == pair[1].camera.name) {
        let message = format!("two views would be called {}", pair[0].camera.name);
        let hint = "give pictures names that differ in letters and digits";
        return Err(DataError::invalid(request.input, "views", message, hint));
    }
    let frames: BTreeSet<u32> = plan.views.iter().flat_map(|view| view.pictures.keys().copied()).collect();
    let size = size_of(request, &plan)?;
    for view in &mut plan.views {
        fill_poses(&mut view.camera, &frames);
        if let Some(stated) = plan.stated_size {
            view.camera = view.camera.resized(stated, size);
        }
        if let Some(problem) = view.camera.problem() {
            let place = format!("camera {}", view.camera.name);
            return Err(DataError::invalid(
                request.input,
                place,
                problem,
                "restore the files of the cameras",
            ));
        }
    }
    let substituted: Vec<Vec<Substitution>> =
        plan.views.par_iter().map(|view| write_view(request, view, size, tick)).collect::<Result<_, _>>()?;
    write_points(request, &plan, &frames, size)?;
    plan.scratch.as_deref().map_or(Ok(()), remove_folder)?;
    let unseen = |view: &View| {
        let missing: Vec<u32> =
            frames.iter().copied().filter(|frame| !view.pictures.contains_key(frame)).collect();
        (!missing.is_empty()).then(|| (view.camera.name.clone(), missing))
    };
    let digest = |path: &std::path::PathBuf| {
        let name = path.strip_prefix(request.input).unwrap_or(path).display().to_string();
        Ok((name, sha256_file(path)?))
    };
    let capture = Capture {
        schema: SCHEMA.to_owned(),
        name: request.name.clone(),
        source: request.source.to_string(),
        width: size[0],
        height: size[1],
        unseen: plan.views.iter().filter_map(unseen).collect(),
        cameras: plan.views.iter().map(|view| view.camera.clone()).collect::<Vec<Camera>>(),
        frames: frames.iter().copied().collect(),
        frames_per_second: plan.frames_per_second,
        depth: Depth::Absent,
        points: plan.points.len(),
        is_metric: plan.is_metric,
        substituted: substituted.into_iter().flatten().collect(),
        inputs: plan.inputs.iter().map(digest).collect::<Result<BTreeMap<_, _>, DataError>>()?,
        notes: plan.notes,
    };
    json::write(&request.out.join(CAPTURE), &capture)?;
    let claim = request.out.join(CLAIM);
    std::fs::remove_file(&claim).map_err(|source| DataError::io(&claim, "remove", source))?;
    Ok(capture)
}

/// Takes possession of the folder: empty, or of an earlier import of the same scene, which may have been killed. What says
/// that it is whole goes first.
fn claim(request: &CaptureRequest<'_>) -> Result<(), DataError> {
    make_folder(request.out)?;
    let refuse = |message: String| {
        let hint = "choose an empty folder with --out, or remove this one";
        Err(DataError::invalid(request.out, "folder", message, hint))
    };
    let path = request.out.join(CAPTURE);
    let claim = request.out.join(CLAIM);
    let ours: &[&str] = match path.is_file() || claim.exists() {
        true => &[CAPTURE, MASKS, SPARSE, "frames"],
        false => &[],
    };
    if let Some(entry) = list_folder(request.out)?.into_iter().find(|entry| !ours.contains(&entry.as_str())) {
        return refuse(format!("is not empty: `{}` is there", inert(&entry)));
    }
    if path.is_file() {
        let earlier = Capture::read(request.out)?;
        if (&earlier.name, earlier.source.as_str()) != (request.name, request.source.to_string().as_str()) {
            return refuse(format!("holds {} of {}", earlier.name, inert(&earlier.source)));
        }
    }
    write_atomic(&claim, b"")?;
    if path.is_file() {
        std::fs::remove_file(&path).map_err(|source| DataError::io(&path, "remove", source))?;
    }
    Ok(())
}

/// Gives a moving camera a pose for each number up to the last: the one before where the view saw nothing.
fn fill_poses(camera: &mut Camera, frames: &BTreeSet<u32>) {
    let poses = &mut camera.world_from_camera;
    let count = frames.last().map_or(0, |last| *last as usize + 1);
    if let Some(last) = poses.last().copied().filter(|_| poses.len() > 1 && poses.len() < count) {
        poses.resize(count, last);
    }
}

/// Writes the points of the source, with the pictures that show them.
fn write_points(
    request: &CaptureRequest<'_>,
    plan: &Plan,
    frames: &BTreeSet<u32>,
    size: [u32; 2],
) -> Result<(), DataError> {
    let Some(&frame) = frames.first().filter(|_| !plan.points.is_empty()) else { return Ok(()) };
    let cameras: BTreeMap<&str, &Camera> =
        plan.views.iter().map(|view| (view.camera.name.as_str(), &view.camera)).collect();
    let all: Vec<&Camera> = cameras.values().copied().collect();
    let mut model = model_of_pinholes(&all, frame, size);
    for point in &plan.points {
        let seen = point.views.iter().filter_map(|name| cameras.get(name.as_str()).copied());
        let sightings: Vec<(&Camera, DVec2)> =
            seen.map(|camera| (camera, camera.project(frame, point.surface.position).0)).collect();
        add_point(&mut model, point.surface, point.error_px, &sightings);
    }
    model.write(&request.out.join(SPARSE))
}

/// The size of the first picture that is whole.
fn size_of(request: &CaptureRequest<'_>, plan: &Plan) -> Result<[u32; 2], DataError> {
    let mut paths = plan.views.iter().flat_map(|view| view.pictures.values());
    let found = paths.find_map(|path| {
        let bytes = read_bounded(path, MAX_BYTES).ok()?;
        photo::size(&bytes).ok()
    });
    found.map(|(width, height)| [width, height]).ok_or_else(|| {
        let message = "none of them is there and whole";
        let hint = "check the folder and `--moments`";
        DataError::invalid(request.input, "pictures", message, hint)
    })
}

/// Writes the pictures of a view; a damaged one becomes the one before it, or after it at the start.
fn write_view(
    request: &CaptureRequest<'_>,
    view: &View,
    size: [u32; 2],
    tick: &(dyn Fn() + Sync),
) -> Result<Vec<Substitution>, DataError> {
    let mut substituted = Vec::new();
    let mut waiting: Vec<(u32, String)> = Vec::new();
    let mut before: Option<(u32, Vec<u8>)> = None;
    let store = |frame: u32, bytes: &[u8]| {
        write_atomic(&request.out.join(Capture::picture_path(&view.camera.name, frame)), bytes)?;
        tick();
        Ok::<_, DataError>(())
    };
    let mut substitute = |frame: u32, shows: u32, why: String| {
        substituted.push(Substitution { view: view.camera.name.clone(), frame, shows, why });
    };
    for (&frame, path) in &view.pictures {
        match (read(path, size)?, &before) {
            (Ok(picture), _) => {
                let picture = if view.distortion.is_none() {
                    picture
                } else {
                    view.distortion.undistorted(&view.camera, &picture)
                };
                let bytes = encode_colour(&picture);
                for (earlier, why) in waiting.drain(..) {
                    store(earlier, &bytes)?;
                    substitute(earlier, frame, why);
                }
                store(frame, &bytes)?;
                before = Some((frame, bytes));
            }
            (Err(why), Some((shown, bytes))) => {
                store(frame, bytes)?;
                substitute(frame, *shown, why);
            }
            (Err(why), None) => waiting.push((frame, why)),
        }
    }
    if let Some((_, why)) = waiting.first() {
        let message = format!("no picture is whole: {why}");
        let place = format!("view {}", view.camera.name);
        let hint = "restore the pictures from the data set";
        return Err(DataError::invalid(request.input, place, message, hint));
    }
    substituted.sort_by_key(|substitution| substitution.frame);
    Ok(substituted)
}

/// A picture, or what is wrong with its bytes. A missing file and another size are errors: they are no damage.
fn read(path: &Path, [width, height]: [u32; 2]) -> Result<Result<RgbImage, String>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    match photo::decode(&bytes) {
        Ok(picture) if picture.dimensions() == (width, height) => Ok(Ok(picture)),
        Ok(picture) => {
            let message = format!(
                "is {}x{}, but the first picture is {width}x{height}",
                picture.width(),
                picture.height()
            );
            Err(DataError::invalid(path, "size", message, "bring all pictures to one size"))
        }
        Err(error @ PhotoError::Damaged(_)) => Ok(Err(inert(&error.to_string()))),
        Err(error) => {
            Err(DataError::invalid(path, "picture", error.to_string(), "give PNG or JPEG pictures"))
        }
    }
}
