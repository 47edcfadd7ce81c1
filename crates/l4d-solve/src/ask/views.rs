//! From where and when masks are wanted, and what those cameras see of an answer.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Interval, Name, Rig, Split, StageError};
use l4d_masks::{Mask, Rle, png};
use serde_json::{Map, Value, json};

use super::Ask;
use crate::clips::{PictureIndex, Plan, instants_at};
use crate::scene::{Places, SolveScene};

/// The cameras that were named, else those of the file, else the held-out one; at the moments of the clips, or at the
/// times that were named.
pub(super) fn wanted(
    order: &Ask<'_>,
    range: Option<Interval>,
    scene: &SolveScene,
    places: &Places,
) -> Result<Plan, StageError> {
    let file = order.camera_file.map(Rig::read).transpose()?;
    let rig = file.as_ref().unwrap_or(&scene.rig);
    let cameras = match (order.cameras, &file) {
        ([], Some(file)) => file.cameras.clone(),
        ([], None) => scene.judged(places)?.cameras,
        (names, _) => {
            names.iter().map(|name| camera(rig, name).cloned()).collect::<Result<_, StageError>>()?
        }
    };
    // Of the scene's own cameras, pictures as large as the clips.
    let (camera_size, size) = match &file {
        None => (scene.plan.camera_size, scene.plan.size),
        Some(file) => (file.size(), file.size()),
    };
    // `range` has been taken out of the moments of the clips already.
    let mut instants = match order.times {
        [] => scene.plan.instants.clone(),
        times => instants_at(times, &cameras)?,
    };
    if let Some(range) = range {
        let ends = [range.first(), range.last()].map(|frame| scene.timeline.time(frame));
        instants.retain(|instant| (ends[0]..=ends[1]).contains(&instant.time));
        if instants.is_empty() {
            return Err(StageError::new(
                format!("no moment of the masks lies between frames {} and {}", range.first(), range.last()),
                "widen --from and --to, or choose other --times; clips have some frames alone",
            ));
        }
    }
    Ok(Plan { cameras, camera_size, size: order.size.unwrap_or(size), instants })
}

fn camera<'a>(rig: &'a Rig, name: &str) -> Result<&'a Camera, StageError> {
    rig.camera(name).ok_or_else(|| {
        let known: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
        StageError::new(
            format!("there is no camera `{}`", name.escape_debug()),
            format!("choose among {}", known.join(", ")),
        )
    })
}

/// `masks/<camera>/<frame or time>.png`
pub(super) fn write_masks(
    folder: &Path,
    plan: &Plan,
    masks: &BTreeMap<PictureIndex, Mask>,
) -> Result<(), DataError> {
    for (index, mask) in masks {
        write_atomic(&folder.join(mask_name(plan, *index)), &png::encode(mask))?;
    }
    Ok(())
}

/// Where the mask of a picture goes.
pub(super) fn mask_name(plan: &Plan, index: PictureIndex) -> String {
    let (camera, instant) = plan.of(index);
    format!("masks/{}/{}.png", camera.name, instant.key)
}

/// Camera -> frame or time -> pixels of the answer.
pub(super) fn pixels(plan: &Plan, masks: &BTreeMap<PictureIndex, Mask>) -> Value {
    let mut cameras = Map::new();
    for (index, mask) in masks {
        let (camera, instant) = plan.of(*index);
        let of_camera = cameras.entry(camera.name.to_string()).or_insert_with(|| json!({}));
        of_camera[&instant.key] = json!(mask.area());
    }
    Value::Object(cameras)
}

/// The masks of an answer from one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenMasks {
    /// The camera.
    pub camera: Name,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Frame or time -> mask, none where it is not seen.
    pub masks: BTreeMap<String, Option<Rle>>,
}

impl SeenMasks {
    /// Those of the first camera of a plan.
    pub(super) fn of(plan: &Plan, masks: &BTreeMap<PictureIndex, Mask>) -> Option<Self> {
        let of_first = masks.iter().filter(|(index, _)| index.view == 0);
        let one = |(index, mask): (&PictureIndex, &Mask)| {
            (plan.of(*index).1.key.clone(), (!mask.is_empty()).then(|| mask.to_rle()))
        };
        Some(Self {
            camera: plan.cameras.first()?.name.clone(),
            size: plan.size,
            masks: of_first.map(one).collect(),
        })
    }
}

/// What a camera sees of the answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CameraView {
    pub(super) camera: Name,
    pub(super) is_held_out: bool,
    /// Frames in which the answer is seen.
    pub(super) seen: usize,
    /// All frames.
    pub(super) frames: usize,
    /// Pixels in the frame with the most.
    pub(super) most_px: u64,
}

/// Camera by camera.
pub(super) fn camera_views(plan: &Plan, masks: &BTreeMap<PictureIndex, Mask>) -> Vec<CameraView> {
    let of_camera = |(view, camera): (usize, &Camera)| {
        let areas: Vec<u64> =
            masks.iter().filter(|(index, _)| index.view == view).map(|(_, mask)| mask.area()).collect();
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
