//! nerfstudio's `transforms.json`, one for each moment: its default reader knows no time.
//!
//! Depth stands beside the pictures in millimetres, planar, 0 where there is none or more than 65.535 m.

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, json};
use serde::Serialize;

use super::Job;
use super::cloud::{self, EACH};
use super::colmap::moment_folder;
use super::footage::Shot;
use super::manifest::{Called, Manifest};
use crate::{points, pose};

/// The points of a moment.
const POINTS: &str = "points.ply";

#[derive(Debug, Serialize)]
struct Transforms {
    camera_model: &'static str,
    w: u32,
    h: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    ply_file_path: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth_unit_scale_factor: Option<f64>,
    frames: Vec<Entry>,
    train_filenames: Vec<String>,
    val_filenames: Vec<String>,
    test_filenames: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Entry {
    file_path: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    depth_file_path: Option<String>,
    fl_x: f64,
    fl_y: f64,
    cx: f64,
    cy: f64,
    transform_matrix: [[f64; 4]; 4],
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, tick } = job;
    let training = footage.training();
    let test = footage.test_split();
    let mut shown: Vec<&Camera> = training.clone();
    shown.extend(footage.held_out());
    for camera in &shown {
        manifest.cameras.push(Called::camera(camera, picture_path(camera)));
    }
    let has_depth = footage.has_depth();
    let mut statement = None;
    for &frame in footage.frames() {
        let folder = moment_folder(order.out, frame);
        let present = footage.present(&shown, frame);
        let shot = |camera| Shot {
            camera,
            frame,
            path: folder.join(picture_path(camera)),
            depth: has_depth.then(|| folder.join(depth_path(camera))),
        };
        let shots: Vec<Shot<'_>> = present.iter().copied().map(shot).collect();
        footage.write_png(&shots, *tick)?;
        let cloud = footage.cloud(frame)?;
        if let Some(cloud) = &cloud {
            write_atomic(&folder.join(POINTS), &points::encode_ply(&cloud.surfaces(order.points)))?;
        }
        let names = |cameras: &[&Camera]| {
            footage.present(cameras, frame).into_iter().map(picture_path).collect::<Vec<String>>()
        };
        let transforms = Transforms {
            camera_model: "OPENCV",
            w: footage.size()[0],
            h: footage.size()[1],
            ply_file_path: cloud.is_some().then_some(POINTS),
            depth_unit_scale_factor: has_depth.then_some(0.001),
            frames: present.iter().map(|camera| entry(camera, frame, has_depth)).collect(),
            train_filenames: names(&training),
            val_filenames: names(&test),
            test_filenames: names(&test),
        };
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
    manifest.note_test_split(footage);
    Ok(manifest)
}

fn entry(camera: &Camera, frame: u32, has_depth: bool) -> Entry {
    Entry {
        file_path: picture_path(camera),
        depth_file_path: has_depth.then(|| depth_path(camera)),
        fl_x: camera.fx,
        fl_y: camera.fy,
        cx: camera.cx,
        cy: camera.cy,
        transform_matrix: pose::nested_rows(pose::flipped(camera.world_from_camera(frame))),
    }
}

fn picture_path(camera: &Camera) -> String {
    format!("images/{}.png", camera.name)
}

fn depth_path(camera: &Camera) -> String {
    format!("depth/{}.png", camera.name)
}
