//! A COLMAP model for each moment: for LangSplat and all others that know no time.
//!
//! Moments are apart in folders of their own: whoever reads `sparse/` in a moving scene takes its pictures for one
//! moment. Poses are those of the render, points come from its depth, and tracks say who sees them.

use std::path::{Path, PathBuf};

use l4d_data::{DataError, json};
use serde_json::json;

use super::cloud::{Moment, SeenPoint};
use super::footage::write_png;
use super::manifest::{Called, Manifest};
use super::{Format, Job};
use crate::colmap::{Encoding, Lens, Model, ModelCamera, ModelImage, ModelPoint, Observation};
use crate::pose;

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, tick } = job;
    let encoding = match order.format {
        Format::ColmapText => Encoding::Text,
        _ => Encoding::Binary,
    };
    for camera in footage.training() {
        manifest.cameras.push(Called::camera(camera, picture_name(&camera.name)));
    }
    for &frame in footage.frames() {
        let folder = moment_folder(order.out, frame);
        let moment = Moment::read(footage, frame)?;
        for view in &moment.views {
            let picture = footage.shown(&view.frame);
            write_png(&folder.join("images").join(picture_name(&view.camera.name)), &picture)?;
            tick();
        }
        model_of(&moment, frame, order.points).write(&folder.join("sparse").join("0"), encoding)?;
        if let Some(camera) = footage.held_out().filter(|_| footage.shows_held_out_pictures()) {
            let path = folder.join("held_out").join(picture_name(&camera.name));
            write_png(&path, &footage.picture(camera, frame)?)?;
            tick();
        }
    }
    if let Some(camera) = footage.held_out() {
        let scene = footage.scene();
        let rig = json!({ "width": scene.width, "height": scene.height, "cameras": [camera] });
        json::write(&order.out.join("held_out_camera.json"), &rig)?;
        manifest.note(format!("{} is in no model; its pose stands in held_out_camera.json", camera.name));
    }
    manifest.note("a folder a moment: train each by itself");
    manifest.note("points and their tracks come from rendered depth");
    if order.format == Format::LangSplat {
        manifest.note(
            "its reader drops principal points; they are the centre of the picture here, so nothing is lost",
        );
        manifest.note("its reader sorts pictures by name, and with `--eval` keeps every eighth for testing");
    }
    Ok(manifest)
}

/// The folder of a moment.
pub(super) fn moment_folder(out: &Path, frame: u32) -> PathBuf {
    out.join(format!("frame_{frame:04}"))
}

fn picture_name(view: &str) -> String {
    format!("{view}.png")
}

/// The model of a moment. Numbers begin with 1, as COLMAP's do.
fn model_of(moment: &Moment<'_>, frame: u32, budget: usize) -> Model {
    let mut model = Model::default();
    for (id, view) in (1..).zip(&moment.views) {
        let camera = view.camera;
        let (rotation, translation) = pose::quaternion_and_translation(camera.camera_from_world(frame));
        model.cameras.push(ModelCamera {
            id,
            lens: Lens::Pinhole,
            width: view.frame.surfaces.width.into(),
            height: view.frame.surfaces.height.into(),
            parameters: vec![camera.fx, camera.fy, camera.cx, camera.cy],
        });
        model.images.push(ModelImage {
            id,
            rotation,
            translation,
            camera: id,
            name: picture_name(&camera.name),
            observations: Vec::new(),
        });
    }
    for (id, point) in (1..).zip(moment.points(budget)) {
        let track = observe(moment, &mut model.images, id, &point);
        let SeenPoint { surface, .. } = point;
        // Positions are where the point projects, so that there is no error to speak of.
        model.points.push(ModelPoint {
            id,
            position: surface.position,
            rgb: surface.rgb,
            error_px: 0.0,
            track,
        });
    }
    model
}

/// Notes a point in every picture that shows it; gives its track.
fn observe(moment: &Moment<'_>, images: &mut [ModelImage], id: u64, point: &SeenPoint) -> Vec<(u32, u32)> {
    let mut track = Vec::new();
    for (index, (view, image)) in moment.views.iter().zip(images).enumerate() {
        // Rounding must not lose the picture that the point comes from.
        let own = || view.camera.project(view.number(), point.surface.position).0;
        let seen = view.sees(point.surface.position).or_else(|| (index == point.view).then(own));
        if let Some(position) = seen {
            track.push((image.id, image.observations.len() as u32));
            image.observations.push(Observation { position: position.to_array(), point: Some(id) });
        }
    }
    track
}
