//! Streams all pictures of a scene once: what each says by itself, and how the views of a moment compare.

use std::collections::BTreeSet;
use std::path::Path;

use glam::UVec2;
use l4d_data::digest::sha256_hex;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::tracks::Tracks;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Camera, Report, Split};
use rayon::prelude::*;

use super::boxes::{BoxReport, View, look};
use super::checksums::Checksums;
use crate::exr::{decode_surfaces, read_bytes};
use crate::frame::Surfaces;
use crate::geometry::{CrossView, Field, compare, view_pairs};
use crate::truth::{Observation, TruthBuilder};

/// Moments at which views are compared; digests and boxes guard the others.
const COMPARED_FRAMES: usize = 13;

/// What was seen.
pub(super) struct Seen {
    pub(super) pictures: usize,
    /// Whether every picture could be read.
    pub(super) complete: bool,
    pub(super) truth: Truth,
    pub(super) comparisons: Vec<Comparison>,
}

/// Two views, over all compared frames.
pub(super) struct Comparison {
    pub(super) a: usize,
    pub(super) b: usize,
    pub(super) total: CrossView,
    /// Frames at which most compared pixels disagree, with the median of residual over allowed.
    pub(super) bad_frames: Vec<(u32, f64)>,
}

/// One picture, looked at.
struct Picture {
    surfaces: Option<Surfaces>,
    observation: Option<Observation>,
    boxes: BoxReport,
    report: Report,
}

/// Where pictures come from and what they must agree with.
pub(super) struct Source<'a> {
    pub(super) scene: &'a Scene,
    pub(super) dir: &'a SceneDir,
    pub(super) tracks: Option<&'a Tracks>,
    pub(super) checksums: &'a Checksums,
}

pub(super) fn stream(
    source: &Source,
    mut builder: TruthBuilder,
    tick: &dyn Fn(),
    report: &mut Report,
) -> Seen {
    let scene = source.scene;
    let frames: Vec<u32> = scene.profile.frames().collect();
    let every = frames.len().div_ceil(COMPARED_FRAMES);
    let test_view = scene.cameras.iter().position(|camera| camera.split == Split::Test).unwrap_or_default();
    let pairs = view_pairs(scene.cameras.len(), test_view);
    let mut comparisons: Vec<Comparison> = pairs
        .iter()
        .map(|&(a, b)| Comparison { a, b, total: CrossView::default(), bad_frames: Vec::new() })
        .collect();
    let mut boxes = BoxReport::default();
    let mut readable = 0;
    for (position, &frame) in frames.iter().enumerate() {
        let look = |camera: &Camera| look_at(source, camera, frame, builder.wants_masks(&camera.name));
        let pictures: Vec<Picture> = scene.cameras.par_iter().map(look).collect();
        if position % every == 0 {
            compare_all(scene, frame, &pictures, &mut comparisons);
        }
        for (camera, picture) in scene.cameras.iter().zip(pictures) {
            readable += usize::from(picture.surfaces.is_some());
            report.extend(picture.report);
            boxes.merge(picture.boxes);
            if let Some(observation) = picture.observation {
                builder.insert(&camera.name, frame, observation);
            }
        }
        tick();
    }
    boxes.report(scene, source.dir, report);
    let complete = readable == frames.len() * scene.cameras.len();
    Seen { pictures: readable, complete, truth: builder.finish(), comparisons }
}

fn look_at(source: &Source, camera: &Camera, frame: u32, with_masks: bool) -> Picture {
    let Source { scene, dir, tracks, checksums } = *source;
    let mut report = Report::default();
    let path = dir.frame(&camera.name, frame);
    let nothing = |report| Picture { surfaces: None, observation: None, boxes: BoxReport::default(), report };
    if !path.exists() {
        // The listing has already said so.
        return nothing(report);
    }
    let size = UVec2::new(scene.width, scene.height);
    let decoded = read_bytes(&path, size).and_then(|bytes| {
        checksums.check_picture(dir.root(), &path, &sha256_hex(&bytes), &mut report);
        decode_surfaces(&path, &bytes, size)
    });
    let surfaces = match decoded {
        Ok(surfaces) => surfaces,
        Err(error) => {
            report.data_error(error.code(), error.data_error());
            return nothing(report);
        }
    };
    check_digests(scene, camera, frame, &surfaces, &path, &mut report);
    let observation = Observation::of(&surfaces, with_masks);
    check_ids(scene, &observation, &path, &mut report);
    let boxes =
        tracks.map(|tracks| look(tracks, View { camera, surfaces: &surfaces }, frame)).unwrap_or_default();
    Picture { surfaces: Some(surfaces), observation: Some(observation), boxes, report }
}

fn check_digests(
    scene: &Scene,
    camera: &Camera,
    frame: u32,
    surfaces: &Surfaces,
    path: &Path,
    report: &mut Report,
) {
    let Some(stated) = scene.digests.get(&camera.name).and_then(|digests| digests.get(&frame_key(frame)))
    else {
        return;
    };
    let found = surfaces.digest();
    for (channel, found, stated) in [("Z", &found.z, &stated.z), ("id", &found.id, &stated.id)] {
        if found != stated {
            let message = "does not have the digest that scene.json states";
            let hint = "fetch the file again, or delete it and run `l4d build-scenes`";
            report.error("L4D109", path, format!("channel `{channel}`"), message, hint);
        }
    }
}

fn check_ids(scene: &Scene, observation: &Observation, path: &Path, report: &mut Report) {
    let known: BTreeSet<u32> = scene.instances.iter().map(|instance| instance.id).collect();
    for (id, count) in observation.visible.iter().filter(|(id, _)| !known.contains(id)) {
        let message = format!("{count} pixels show id {id}, which scene.json does not list");
        report.error(
            "L4D108",
            path,
            "channel `id`",
            message,
            "register the instance in the recipe and build again",
        );
    }
}

fn compare_all(scene: &Scene, frame: u32, pictures: &[Picture], comparisons: &mut [Comparison]) {
    let fields: Vec<Option<Field>> = scene
        .cameras
        .par_iter()
        .zip(pictures)
        .map(|(camera, picture)| Some(Field::new(camera, picture.surfaces.as_ref()?)))
        .collect();
    comparisons.par_iter_mut().for_each(|comparison| {
        let (Some(a), Some(b)) = (&fields[comparison.a], &fields[comparison.b]) else { return };
        let found = compare(frame, a, b);
        if let Some(median) = found.disagreement() {
            comparison.bad_frames.push((frame, median));
        }
        comparison.total.merge(found);
    });
}
