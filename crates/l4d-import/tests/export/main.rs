//! Exports read back as the tools read them that they are made for. The readers below restate what the originals
//! compute; they share no code with the writers.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

#[path = "../support/mod.rs"]
mod support;

mod annotations;
mod captures;
mod colmap;
mod evaluators;
mod folder;
mod four_d_gaussians;
mod leaks;
mod nerfstudio;
mod public_readers;

use std::path::Path;

use glam::{DVec2, DVec3};
use l4d_data::{Camera, Profile};
use l4d_frames::drawn::{RgbImage, decode_colour};
use l4d_import::annotations::QueriesWithTruth;
use l4d_import::export::{ExportRequest, Exported, Format, HeldOut, Origin, export};

use support::World;

/// Rays of an export are those of the scene, pixels.
pub(crate) const RAY_TOLERANCE_PX: f64 = 1e-4;

/// What a scene is exported from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// EXR files with depth and ids.
    Rendered,
    /// Pictures of the same, as somebody recorded them.
    Captured,
}

impl Kind {
    pub(crate) const ALL: [Self; 2] = [Self::Rendered, Self::Captured];
}

/// Exports the rendering into a folder of the world.
pub(crate) fn exported(world: &World, format: Format, held_out: HeldOut, out: &Path) -> Exported {
    try_export(world, format, held_out, out).unwrap()
}

pub(crate) fn try_export(
    world: &World,
    format: Format,
    held_out: HeldOut,
    out: &Path,
) -> Result<Exported, l4d_data::DataError> {
    export_frames(Kind::Rendered, world, format, held_out, out, &[])
}

/// Exports the rendering, or a capture of the same scene.
pub(crate) fn exported_as(
    kind: Kind,
    world: &World,
    format: Format,
    held_out: HeldOut,
    out: &Path,
) -> Exported {
    export_frames(kind, world, format, held_out, out, &[]).unwrap()
}

/// Exports some frames; all if none is named.
pub(crate) fn export_frames(
    kind: Kind,
    world: &World,
    format: Format,
    held_out: HeldOut,
    out: &Path,
    frames: &[u32],
) -> Result<Exported, l4d_data::DataError> {
    let (scene, capture) = (world.dir(), world.capture_dir());
    let (mut truth, queries) = (world.truth.clone(), world.queries());
    let origin = match kind {
        Kind::Rendered => Origin::Rendered(&scene),
        Kind::Captured => {
            truth.profile = Profile::Real;
            Origin::Captured(&capture)
        }
    };
    let judged = QueriesWithTruth::new(Path::new("truth.json"), &truth, &queries).unwrap();
    let judged = format.needs_truth().then_some(&judged);
    let request =
        ExportRequest { frames, held_out, points: 2000, judged, ..ExportRequest::new(origin, format, out) };
    export(request, &|| {})
}

/// Points before a camera at all corners of its picture, and where they are seen.
pub(crate) fn probes(camera: &Camera, frame: u32) -> Vec<(DVec3, DVec2)> {
    let corners = [[0.0, 0.0], [128.0, 0.0], [0.0, 96.0], [128.0, 96.0], [31.5, 70.5]];
    let probe = |[x, y]: [f64; 2], depth_m| {
        let at = DVec2::new(x, y);
        (camera.unproject(frame, at, depth_m), at)
    };
    corners.into_iter().flat_map(|corner| [probe(corner, 0.7), probe(corner, 6.0)]).collect()
}

/// The display colours that a camera of the scene shows.
pub(crate) fn shown(world: &World, view: &str, frame: u32) -> RgbImage {
    l4d_frames::Display::new(world.scene.exposure).picture(&world.frame(view, frame))
}

pub(crate) fn png(path: &Path, width: u32, height: u32) -> RgbImage {
    decode_colour(&std::fs::read(path).unwrap(), width, height).unwrap()
}

pub(crate) fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A 4x4 matrix of nested lists.
pub(crate) fn matrix(value: &serde_json::Value) -> glam::DMat4 {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
    let numbers: Vec<f64> = rows.into_iter().flatten().collect();
    glam::DMat4::from_cols_array(&numbers.try_into().unwrap()).transpose()
}
