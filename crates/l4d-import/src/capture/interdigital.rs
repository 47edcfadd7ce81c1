//! InterDigital's (Technicolor's) light fields: a 4x4 rig, `cameras_parameters.txt`, and numbered PNG files.
//!
//! The undistorted variant is read. Its quaternions are world to camera; every camera has its own principal point.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DMat4, DQuat, DVec3};
use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::store::{list_folder, read_bounded};

use super::CaptureRequest;
use super::plan::{Plan, View, camera, is_wanted, name_of};
use crate::pose;

const PARAMETERS: &str = "cameras_parameters.txt";
const CAMERAS: usize = 16;
/// Held out in the literature: row 2, column 2 of the rig.
const HELD_OUT: &str = "cam10";
const FRAMES_PER_SECOND: f64 = 30.0;
const MAX_BYTES: u64 = 1 << 20;
/// Moments that the literature takes.
const MOMENTS: [(&str, [u32; 2]); 4] =
    [("birthday", [151, 200]), ("painter", [100, 149]), ("theater", [51, 100]), ("train", [151, 200])];

/// f cu cv ar sk qw qx qy qz tx ty tz
type Row = [f64; 12];

pub(super) fn plan(request: &CaptureRequest<'_>) -> Result<Plan, DataError> {
    let path = request.input.join(PARAMETERS);
    let rows = rows(&path)?;
    let (scene, pictures) = pictures(request)?;
    let default = MOMENTS.iter().find(|(name, _)| *name == scene.to_lowercase()).map(|(_, moments)| *moments);
    let mut plan = Plan::new(vec![path.clone()]);
    for (number, row) in rows.iter().enumerate() {
        let wanted = |((camera, moment), path): (&(usize, u32), &PathBuf)| {
            (*camera == number && is_wanted(request, default, *moment)).then(|| (*moment, path.clone()))
        };
        plan.views.push(View {
            camera: camera(name_of(&path, &format!("cam{number:02}"))?, intrinsics(row), pose_of(row)),
            distortion: Default::default(),
            pictures: pictures.iter().filter_map(wanted).collect(),
        });
    }
    plan.frames_per_second = Some(FRAMES_PER_SECOND);
    plan.note("the vertical focal length is ar * f, as hyperreel reads it; Spacetime Gaussians takes f");
    if rows.iter().any(|row| row[4] != 0.0) {
        plan.note("skew is left out, as everybody leaves it out");
    }
    plan.note("units and directions of the world are those of the calibration; up is unknown");
    if let Some([first, last]) = default.filter(|_| request.moments.is_none()) {
        plan.note(format!("moments {first} to {last}, as in the literature"));
    }
    plan.finish(request, &[HELD_OUT])
}

fn rows(path: &Path) -> Result<Vec<Row>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        // The first line names the columns, with or without a `#`.
        let is_header = index == 0 && line.split_whitespace().any(|word| word.parse::<f64>().is_err());
        if is_header || line.trim().is_empty() || line.trim_start().starts_with('#') {
            continue;
        }
        let wrong = |message: String, hint: &str| {
            DataError::invalid(path, format!("line {}", index + 1), inert(&message), hint)
        };
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let numbers = numbers.map_err(|error| {
            wrong(format!("holds something that is no number: {error}"), "write twelve numbers a camera")
        })?;
        if numbers.len() == 14 {
            let hint = "take the variant \"Undistorted\" of the data set, as the literature does";
            return Err(wrong("has distortion (d1, d2)".to_owned(), hint));
        }
        let row: Row = numbers.as_slice().try_into().map_err(|error| {
            let message = format!("has {} numbers instead of 12: {error}", numbers.len());
            wrong(message, "write twelve numbers a camera")
        })?;
        rows.push(row);
    }
    if rows.len() != CAMERAS {
        let message = format!("has {} cameras, but the rig has {CAMERAS}", rows.len());
        return Err(DataError::invalid(path, "rows", message, "restore the file from the data set"));
    }
    Ok(rows)
}

/// Pictures by camera and moment.
type Pictures = BTreeMap<(usize, u32), PathBuf>;

/// Name of the scene, and its pictures: `<Scene>_undist_<moment>_<camera>.png`.
fn pictures(request: &CaptureRequest<'_>) -> Result<(String, Pictures), DataError> {
    let mut scene = String::new();
    let mut pictures = BTreeMap::new();
    for name in list_folder(request.input)? {
        let Some(stem) = name.strip_suffix(".png") else { continue };
        let Some((rest, camera)) = stem.rsplit_once('_') else { continue };
        let Some((title, moment)) = rest.rsplit_once('_') else { continue };
        let (Ok(camera), Ok(moment)) = (camera.parse::<usize>(), moment.parse::<u32>()) else { continue };
        if camera < CAMERAS {
            title.strip_suffix("_undist").unwrap_or(title).clone_into(&mut scene);
            pictures.insert((camera, moment), request.input.join(&name));
        }
    }
    if pictures.is_empty() {
        let hint = "give the folder that holds cameras_parameters.txt and the PNG files";
        let message = "holds no `<Scene>_undist_<moment>_<camera>.png`";
        return Err(DataError::invalid(request.input, "folder", message, hint));
    }
    Ok((scene, pictures))
}

fn intrinsics(&[focal, cu, cv, aspect, ..]: &Row) -> [f64; 4] {
    [focal, focal * aspect, cu, cv]
}

fn pose_of(&[_, _, _, _, _, w, x, y, z, tx, ty, tz]: &Row) -> [f64; 16] {
    let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
    pose::rows(DMat4::from_rotation_translation(rotation, DVec3::new(tx, ty, tz)).inverse())
}
