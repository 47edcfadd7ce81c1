//! Neu3D's layout, as 4DGaussians (`dynerf`) and 4D LangSplat read it: LLFF poses and a folder a camera.
//!
//! One focal length, no principal point, 4:3 pictures that readers make 1352x1014, and the first camera held out.

use std::path::Path;

use glam::DMat4;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError};
use l4d_formats::npy;

use super::cloud::{self, FIRST};
use super::manifest::{Called, Manifest};
use super::views::PictureFile;
use super::{Format, Job, is_centred, limit, off_centre};
use crate::points::{self, ColouredPoint};

/// The first points.
const POINTS: &str = "points3D_downsample2.ply";

/// Width and height that `poses_bounds.npy` has to state: readers divide by the first whatever is there.
const STATED_WIDTH: f64 = 2704.0;
const STATED_HEIGHT: f64 = 2028.0;
/// Bounds of a camera that sees no known surface.
const UNKNOWN_BOUNDS: [f64; 2] = [0.1, 100.0];
/// Moments that readers take, and that time is counted by.
const MOMENTS: usize = 300;

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, tick } = job;
    let cameras = cameras(job);
    let frames = &views.frames;
    let is_padded = request.format == Format::FourDLangSplat;
    let mut pictures = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let name = format!("cam{number:02}");
        for (moment, &frame) in frames.iter().enumerate() {
            let path = request.out.join(&name).join("images").join(format!("{moment:04}.png"));
            pictures.push(PictureFile { camera, frame, path, depth: None });
        }
        manifest.cameras.push(Called::camera(camera, name));
    }
    views.write_png(&pictures, *tick)?;
    for number in 0..cameras.len() {
        let name = format!("cam{number:02}");
        // Readers count these files; what is in them is read only where pictures are missing.
        write_atomic(&request.out.join(format!("{name}.mp4")), b"")?;
        if is_padded {
            repeat_last(&request.out.join(name).join("images"), frames.len())?;
        }
    }

    let cloud = views.cloud(frames[0])?;
    let points = cloud.as_ref().map(|cloud| cloud.surfaces(request.points));
    if let Some(points) = &points {
        write_atomic(&request.out.join(POINTS), &points::encode_ply(points))?;
    }
    let points = points.unwrap_or_default();
    let rows: Vec<f64> = cameras.iter().flat_map(|camera| row(job, camera, &points)).collect();
    write_atomic(&request.out.join("poses_bounds.npy"), &npy::encode_f64(&[cameras.len(), 17], &rows))?;

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
    manifest.note(cloud::statement(POINTS, FIRST, cloud.as_ref()));
    if cloud.is_none() {
        let [near, far] = UNKNOWN_BOUNDS;
        manifest.note(format!("bounds are {near} and {far} units, since nothing is known of surfaces"));
    }
    for camera in views.held_out().into_iter().skip(1) {
        manifest.note(format!(
            "{} is left out: its reader holds out one camera, and trains on all others",
            camera.name
        ));
    }
    manifest.note_test_split(views);
    Ok(manifest)
}

/// One held-out camera, or a training camera in its place; then all training cameras.
fn cameras<'a>(job: &Job<'a>) -> Vec<&'a Camera> {
    let views = job.views;
    views.test_split().into_iter().take(1).chain(views.training()).collect()
}

pub(super) fn check(job: &Job<'_>) -> Result<(), DataError> {
    let (views, cameras) = (job.views, cameras(job));
    let [width, height] = views.size;
    let refuse = |field: &str, message: String| Err(limit(views, field, message));
    if width * 3 != height * 4 {
        return refuse(
            "width",
            format!("{width}x{height} is not 4:3, and readers would stretch the pictures"),
        );
    }
    if views.frames.len() > MOMENTS {
        return refuse("stride", format!("there are more than {MOMENTS} moments, and readers drop the rest"));
    }
    for camera in &cameras {
        let name = &camera.name;
        if !is_centred(views, camera) {
            return Err(off_centre(views, camera));
        }
        if camera.fx != camera.fy || camera.fx != cameras[0].fx {
            return refuse("fx", format!("{name} has another focal length, and readers know one"));
        }
        if let Some(frame) = views.frames.iter().find(|frame| !views.saw(camera, **frame)) {
            return refuse("unseen", format!("{name} did not see {frame}, and readers want all moments"));
        }
        if camera.world_from_camera.len() > 1 {
            return refuse("world_from_camera", format!("{name} moves, and readers know one pose a camera"));
        }
    }
    Ok(())
}

/// 3x5 numbers `[down | right | back | centre | height, width, focal length]` row by row, then near and far.
fn row(job: &Job<'_>, camera: &Camera, points: &[ColouredPoint]) -> [f64; 17] {
    let world_from_camera = camera.world_from_camera(0);
    let focal = camera.fx * STATED_WIDTH / f64::from(job.views.size[0]);
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
fn bounds(job: &Job<'_>, camera: &Camera, points: &[ColouredPoint]) -> [f64; 2] {
    let size = job.views.size.map(f64::from);
    let mut depths: Vec<f64> = points
        .iter()
        .map(|point| camera.project(0, point.position))
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
    [at(0.001).unwrap_or(UNKNOWN_BOUNDS[0]), at(0.999).unwrap_or(UNKNOWN_BOUNDS[1])]
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
