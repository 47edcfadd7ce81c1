//! D-NeRF's `transforms_{train,val,test}.json`: true ones, and ones that 4DGaussians' reader turns into the truth.
//!
//! That reader makes every picture 800x800 with one field of view, and mirrors the camera's position along its x axis:
//! for it pictures are cut to a square, and positions are mirrored beforehand. Both files look alike, so the manifest
//! says which is which.

use std::path::Path;

use glam::DMat4;
use l4d_data::store::write_atomic;
use l4d_data::timeline::LAST_FRAME;
use l4d_data::{Camera, DataError, json};
use l4d_frames::drawn::RgbImage;
use rayon::prelude::*;
use serde::Serialize;

use super::cloud::{self, FIRST};
use super::footage::write_png;
use super::manifest::{Called, Manifest};
use super::{Format, Job, is_centred, limit, off_centre};
use crate::{ply, pose};

/// The first points.
const POINTS: &str = "fused.ply";

#[derive(Debug, Serialize)]
struct Transforms {
    /// Horizontal field of view, radians.
    camera_angle_x: f64,
    frames: Vec<Entry>,
}

#[derive(Debug, Serialize)]
struct Entry {
    /// Without suffix.
    file_path: String,
    /// From 0 to 1.
    time: f64,
    transform_matrix: [[f64; 4]; 4],
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, .. } = job;
    let training = footage.training();
    let test = footage.test_split();
    let is_blender = order.format == Format::Blender;
    let [width, height] = footage.size();
    let width_px = if is_blender { width.min(height) } else { width };
    let camera_angle_x = 2.0 * (f64::from(width_px) / 2.0 / training[0].fx).atan();
    for camera in footage.training().into_iter().chain(footage.held_out()) {
        manifest.cameras.push(Called::camera(camera, camera.name.as_str()));
    }
    for (split, cameras) in [("train", &training), ("val", &test), ("test", &test)] {
        let entry = |camera: &Camera, frame: u32| {
            let world_from_camera = camera.world_from_camera(frame);
            Entry {
                file_path: format!("./{split}/{}_{frame:04}", camera.name),
                time: time_of(footage.frames(), frame),
                transform_matrix: pose::nested_rows(if is_blender {
                    for_4dgaussians(world_from_camera)
                } else {
                    pose::flipped(world_from_camera)
                }),
            }
        };
        let shots: Vec<(&Camera, u32)> = footage
            .frames()
            .iter()
            .flat_map(|&frame| footage.present(cameras, frame).into_iter().map(move |camera| (camera, frame)))
            .collect();
        let frames = shots.iter().map(|(camera, frame)| entry(camera, *frame)).collect();
        let path = order.out.join(format!("transforms_{split}.json"));
        json::write(&path, &Transforms { camera_angle_x, frames })?;
        write_pictures(job, split, &shots, is_blender)?;
    }
    let cloud = footage.cloud(footage.frames()[0])?;
    if let Some(cloud) = &cloud {
        write_atomic(&order.out.join(POINTS), &ply::encode(&cloud.surfaces(order.points)))?;
    }

    manifest.note("time runs from 0, the first exported frame, to 1, the last");
    if is_blender {
        manifest.note(format!(
            "pictures are cut to their middle {width_px}x{width_px}, since the reader makes all of them 800x800"
        ));
        manifest.note(
            "matrices are mirrored so that the reader of 4DGaussians, which mirrors them, has the true cameras: \
             for every other reader use `--format dnerf`",
        );
    } else {
        manifest.note(
            "not for 4DGaussians, whose reader mirrors positions: use `--format 4dgaussians-blender` there",
        );
    }
    manifest.note(cloud::statement(POINTS, FIRST, cloud.as_ref()));
    manifest.note_test_split(footage);
    Ok(manifest)
}

/// Time from 0 to 1; a single moment has the time 0.
fn time_of(frames: &[u32], frame: u32) -> f64 {
    let (first, last) = (frames.first().copied().unwrap_or(0), frames.last().copied().unwrap_or(LAST_FRAME));
    f64::from(frame - first) / f64::from((last - first).max(1))
}

/// The matrix of which 4DGaussians makes this pose.
///
/// Its reader takes the inverse and flips y and z of the rotation, but all three signs of the translation, where x should
/// stay. Mirroring x of the inverse's translation beforehand undoes that.
fn for_4dgaussians(world_from_camera: DMat4) -> DMat4 {
    let mut camera_from_world = pose::flipped(world_from_camera).inverse();
    camera_from_world.w_axis.x = -camera_from_world.w_axis.x;
    camera_from_world.inverse()
}

fn write_pictures(
    job: &Job<'_>,
    split: &str,
    shots: &[(&Camera, u32)],
    is_square: bool,
) -> Result<(), DataError> {
    shots.par_iter().try_for_each(|(camera, frame)| {
        let picture = job.footage.picture(camera, *frame)?;
        let picture = if is_square { middle_square(&picture) } else { picture };
        let path = job.order.out.join(Path::new(split)).join(format!("{}_{frame:04}.png", camera.name));
        write_png(&path, &picture)?;
        (job.tick)();
        Ok(())
    })
}

fn middle_square(picture: &RgbImage) -> RgbImage {
    let (width, height) = picture.dimensions();
    let side = width.min(height);
    let (left, top) = ((width - side) / 2, (height - side) / 2);
    RgbImage::from_fn(side, side, |column, row| *picture.get_pixel(left + column, top + row))
}

pub(super) fn check(job: &Job<'_>) -> Result<(), DataError> {
    let footage = job.footage;
    let [width, height] = footage.size();
    let refuse = |field: &str, message: String| Err(limit(footage, field, message));
    let is_square = job.order.format == Format::Blender;
    if is_square && width.abs_diff(height) % 2 == 1 {
        return refuse("width", format!("{width}x{height} has no square in its middle"));
    }
    let cameras: Vec<&Camera> = footage.training().into_iter().chain(footage.held_out()).collect();
    for camera in &cameras {
        let name = &camera.name;
        if !is_centred(footage, camera) {
            return Err(off_centre(footage, camera));
        }
        if camera.fx != camera.fy || camera.fx != cameras[0].fx {
            return refuse("fx", format!("{name} has another focal length, and readers know one"));
        }
    }
    Ok(())
}
