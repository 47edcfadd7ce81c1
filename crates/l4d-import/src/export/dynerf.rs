//! Neu3D's layout, as 4DGaussians (`dynerf`) and 4D LangSplat read it: LLFF poses and a folder a camera.
//!
//! One focal length, no principal point, 4:3 pictures that readers make 1352x1014, and the first camera held out.

use std::path::Path;

use glam::DMat4;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError};

use super::cloud::{Moment, SeenPoint};
use super::footage::Shot;
use super::manifest::{Called, Manifest};
use super::{Format, Job, limit};
use crate::{npy, ply};

/// Width and height that `poses_bounds.npy` has to state: readers divide by the first whatever stands there.
const STATED_WIDTH: f64 = 2704.0;
const STATED_HEIGHT: f64 = 2028.0;
/// Moments that readers take, and that time is counted by.
const MOMENTS: usize = 300;
/// Pixels by which a principal point may miss the centre.
const CENTRE_TOLERANCE_PX: f64 = 1e-6;

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, tick } = job;
    let first = footage.test_split();
    let cameras: Vec<&Camera> = first.into_iter().chain(footage.training()).collect();
    check(job, &cameras)?;

    let frames = footage.frames();
    let is_padded = order.format == Format::FourDLangSplat;
    let mut shots = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let name = format!("cam{number:02}");
        for (moment, &frame) in frames.iter().enumerate() {
            let path = order.out.join(&name).join("images").join(format!("{moment:04}.png"));
            shots.push(Shot { camera, frame, path });
        }
        manifest.cameras.push(Called::camera(camera, name));
    }
    footage.write_png(&shots, *tick)?;
    for number in 0..cameras.len() {
        let name = format!("cam{number:02}");
        // Readers count these files; what is in them is read only where pictures are missing.
        write_atomic(&order.out.join(format!("{name}.mp4")), b"")?;
        if is_padded {
            repeat_last(&order.out.join(name).join("images"), frames.len())?;
        }
    }

    let moment = Moment::read(footage, frames[0])?;
    let points = moment.points(order.points);
    let surfaces: Vec<_> = points.iter().map(|point| point.surface).collect();
    write_atomic(&order.out.join("points3D_downsample2.ply"), &ply::encode(&surfaces))?;
    let rows: Vec<f64> = cameras.iter().flat_map(|camera| row(job, camera, &points)).collect();
    write_atomic(&order.out.join("poses_bounds.npy"), &npy::encode_f64(&[cameras.len(), 17], &rows))?;

    manifest.note(format!(
        "readers make pictures 1352x1014 and divide focal lengths by two, so that {STATED_WIDTH}x{STATED_HEIGHT} and a \
         focal length to match are stated"
    ));
    manifest.note(format!("time of the i-th moment is i / {MOMENTS}, however many there are"));
    if is_padded {
        manifest.note(format!(
            "its reader wants exactly {MOMENTS} moments: those from {} on repeat the last",
            frames.len()
        ));
    }
    manifest.note("cam*.mp4 are empty: readers count them, and read the PNG files");
    manifest.note("a full stop in the path of the folder misleads its reader: use a path without");
    manifest.note("points3D_downsample2.ply comes from rendered depth at the first moment");
    manifest.note_test_split(footage);
    Ok(manifest)
}

fn check(job: &Job<'_>, cameras: &[&Camera]) -> Result<(), DataError> {
    let footage = job.footage;
    let (width, height) = (footage.scene().width, footage.scene().height);
    let refuse = |field: &str, message: String| Err(limit(footage, field, message));
    if width * 3 != height * 4 {
        return refuse("width", format!("{width}x{height} is not 4:3, and readers would bend the pictures"));
    }
    if footage.frames().len() > MOMENTS {
        return refuse("stride", format!("there are more than {MOMENTS} moments, and readers drop the rest"));
    }
    for camera in cameras {
        let name = &camera.name;
        let off_x = (camera.cx - f64::from(width) / 2.0).abs();
        let off_y = (camera.cy - f64::from(height) / 2.0).abs();
        if off_x > CENTRE_TOLERANCE_PX || off_y > CENTRE_TOLERANCE_PX {
            return refuse(
                "cx",
                format!("the principal point of {name} is not the centre, and readers drop it"),
            );
        }
        if camera.fx != camera.fy || camera.fx != cameras[0].fx {
            return refuse("fx", format!("{name} has another focal length, and readers know one"));
        }
        if camera.world_from_camera.len() > 1 {
            return refuse("world_from_camera", format!("{name} moves, and readers know one pose a camera"));
        }
    }
    Ok(())
}

/// 3x5 numbers `[down | right | back | centre | height, width, focal length]` row by row, then near and far.
fn row(job: &Job<'_>, camera: &Camera, points: &[SeenPoint]) -> [f64; 17] {
    let world_from_camera = camera.world_from_camera(0);
    let focal = camera.fx * STATED_WIDTH / f64::from(job.footage.scene().width);
    let hwf = [STATED_HEIGHT, STATED_WIDTH, focal];
    let DMat4 { x_axis: right, y_axis: down, z_axis: forward, w_axis: centre } = world_from_camera;
    let [near, far] = bounds(job, camera, points);
    let mut row = [0.0; 17];
    for axis in 0..3 {
        row[axis * 5..axis * 5 + 5].copy_from_slice(&[
            down[axis],
            right[axis],
            -forward[axis],
            centre[axis],
            hwf[axis],
        ]);
    }
    row[15] = near;
    row[16] = far;
    row
}

/// The depths between which all but a thousandth of the visible points lie, as LLFF has it, metres.
fn bounds(job: &Job<'_>, camera: &Camera, points: &[SeenPoint]) -> [f64; 2] {
    let size = [job.footage.scene().width, job.footage.scene().height].map(f64::from);
    let mut depths: Vec<f64> = points
        .iter()
        .map(|point| camera.project(0, point.surface.position))
        .filter(|(at, depth_m)| {
            *depth_m > 0.0 && (0.0..size[0]).contains(&at.x) && (0.0..size[1]).contains(&at.y)
        })
        .map(|(_, depth_m)| depth_m)
        .collect();
    depths.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        let place = (share * depths.len().saturating_sub(1) as f64).round() as usize;
        depths.get(place).copied()
    };
    // A camera that sees no surface has no bounds; readers use them for a spiral of show cameras alone.
    [at(0.001).unwrap_or(0.1), at(0.999).unwrap_or(100.0)]
}

/// Fills a folder up to the moments that a reader wants, without storing the last picture again where links work.
fn repeat_last(images: &Path, count: usize) -> Result<(), DataError> {
    let last = images.join(format!("{:04}.png", count - 1));
    for moment in count..MOMENTS {
        let path = images.join(format!("{moment:04}.png"));
        if path.is_file() {
            std::fs::remove_file(&path).map_err(|source| DataError::io(&path, "replace", source))?;
        }
        std::fs::hard_link(&last, &path)
            .or_else(|_| std::fs::copy(&last, &path).map(drop))
            .map_err(|source| DataError::io(&path, "write", source))?;
    }
    Ok(())
}
