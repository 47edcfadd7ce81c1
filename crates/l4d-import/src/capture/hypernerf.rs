//! Nerfies and HyperNeRF: a file a camera and moment, and lists of what is trained on.
//!
//! Cameras move. Pictures whose names begin alike (`left1_`, `right1_`) are one view; moments are those of
//! `metadata.json`. Distortion is removed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4, DVec3};
use l4d_data::{Camera, DataError, Split, json};
use serde::Deserialize;

use super::CaptureRequest;
use super::lens::Distortion;
use super::plan::{Plan, View, camera, inside, is_wanted, name_of};
use crate::pose;

const HINT: &str = "restore the folder from the data set";
/// Intrinsics of one view agree to this, relative.
const SAME: f64 = 1e-6;
/// No clip is longer, moments: poses are stored for each number up to the last.
const MOST_MOMENTS: u32 = 100_000;

#[derive(Debug, Deserialize)]
struct Dataset {
    ids: Vec<String>,
    #[serde(default)]
    train_ids: Vec<String>,
    #[serde(default)]
    val_ids: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Metadata {
    warp_id: u32,
    #[serde(default)]
    time_id: Option<u32>,
}

#[derive(Debug, Deserialize)]
struct Card {
    /// World to camera, rows.
    orientation: [[f64; 3]; 3],
    position: [f64; 3],
    focal_length: f64,
    principal_point: [f64; 2],
    #[serde(default)]
    skew: f64,
    #[serde(default = "one")]
    pixel_aspect_ratio: f64,
    #[serde(default)]
    radial_distortion: [f64; 3],
    #[serde(default, alias = "tangential")]
    tangential_distortion: [f64; 2],
    image_size: [u32; 2],
}

fn one() -> f64 {
    1.0
}

/// One picture of a view.
struct PictureEntry {
    moment: u32,
    world_from_camera: [f64; 16],
    picture: PathBuf,
    is_trained_on: bool,
}

pub(super) fn plan(request: &CaptureRequest<'_>) -> Result<Plan, DataError> {
    let path = request.input.join("dataset.json");
    let dataset: Dataset = json::read(&path)?;
    let metadata_path = request.input.join("metadata.json");
    let metadata: BTreeMap<String, Metadata> = json::read(&metadata_path)?;
    let (scale, pictures) = picture_folder(request.input)?;
    let mut plan = Plan::new(vec![path.clone(), metadata_path.clone()]);
    let mut found: BTreeMap<String, (Camera, Distortion, Vec<PictureEntry>)> = BTreeMap::new();
    for id in &dataset.ids {
        let card_path = inside(&path, &request.input.join("camera"), &format!("{id}.json"))?;
        let card: Card = json::read(&card_path)?;
        let facts = metadata
            .get(id)
            .ok_or_else(|| DataError::invalid(&metadata_path, format!("entry `{id}`"), "is missing", HINT))?;
        let moment = facts.time_id.unwrap_or(facts.warp_id);
        if moment > MOST_MOMENTS {
            let message = format!("moment {moment} lies beyond {MOST_MOMENTS}");
            return Err(DataError::invalid(&path, format!("entry `{id}`"), message, HINT));
        }
        if !is_wanted(request, None, moment) {
            continue;
        }
        if card.skew != 0.0 {
            let message = format!("is {}, but rows and columns are taken to be at right angles", card.skew);
            return Err(DataError::invalid(&card_path, "field `skew`", message, HINT));
        }
        plan.stated_size.get_or_insert(card.image_size);
        let entry = PictureEntry {
            moment,
            world_from_camera: card.world_from_camera(),
            picture: inside(&path, &pictures, &format!("{id}.png"))?,
            is_trained_on: dataset.train_ids.is_empty() || dataset.train_ids.contains(id),
        };
        let (title, _) = id.rsplit_once('_').unwrap_or(("cam", id));
        let (view, distortion) =
            (camera(name_of(&path, title)?, card.intrinsics(), entry.world_from_camera), card.distortion());
        match found.get_mut(title) {
            None => drop(found.insert(title.to_owned(), (view, distortion, vec![entry]))),
            Some((first, lens, list)) if *lens == distortion && is_same(first, &view) => {
                list.push(entry);
            }
            Some(_) => {
                let message = "has other intrinsics than the first picture of its view";
                return Err(DataError::invalid(&card_path, "camera", message, HINT));
            }
        }
    }
    for (_, (view, distortion, list)) in found {
        plan.views.push(view_of(view, distortion, list));
    }
    plan.note(format!("pictures are those of rgb/{scale}x"));
    if !dataset.val_ids.is_empty() && plan.views.iter().all(|view| view.camera.split == Split::Train) {
        plan.note("the source holds out moments of its camera, not a camera: nothing is held out here");
    }
    plan.note("scene.json's scale and centre are left out: units are those of the cameras");
    plan.finish(request, &[])
}

/// A view with a pose for each number up to its last moment; moments that it did not see repeat the pose before.
fn view_of(mut camera: Camera, distortion: Distortion, mut list: Vec<PictureEntry>) -> View {
    list.sort_by_key(|entry| entry.moment);
    if list.iter().all(|entry| !entry.is_trained_on) {
        camera.split = Split::Test;
    }
    let mut poses = Vec::new();
    for entry in &list {
        let before = poses.last().copied().unwrap_or(entry.world_from_camera);
        poses.resize(entry.moment as usize + 1, before);
        poses[entry.moment as usize] = entry.world_from_camera;
    }
    let stands_still = poses.iter().all(|pose| *pose == poses[0]);
    camera.world_from_camera = if stands_still { vec![poses[0]] } else { poses };
    let pictures = list.into_iter().map(|entry| (entry.moment, entry.picture)).collect();
    View { camera, distortion, pictures }
}

impl Card {
    fn intrinsics(&self) -> [f64; 4] {
        let [cx, cy] = self.principal_point;
        [self.focal_length, self.focal_length * self.pixel_aspect_ratio, cx, cy]
    }

    fn distortion(&self) -> Distortion {
        Distortion { radial: self.radial_distortion, tangential: self.tangential_distortion }
    }

    fn world_from_camera(&self) -> [f64; 16] {
        let camera_from_world = DMat3::from_cols_array_2d(&self.orientation).transpose();
        let rotation = pose::nearest_rotation(camera_from_world).transpose();
        pose::rows(DMat4::from_mat3_translation(rotation, DVec3::from_array(self.position)))
    }
}

fn is_same(a: &Camera, b: &Camera) -> bool {
    let numbers = |camera: &Camera| [camera.fx, camera.fy, camera.cx, camera.cy];
    numbers(a).into_iter().zip(numbers(b)).all(|(a, b)| (a - b).abs() <= SAME * a.abs())
}

/// The largest pictures at hand: `rgb/1x`, `2x`, ...
fn picture_folder(input: &Path) -> Result<(u32, PathBuf), DataError> {
    let folders = [1, 2, 4, 8, 16].map(|scale| (scale, input.join("rgb").join(format!("{scale}x"))));
    folders.into_iter().find(|(_, folder)| folder.is_dir()).ok_or_else(|| {
        DataError::invalid(&input.join("rgb"), "folder", "holds none of 1x, 2x, 4x, 8x, 16x", HINT)
    })
}
