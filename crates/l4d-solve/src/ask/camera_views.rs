//! What cameras see of an answer: masks on disk, and how many pixels.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Name, Split};
use l4d_masks::{Mask, png};
use serde_json::{Map, Value, json};

use crate::clips::{Plan, Shot};

/// `masks/<camera>/<frame or time>.png`
pub(super) fn write_masks(folder: &Path, plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> Result<(), DataError> {
    for (shot, mask) in masks {
        let (camera, instant) = (&plan.cameras[shot.view], &plan.instants[shot.instant]);
        let path = folder.join("masks").join(camera.name.as_str()).join(format!("{}.png", instant.key));
        write_atomic(&path, &png::encode(mask))?;
    }
    Ok(())
}

/// Camera -> frame or time -> pixels of the answer.
pub(super) fn pixels(plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> Value {
    let mut cameras = Map::new();
    for (shot, mask) in masks {
        let (camera, instant) = (&plan.cameras[shot.view], &plan.instants[shot.instant]);
        let of_camera = cameras.entry(camera.name.to_string()).or_insert_with(|| json!({}));
        of_camera[&instant.key] = json!(mask.area());
    }
    Value::Object(cameras)
}

/// What a camera sees of the answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CameraView {
    /// Its name.
    pub camera: Name,
    /// Whether it is held out.
    pub is_held_out: bool,
    /// Frames in which the answer is seen.
    pub seen: usize,
    /// All frames.
    pub frames: usize,
    /// Pixels in the frame with the most.
    pub most_px: u64,
}

/// Camera by camera.
pub(super) fn camera_views(plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> Vec<CameraView> {
    let of_camera = |(view, camera): (usize, &Camera)| {
        let areas: Vec<u64> =
            masks.iter().filter(|(shot, _)| shot.view == view).map(|(_, mask)| mask.area()).collect();
        CameraView {
            camera: camera.name.clone(),
            is_held_out: camera.split == Split::Test,
            seen: areas.iter().filter(|&&pixels| pixels > 0).count(),
            frames: areas.len(),
            most_px: areas.iter().copied().max().unwrap_or(0),
        }
    };
    plan.cameras.iter().enumerate().map(of_camera).collect()
}
