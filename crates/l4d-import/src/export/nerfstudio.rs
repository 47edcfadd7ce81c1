//! nerfstudio's `transforms.json`, one for each moment: its default reader knows no time.
//!
//! Depth stands beside the pictures in millimetres, planar, 0 where there is none or more than 65.535 m.

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, json};
use l4d_frames::drawn::DepthMap;
use serde::Serialize;

use super::Job;
use super::cloud::Moment;
use super::colmap::moment_folder;
use super::footage::write_png;
use super::manifest::{Called, Manifest};
use crate::{ply, pose};

#[derive(Debug, Serialize)]
struct Transforms {
    camera_model: &'static str,
    w: u32,
    h: u32,
    ply_file_path: &'static str,
    depth_unit_scale_factor: f64,
    frames: Vec<Entry>,
    train_filenames: Vec<String>,
    val_filenames: Vec<String>,
    test_filenames: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Entry {
    file_path: String,
    depth_file_path: String,
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
    for &frame in footage.frames() {
        let folder = moment_folder(order.out, frame);
        let moment = Moment::read(footage, frame)?;
        for view in &moment.views {
            write_png(&folder.join(picture_path(view.camera)), &footage.shown(&view.frame))?;
            let depth_m = view.frame.surfaces.depth_m.clone();
            write_atomic(&folder.join(depth_path(view.camera)), &depth_png(footage.scene(), depth_m))?;
            tick();
        }
        if let Some(camera) = footage.held_out() {
            write_png(&folder.join(picture_path(camera)), &footage.picture(camera, frame)?)?;
            let depth_m = match footage.shows_held_out_pictures() {
                true => footage.frame(camera, frame)?.surfaces.depth_m,
                false => vec![f32::INFINITY; (footage.scene().width * footage.scene().height) as usize],
            };
            write_atomic(&folder.join(depth_path(camera)), &depth_png(footage.scene(), depth_m))?;
            tick();
        }
        let points: Vec<_> = moment.points(order.points).iter().map(|point| point.surface).collect();
        write_atomic(&folder.join("points.ply"), &ply::encode(&points))?;
        let names = |cameras: &[&Camera]| cameras.iter().map(|camera| picture_path(camera)).collect();
        let transforms = Transforms {
            camera_model: "OPENCV",
            w: footage.scene().width,
            h: footage.scene().height,
            ply_file_path: "points.ply",
            depth_unit_scale_factor: 0.001,
            frames: shown.iter().map(|camera| entry(camera, frame)).collect(),
            train_filenames: names(&training),
            val_filenames: names(&test),
            test_filenames: names(&test),
        };
        json::write(&folder.join("transforms.json"), &transforms)?;
    }
    manifest.note(
        "a folder a moment, since the default reader knows no time: `--format dnerf` has all of them at once",
    );
    manifest.note(
        "metres stay metres with `nerfstudio-data --orientation-method none --center-method none \
         --auto-scale-poses False`",
    );
    manifest.note("depth is planar, in millimetres, 0 where there is none or more than 65.535 m");
    manifest.note("depth and points.ply come from the render");
    manifest.note_test_split(footage);
    Ok(manifest)
}

fn entry(camera: &Camera, frame: u32) -> Entry {
    Entry {
        file_path: picture_path(camera),
        depth_file_path: depth_path(camera),
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

fn depth_png(scene: &l4d_data::Scene, depth_m: Vec<f32>) -> Vec<u8> {
    DepthMap { depth_m, ..DepthMap::empty(scene.width, scene.height) }.png()
}
