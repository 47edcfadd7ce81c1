//! nerfstudio's `transforms.json`: each picture is a view; pictures that state a time are moments of one clip.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4};
use l4d_data::error::inert;
use l4d_data::{DataError, json};
use serde::Deserialize;

use super::Order;
use super::lens::Distortion;
use super::plan::{Plan, View, camera, inside, name_of};
use crate::pose;

#[derive(Debug, Deserialize)]
struct Transforms {
    #[serde(default)]
    camera_model: Option<String>,
    #[serde(flatten)]
    lens: Lens,
    frames: Vec<Entry>,
    #[serde(default)]
    test_filenames: Vec<String>,
    #[serde(default)]
    camera_angle_x: Option<f64>,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
struct Lens {
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
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
    lens: Lens,
}

impl Lens {
    /// What a picture says itself, or else what the document says.
    fn or(self, other: Self) -> Self {
        Self {
            fl_x: self.fl_x.or(other.fl_x),
            fl_y: self.fl_y.or(other.fl_y),
            cx: self.cx.or(other.cx),
            cy: self.cy.or(other.cy),
            w: self.w.or(other.w),
            h: self.h.or(other.h),
            k1: self.k1.or(other.k1),
            k2: self.k2.or(other.k2),
            k3: self.k3.or(other.k3),
            p1: self.p1.or(other.p1),
            p2: self.p2.or(other.p2),
        }
    }

    fn distortion(self) -> Distortion {
        Distortion {
            radial: [self.k1, self.k2, self.k3].map(Option::unwrap_or_default),
            tangential: [self.p1, self.p2].map(Option::unwrap_or_default),
        }
    }
}

pub(super) fn plan(order: &Order<'_>) -> Result<Plan, DataError> {
    let path = order.input.join("transforms.json");
    let document: Transforms = json::read(&path)?;
    let wrong =
        |place: &str, message: String, remedy: &str| DataError::invalid(&path, place, message, remedy);
    let lenses = ["PINHOLE", "SIMPLE_PINHOLE", "OPENCV", "SIMPLE_RADIAL", "RADIAL"];
    if let Some(model) = document.camera_model.as_deref().filter(|model| !lenses.contains(model)) {
        let message = format!("`{}` is no perspective lens", inert(model));
        let remedy =
            "undistort the pictures to a pinhole first (`ns-process-data --camera-type perspective`)";
        return Err(wrong("field `camera_model`", message, remedy));
    }
    let mut plan = Plan::new(vec![path.clone()]);
    let moments = moments(&document.frames);
    let mut held_out = Vec::new();
    for (index, entry) in document.frames.iter().enumerate() {
        let place = format!("field `frames[{index}]`");
        let lens = entry.lens.or(document.lens);
        let missing = || {
            wrong(
                &place,
                "has neither its own size and focal length nor the document's".to_owned(),
                "write w, h, fl_x, fl_y, cx, cy",
            )
        };
        let (width, height) = lens.w.zip(lens.h).ok_or_else(missing)?;
        let from_angle = document.camera_angle_x.map(|angle| width / 2.0 / (angle / 2.0).tan());
        let fx = lens.fl_x.or(from_angle).ok_or_else(missing)?;
        let intrinsics =
            [fx, lens.fl_y.unwrap_or(fx), lens.cx.unwrap_or(width / 2.0), lens.cy.unwrap_or(height / 2.0)];
        let size = [width as u32, height as u32];
        if *plan.stated_size.get_or_insert(size) != size {
            return Err(wrong(
                &place,
                "has another picture size".to_owned(),
                "bring all pictures to one size",
            ));
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
            distortion: lens.distortion(),
            pictures: BTreeMap::from([(moment as u32, inside(&path, order.input, &entry.file_path)?)]),
        });
    }
    if document.frames.iter().any(|entry| entry.depth_file_path.is_some()) {
        plan.note("depth of the source is left out: no one says what made it");
    }
    if plan.views.iter().any(|view| !view.distortion.is_none()) {
        plan.note("lenses are undone: pictures are what pinholes would have seen");
    }
    plan.note("units of the world are those of the reconstruction; up is +Z, as nerfstudio has it");
    let held_out: Vec<&str> = held_out.iter().map(String::as_str).collect();
    plan.hold_out(order, &held_out)?;
    Ok(plan)
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
