//! Neural 3D Video: `poses_bounds.npy` and `camNN.mp4`, or pictures in `camNN/images/`.
//!
//! Videos become pictures through ffmpeg: l4d decodes none itself. Rows of the poses follow the sorted names of the videos that exist. Axes are LLFF's: down, right, backward.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use glam::{DMat3, DMat4, DVec3};
use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::store::{list_folder, make_folder, read_bounded};
use l4d_formats::Tensor;
use l4d_formats::npy::{self, Contents};

use super::CaptureRequest;
use super::plan::{Plan, View, camera, is_wanted, name_of};
use crate::pose;

/// Held out in the literature: the camera in the middle.
const HELD_OUT: &str = "cam00";
const FRAMES_PER_SECOND: f64 = 30.0;
const MAX_BYTES: u64 = 64 << 20;

pub(super) fn plan(request: &CaptureRequest<'_>) -> Result<Plan, DataError> {
    let path = request.input.join("poses_bounds.npy");
    let poses = npy::decode(&read_bounded(&path, MAX_BYTES)?).and_then(Contents::into_numbers);
    let poses: Tensor<f64> = poses.map_err(|fault| fault.at(&path))?;
    let cameras = camera_names(request.input)?;
    if poses.shape != [cameras.len(), 17] {
        let message =
            format!("has the shape {:?}, but there are {} cameras of 17 numbers", poses.shape, cameras.len());
        return Err(DataError::invalid(&path, "shape", message, "keep exactly the cameras that have a row"));
    }
    let mut plan = Plan::new(vec![path.clone()]);
    let first = &poses.data[..17];
    plan.stated_size = Some(stated_size(&path, first)?);
    let scratch = request.out.join(".videos");
    for (name, row) in cameras.iter().zip(poses.data.chunks_exact(17)) {
        let pictures = pictures(request, name, &scratch)?;
        let view = name_of(&path, name)?;
        plan.views.push(View {
            camera: camera(view, intrinsics(row), pose_of(row)),
            distortion: Default::default(),
            pictures,
        });
    }
    plan.scratch = Some(scratch);
    plan.frames_per_second = Some(FRAMES_PER_SECOND);
    plan.note(
        "the principal point is the centre and both focal lengths are equal: the file holds nothing else",
    );
    plan.note("units and directions of the world are those of the reconstruction; up is unknown");
    plan.finish(request, &[HELD_OUT])
}

/// Names of videos or folders of pictures, sorted.
fn camera_names(folder: &Path) -> Result<Vec<String>, DataError> {
    let mut names: Vec<String> = list_folder(folder)?
        .into_iter()
        .filter(|name| name.starts_with("cam"))
        .filter_map(|name| match name.strip_suffix(".mp4") {
            Some(stem) => Some(stem.to_owned()),
            None => folder.join(&name).join("images").is_dir().then_some(name),
        })
        .collect();
    names.sort();
    names.dedup();
    if names.is_empty() {
        let hint = "put videos `cam00.mp4`, ... or pictures `cam00/images/0000.png`, ... there";
        return Err(DataError::invalid(folder, "folder", "holds no camera", hint));
    }
    Ok(names)
}

fn pictures(
    request: &CaptureRequest<'_>,
    name: &str,
    scratch: &Path,
) -> Result<BTreeMap<u32, PathBuf>, DataError> {
    let folder = request.input.join(name).join("images");
    let paths = if folder.is_dir() {
        list_folder(&folder)?.into_iter().map(|name| folder.join(name)).collect()
    } else {
        extract(request.ffmpeg, &request.input.join(format!("{name}.mp4")), &scratch.join(name))?
    };
    Ok((0..).zip(paths).filter(|(moment, _)| is_wanted(request, None, *moment)).collect())
}

fn stated_size(path: &Path, row: &[f64]) -> Result<[u32; 2], DataError> {
    let side =
        |value: f64| (value.fract() == 0.0 && (1.0..=65_536.0).contains(&value)).then_some(value as u32);
    match (side(row[9]), side(row[4])) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => {
            let message = format!("states pictures of {}x{}", row[9], row[4]);
            let hint = "write height, width, focal length into columns 4, 9, 14";
            Err(DataError::invalid(path, "column 4", message, hint))
        }
    }
}

fn intrinsics(row: &[f64]) -> [f64; 4] {
    let (height, width, focal) = (row[4], row[9], row[14]);
    [focal, focal, width / 2.0, height / 2.0]
}

fn pose_of(row: &[f64]) -> [f64; 16] {
    let column = |index: usize| DVec3::new(row[index], row[5 + index], row[10 + index]);
    let rotation = pose::nearest_rotation(DMat3::from_cols(column(1), column(0), -column(2)));
    pose::rows(DMat4::from_mat3_translation(rotation, column(3)))
}

/// Extracts the pictures of a video into a folder; gives them in order.
fn extract(ffmpeg: &Path, video: &Path, folder: &Path) -> Result<Vec<PathBuf>, DataError> {
    make_folder(folder)?;
    let output = Command::new(ffmpeg)
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-i"])
        .arg(video)
        .args(["-vsync", "passthrough", "-start_number", "0"])
        .arg(folder.join("%06d.png"))
        .stdin(Stdio::null())
        .output();
    let refuse = |message: String, hint: &str| Err(DataError::invalid(video, "video", message, hint));
    match output {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return refuse(
                format!("needs the program `{}`, which is not there", ffmpeg.display()),
                "install ffmpeg, or put the pictures into <camera>/images/0000.png, 0001.png, ...",
            );
        }
        Err(error) => return Err(DataError::io(ffmpeg, "run", error)),
        Ok(output) if !output.status.success() => {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().last().unwrap_or("it says nothing");
            return refuse(format!("ffmpeg failed: {}", inert(last)), "check that the video plays");
        }
        Ok(_) => {}
    }
    let pictures: Vec<PathBuf> = list_folder(folder)?.into_iter().map(|name| folder.join(name)).collect();
    if pictures.is_empty() {
        return refuse("holds no picture".to_owned(), "check that the video plays");
    }
    Ok(pictures)
}
