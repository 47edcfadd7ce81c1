//! nerfstudio's `transforms.json`, one for each moment: its default reader knows no time.
//!
//! Depth is beside the pictures in millimetres, planar, 0 where there is none or more than 65.535 m.

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, json};
use serde_json::{Value, json};

use super::Job;
use super::cloud::{self, EACH};
use super::colmap::moment_folder;
use super::manifest::{Called, Manifest};
use super::views::PictureFile;
use crate::{points, pose};

/// The points of a moment.
const POINTS: &str = "points.ply";

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, tick } = job;
    let training = views.training();
    let test = views.test_split();
    let shown = views.shown();
    for camera in &shown {
        manifest.cameras.push(Called::camera(camera, picture_path(camera)));
    }
    let has_depth = views.has_depth();
    let mut statement = None;
    for &frame in &views.frames {
        let folder = moment_folder(request.out, frame);
        let present = views.present(&shown, frame);
        let picture = |camera| PictureFile {
            camera,
            frame,
            path: folder.join(picture_path(camera)),
            depth: has_depth.then(|| folder.join(depth_path(camera))),
        };
        let pictures: Vec<PictureFile<'_>> = present.iter().copied().map(picture).collect();
        views.write_png(&pictures, *tick)?;
        let cloud = views.cloud(frame)?;
        if let Some(cloud) = &cloud {
            write_atomic(&folder.join(POINTS), &points::encode_ply(&cloud.surfaces(request.points)))?;
        }
        let names = |cameras: &[&Camera]| {
            views.present(cameras, frame).into_iter().map(picture_path).collect::<Vec<String>>()
        };
        let [width, height] = views.size;
        let mut transforms = json!({ "camera_model": "OPENCV", "w": width, "h": height });
        if cloud.is_some() {
            transforms["ply_file_path"] = json!(POINTS);
        }
        if has_depth {
            transforms["depth_unit_scale_factor"] = json!(0.001);
        }
        let entries: Vec<Value> = present.iter().map(|camera| entry(camera, frame, has_depth)).collect();
        transforms["frames"] = json!(entries);
        for (field, cameras) in
            [("train_filenames", &training), ("val_filenames", &test), ("test_filenames", &test)]
        {
            transforms[field] = json!(names(cameras));
        }
        json::write(&folder.join("transforms.json"), &transforms)?;
        statement.get_or_insert_with(|| cloud::statement(POINTS, EACH, cloud.as_ref()));
    }
    manifest.note("a folder per moment, since the default reader knows no time");
    manifest.note(
        "metres stay metres with `nerfstudio-data --orientation-method none --center-method none \
         --auto-scale-poses False`",
    );
    if has_depth {
        manifest.note("depth comes from the render: planar, in millimetres, 0 where there is none or more than 65.535 m");
    }
    statement.into_iter().for_each(|statement| manifest.note(statement));
    manifest.note_test_split(views);
    Ok(manifest)
}

fn entry(camera: &Camera, frame: u32, has_depth: bool) -> Value {
    let mut entry = json!({ "file_path": picture_path(camera) });
    if has_depth {
        entry["depth_file_path"] = json!(depth_path(camera));
    }
    for (field, number) in [("fl_x", camera.fx), ("fl_y", camera.fy), ("cx", camera.cx), ("cy", camera.cy)] {
        entry[field] = json!(number);
    }
    entry["transform_matrix"] = json!(pose::nested_rows(pose::flipped(camera.world_from_camera(frame))));
    entry
}

fn picture_path(camera: &Camera) -> String {
    format!("images/{}.png", camera.name)
}

fn depth_path(camera: &Camera) -> String {
    format!("depth/{}.png", camera.name)
}
