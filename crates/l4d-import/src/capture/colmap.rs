//! COLMAP's models: each picture is a view of one moment.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::{DataError, Name};
use l4d_formats::colmap::{CameraModel, Model, ModelCamera, ModelPoint};

use super::CaptureRequest;
use super::lens::Distortion;
use super::plan::{Plan, PlanPoint, View, camera, inside, name_of};
use crate::points::ColouredPoint;
use crate::pose;

pub(super) fn plan(request: &CaptureRequest<'_>) -> Result<Plan, DataError> {
    let folder = model_folder(request.input)?;
    let model = Model::read(&folder)?;
    let suffix = if folder.join("cameras.bin").is_file() { "bin" } else { "txt" };
    let inputs = ["cameras", "images", "points3D"].map(|stem| folder.join(format!("{stem}.{suffix}")));
    let mut plan = Plan::new(inputs.to_vec());
    let mut images: Vec<_> = model.images.iter().collect();
    images.sort_by(|a, b| a.name.cmp(&b.name));
    let mut names: BTreeMap<u32, Name> = BTreeMap::new();
    for image in images {
        let Some(intrinsics) = model.camera(image.camera) else { continue };
        let size = [intrinsics.width as u32, intrinsics.height as u32];
        if *plan.stated_size.get_or_insert(size) != size {
            let hint = "undistort the images to one size first (`colmap image_undistorter`)";
            let (place, message) = (format!("camera {}", intrinsics.id), "has another picture size");
            return Err(DataError::invalid(&inputs[0], place, message, hint));
        }
        let stem = image.name.rsplit_once('.').map_or(image.name.as_str(), |(stem, _)| stem);
        let name = name_of(&inputs[1], stem)?;
        names.insert(image.id, name.clone());
        let world_from_camera = pose::rows(image.camera_from_world().inverse());
        plan.views.push(View {
            camera: camera(name, intrinsics.pinhole(), world_from_camera),
            distortion: distortion_of(intrinsics),
            pictures: BTreeMap::from([(0, inside(&inputs[1], &request.input.join("images"), &image.name)?)]),
        });
    }
    plan.note("one moment: a model knows no time");
    plan.note("units and directions of the world are those of the reconstruction; up is unknown");
    plan.points = model.points.iter().map(|point| plan_point(point, &names)).collect();
    plan.finish(request, &[])
}

/// `sparse/0`, `sparse`, or the folder itself.
fn model_folder(input: &Path) -> Result<PathBuf, DataError> {
    let candidates = [input.join("sparse/0"), input.join("sparse"), input.to_owned()];
    let holds =
        |folder: &&PathBuf| ["bin", "txt"].iter().any(|end| folder.join(format!("cameras.{end}")).is_file());
    candidates.iter().find(holds).cloned().ok_or_else(|| {
        let message = "holds no cameras.bin nor cameras.txt, neither itself nor in sparse/0";
        DataError::invalid(input, "folder", message, "give the folder that holds `sparse` and `images`")
    })
}

fn plan_point(point: &ModelPoint, names: &BTreeMap<u32, Name>) -> PlanPoint {
    let mut images: Vec<u32> = point.track.iter().map(|(image, _)| *image).collect();
    images.sort_unstable();
    images.dedup();
    PlanPoint {
        surface: ColouredPoint { position: point.position, rgb: point.rgb },
        error_px: point.error_px,
        views: images.iter().filter_map(|image| names.get(image).cloned()).collect(),
    }
}

fn distortion_of(camera: &ModelCamera) -> Distortion {
    let mut distortion = Distortion::default();
    match (camera.model, camera.parameters.as_slice()) {
        (CameraModel::SimpleRadial, &[_, _, _, k]) => distortion.radial[0] = k,
        (CameraModel::Radial, &[_, _, _, k1, k2]) => distortion.radial[..2].copy_from_slice(&[k1, k2]),
        (CameraModel::OpenCv, &[_, _, _, _, k1, k2, p1, p2]) => {
            distortion.radial[..2].copy_from_slice(&[k1, k2]);
            distortion.tangential = [p1, p2];
        }
        _ => {}
    }
    distortion
}
