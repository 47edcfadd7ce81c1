//! A COLMAP model for each moment: for LangSplat and all others that know no time.
//!
//! Moments have folders of their own: readers of `sparse/` take all pictures for one moment. Poses are those of the scene, and tracks say who sees a point.

use std::path::{Path, PathBuf};

use l4d_data::{DataError, json};
use serde_json::json;

use super::cloud::{self, EACH};
use super::manifest::{Called, Manifest};
use super::views::PictureFile;
use super::{Format, Job, is_centred, off_centre};
use crate::points::{add_point, model_of_pinholes, picture_name};

/// The points of a model, without the suffix of its encoding.
const POINTS: &str = "sparse/0/points3D";

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, tick } = job;
    for camera in views.training() {
        manifest.cameras.push(Called::camera(camera, picture_name(&camera.name)));
    }
    let mut statement = None;
    for &frame in &views.frames {
        let folder = moment_folder(request.out, frame);
        let cameras = views.present(&views.training(), frame);
        let held_out = match views.shows_held_out_pictures() {
            true => views.present(&views.held_out(), frame),
            false => Vec::new(),
        };

        let mut pictures = Vec::new();
        for (below, cameras) in [("images", &cameras), ("held_out", &held_out)] {
            for &camera in cameras {
                let path = folder.join(below).join(picture_name(&camera.name));
                pictures.push(PictureFile { camera, frame, path, depth: None });
            }
        }
        views.write_png(&pictures, *tick)?;

        let cloud = views.cloud(frame)?;
        let mut model = model_of_pinholes(&cameras, frame, views.size);
        for point in cloud.iter().flat_map(|cloud| cloud.points(request.points)) {
            // Positions are where the point projects, so that there is no error to speak of.
            let sightings = cloud.as_ref().map(|cloud| cloud.sightings(&point)).unwrap_or_default();
            add_point(&mut model, point.surface, 0.0, &sightings);
        }
        model.write(&folder.join("sparse").join("0"))?;
        statement.get_or_insert_with(|| cloud::statement(POINTS, EACH, cloud.as_ref()));
    }
    let held_out = views.held_out();
    if !held_out.is_empty() {
        let [width, height] = views.size;
        let rig = json!({ "width": width, "height": height, "cameras": held_out });
        json::write(&request.out.join("held_out_camera.json"), &rig)?;
    }
    for camera in held_out {
        manifest.note(format!("{} is in no model; its pose is in held_out_camera.json", camera.name));
    }
    manifest.note("a folder a moment: train each by itself");
    statement.into_iter().for_each(|statement| manifest.note(statement));
    if request.format == Format::LangSplat {
        manifest.note(
            "its reader drops principal points; they are the centre of the picture here, so nothing is lost",
        );
        manifest.note("its reader sorts pictures by name, and with `--eval` keeps every eighth for testing");
    }
    Ok(manifest)
}

/// Refuses cameras that the reader of LangSplat would change: it drops principal points.
pub(super) fn check_centres(job: &Job<'_>) -> Result<(), DataError> {
    let off = job.views.training().into_iter().find(|camera| !is_centred(job.views, camera));
    off.map_or(Ok(()), |camera| Err(off_centre(job.views, camera)))
}

/// The folder of a moment.
pub(super) fn moment_folder(out: &Path, frame: u32) -> PathBuf {
    out.join(format!("frame_{frame:04}"))
}
