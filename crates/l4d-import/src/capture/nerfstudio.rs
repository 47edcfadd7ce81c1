//! nerfstudio's `transforms.json`: each picture is a view; pictures that state a time are moments of one clip.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4};
use l4d_data::error::inert;
use l4d_data::{DataError, json};
use serde::Deserialize;
use serde_json::Value;

use super::CaptureRequest;
use super::lens::Distortion;
use super::plan::{Plan, View, camera, inside, name_of};
use crate::pose;

#[derive(Debug, Deserialize)]
struct Transforms {
    #[serde(default)]
    camera_model: Option<String>,
    frames: Vec<Entry>,
    #[serde(default)]
    test_filenames: Vec<String>,
    /// Size, intrinsics and distortion, unless a picture states its own.
    #[serde(flatten)]
    lens: BTreeMap<String, Value>,
}

#[derive(Debug, Deserialize)]
struct Entry {
    file_path: String,
    transform_matrix: [[f64; 4]; 4],
    #[serde(default)]
    time: Option<f64>,
    #[serde(default)]
    depth_file_path: Option<String>,
    #[serde(flatten)]
    lens: BTreeMap<String, Value>,
}

pub(super) fn plan(request: &CaptureRequest<'_>) -> Result<Plan, DataError> {
    let path = request.input.join("transforms.json");
    let document: Transforms = json::read(&path)?;
    let wrong = |place: &str, message: String, hint: &str| DataError::invalid(&path, place, message, hint);
    let lenses = ["PINHOLE", "SIMPLE_PINHOLE", "OPENCV", "SIMPLE_RADIAL", "RADIAL"];
    if let Some(model) = document.camera_model.as_deref().filter(|model| !lenses.contains(model)) {
        let message = format!("`{}` is no perspective lens", inert(model));
        let hint = "undistort the pictures to a pinhole first (`ns-process-data --camera-type perspective`)";
        return Err(wrong("field `camera_model`", message, hint));
    }
    let mut plan = Plan::new(vec![path.clone()]);
    let moments = moments(&document.frames);
    let mut held_out = Vec::new();
    for (index, entry) in document.frames.iter().enumerate() {
        let place = format!("field `frames[{index}]`");
        let lens = |field: &str| {
            [&entry.lens, &document.lens].into_iter().find_map(|lens| lens.get(field).and_then(Value::as_f64))
        };
        let missing = || {
            let message = "has neither its own size and focal length nor the document's".to_owned();
            wrong(&place, message, "write w, h, fl_x, fl_y, cx, cy")
        };
        let (width, height) = lens("w").zip(lens("h")).ok_or_else(missing)?;
        let from_angle = lens("camera_angle_x").map(|angle| width / 2.0 / (angle / 2.0).tan());
        let fx = lens("fl_x").or(from_angle).ok_or_else(missing)?;
        let (cx, cy) = (lens("cx").unwrap_or(width / 2.0), lens("cy").unwrap_or(height / 2.0));
        let intrinsics = [fx, lens("fl_y").unwrap_or(fx), cx, cy];
        let distortion = Distortion {
            radial: ["k1", "k2", "k3"].map(|field| lens(field).unwrap_or_default()),
            tangential: ["p1", "p2"].map(|field| lens(field).unwrap_or_default()),
        };
        let size = [width as u32, height as u32];
        if *plan.stated_size.get_or_insert(size) != size {
            let message = "has another picture size".to_owned();
            return Err(wrong(&place, message, "bring all pictures to one size"));
        }
        let stem = entry.file_path.trim_start_matches("./");
        let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
        let name = name_of(&path, stem.strip_prefix("images/").unwrap_or(stem))?;
        if document.test_filenames.contains(&entry.file_path) {
            held_out.push(name.to_string());
        }
        let moment =
            entry.time.map_or(0, |time| moments.iter().position(|other| *other == time).unwrap_or(0));
        plan.views.push(View {
            camera: camera(name, intrinsics, pose_of(entry)),
            distortion,
            pictures: BTreeMap::from([(moment as u32, inside(&path, request.input, &entry.file_path)?)]),
        });
    }
    if document.frames.iter().any(|entry| entry.depth_file_path.is_some()) {
        plan.note("depth of the source is left out: no one says what made it");
    }
    plan.note("units of the world are those of the reconstruction; up is +Z, as nerfstudio has it");
    let held_out: Vec<&str> = held_out.iter().map(String::as_str).collect();
    plan.finish(request, &held_out)
}

/// Times that occur, ascending; a moment is a place among them.
fn moments(entries: &[Entry]) -> Vec<f64> {
    let mut times: Vec<f64> = entries.iter().filter_map(|entry| entry.time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

fn pose_of(entry: &Entry) -> [f64; 16] {
    let pose = pose::flipped(DMat4::from_cols_array_2d(&entry.transform_matrix).transpose());
    let rotation = pose::nearest_rotation(DMat3::from_mat4(pose));
    pose::rows(DMat4::from_mat3_translation(rotation, pose.w_axis.truncate()))
}
