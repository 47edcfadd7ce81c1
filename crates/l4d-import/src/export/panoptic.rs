//! 4DGaussians, reader `PanopticSports`: the one that keeps size, principal point, moments and split.
//!
//! `train_meta.json` and `test_meta.json` hold lists over moments of lists over cameras; pictures are in `ims/`; the
//! first points in `init_pt_cld.npz`.

use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, json};
use l4d_formats::{arrays, npy};
use serde_json::json;

use super::Job;
use super::cloud::{self, FIRST};
use super::manifest::{Called, Manifest};
use super::views::PictureFile;
use crate::points::ColouredPoint;
use crate::pose;

/// The first points.
const POINTS: &str = "init_pt_cld.npz";

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, tick } = job;
    let training = views.training();
    let test = views.test_split();
    let numbered = views.shown();

    let picture = |number: usize, moment: usize| format!("{number}/{moment:06}.png");
    let mut pictures = Vec::new();
    for (number, camera) in numbered.iter().enumerate() {
        manifest.cameras.push(Called::camera(camera, format!("ims/{number}")));
        let moments = views.frames.iter().enumerate();
        for (moment, &frame) in moments.filter(|(_, frame)| views.saw(camera, **frame)) {
            let path = request.out.join("ims").join(picture(number, moment));
            pictures.push(PictureFile { camera, frame, path, depth: None });
        }
    }
    views.write_png(&pictures, *tick)?;

    let meta = |cameras: &[&Camera]| {
        let number_of =
            |camera: &Camera| numbered.iter().position(|other| other.name == camera.name).unwrap_or(0);
        let [w, h] = views.size;
        // Lists over moments of lists over cameras: 3x3 intrinsics, 4x4 `camera_from_world`, picture below `ims/`,
        // number of the camera.
        let (mut k, mut w2c, mut files, mut ids) = (vec![], vec![], vec![], vec![]);
        for (moment, &frame) in views.frames.iter().enumerate() {
            let present = views.present(cameras, frame);
            let numbers: Vec<usize> = present.iter().map(|camera| number_of(camera)).collect();
            let pose = |camera: &&Camera| pose::nested_rows(camera.camera_from_world(frame));
            k.push(present.iter().map(|camera| intrinsics(camera)).collect::<Vec<_>>());
            w2c.push(present.iter().map(pose).collect::<Vec<_>>());
            files.push(numbers.iter().map(|&number| picture(number, moment)).collect::<Vec<_>>());
            ids.push(numbers);
        }
        json!({ "w": w, "h": h, "k": k, "w2c": w2c, "fn": files, "cam_id": ids })
    };
    json::write_compact(&request.out.join("train_meta.json"), &meta(&training))?;
    json::write_compact(&request.out.join("test_meta.json"), &meta(&test))?;
    let cloud = views.cloud(views.frames[0])?;
    if let Some(cloud) = &cloud {
        write_points(&request.out.join(POINTS), &cloud.surfaces(request.points))?;
    }

    manifest.note("time of the i-th moment is i / number of moments, as its reader computes it");
    manifest.note("its reader draws without harmonics: colours do not depend on direction");
    manifest.note(cloud::statement(POINTS, FIRST, cloud.as_ref()));
    manifest.note_test_split(views);
    Ok(manifest)
}

fn intrinsics(camera: &Camera) -> [[f64; 3]; 3] {
    [[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]]
}

/// `data`: a row a point, x y z in metres and red green blue from 0 to 1.
fn write_points(path: &Path, points: &[ColouredPoint]) -> Result<(), DataError> {
    let mut values = Vec::with_capacity(points.len() * 6);
    for point in points {
        values.extend(point.position.to_array());
        values.extend(point.rgb.map(|value| f64::from(value) / 255.0));
    }
    let array = npy::encode_f64(&[points.len(), 6], &values);
    write_atomic(path, &arrays::encode_npz(path, &[("data", array)])?)
}
