//! 4DGaussians, reader `PanopticSports`: the one that keeps size, principal point, moments and split.
//!
//! `train_meta.json` and `test_meta.json` hold lists over moments of lists over cameras; pictures stand in `ims/`; the
//! first points in `init_pt_cld.npz`.

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, json};
use serde::Serialize;

use super::Job;
use super::cloud::Moment;
use super::footage::Shot;
use super::manifest::{Called, Manifest};
use crate::{npy, pose};

/// `train_meta.json`, `test_meta.json`.
#[derive(Debug, Serialize)]
struct Meta {
    w: u32,
    h: u32,
    /// Moment, camera: 3x3 intrinsics.
    k: Vec<Vec<[[f64; 3]; 3]>>,
    /// Moment, camera: 4x4 `camera_from_world`.
    w2c: Vec<Vec<[[f64; 4]; 4]>>,
    /// Moment, camera: picture below `ims/`.
    r#fn: Vec<Vec<String>>,
    /// Moment, camera: number of the camera.
    cam_id: Vec<Vec<usize>>,
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, tick } = job;
    let training = footage.training();
    let test = footage.test_split();
    let mut numbered: Vec<&Camera> = training.clone();
    numbered.extend(footage.held_out());

    let picture = |number: usize, moment: usize| format!("{number}/{moment:06}.png");
    let mut shots = Vec::new();
    for (number, camera) in numbered.iter().enumerate() {
        manifest.cameras.push(Called::camera(camera, format!("ims/{number}")));
        for (moment, &frame) in footage.frames().iter().enumerate() {
            shots.push(Shot { camera, frame, path: order.out.join("ims").join(picture(number, moment)) });
        }
    }
    footage.write_png(&shots, *tick)?;

    let meta = |cameras: &[&Camera]| {
        let number_of =
            |camera: &Camera| numbered.iter().position(|other| other.name == camera.name).unwrap_or(0);
        let over = |frame: u32| cameras.iter().map(move |camera| (*camera, frame));
        let moments = || footage.frames().iter().enumerate();
        Meta {
            w: footage.scene().width,
            h: footage.scene().height,
            k: moments()
                .map(|(_, &frame)| over(frame).map(|(camera, _)| intrinsics(camera)).collect())
                .collect(),
            w2c: moments()
                .map(|(_, &frame)| {
                    over(frame)
                        .map(|(camera, frame)| pose::nested_rows(camera.camera_from_world(frame)))
                        .collect()
                })
                .collect(),
            r#fn: moments()
                .map(|(moment, &frame)| {
                    over(frame).map(|(camera, _)| picture(number_of(camera), moment)).collect()
                })
                .collect(),
            cam_id: moments()
                .map(|(_, &frame)| over(frame).map(|(camera, _)| number_of(camera)).collect())
                .collect(),
        }
    };
    json::write_compact(&order.out.join("train_meta.json"), &meta(&training))?;
    json::write_compact(&order.out.join("test_meta.json"), &meta(&test))?;
    write_cloud(job)?;

    manifest.note("time of the i-th moment is i / number of moments, as its reader computes it");
    manifest.note("its reader draws without harmonics: colours do not depend on direction");
    manifest.note("init_pt_cld.npz comes from rendered depth at the first moment");
    manifest.note_test_split(footage);
    Ok(manifest)
}

fn intrinsics(camera: &Camera) -> [[f64; 3]; 3] {
    [[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]]
}

/// `data`: a row a point, x y z in metres and red green blue from 0 to 1.
fn write_cloud(job: &Job<'_>) -> Result<(), DataError> {
    let moment = Moment::read(job.footage, job.footage.frames()[0])?;
    let points = moment.points(job.order.points);
    let mut values = Vec::with_capacity(points.len() * 6);
    for point in &points {
        values.extend(point.surface.position.to_array());
        values.extend(point.surface.rgb.map(|value| f64::from(value) / 255.0));
    }
    let path = job.order.out.join("init_pt_cld.npz");
    let array = npy::encode_f64(&[points.len(), 6], &values);
    write_atomic(&path, &npy::encode_archive(&path, &[("data", array)])?)
}
