//! `l4d check-scenes`: whether the files of a rendered scene have the format that `docs/formats.md` promises, and
//! whether its views agree with each other, with its tracks and with the committed truth.
//!
//! Collects findings instead of stopping. Pictures are streamed: all views of one frame are in memory at once,
//! never two frames. Nothing is written or repaired.

mod boxes;
mod checksums;
mod contract;
mod cross_view;
mod gates;
mod pictures;
mod truth;

use std::path::Path;

use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::scene::Scene;
use l4d_data::tracks::Tracks;
use l4d_data::{Name, Profile, Report};
use serde::Serialize;

use crate::geometry::Summary;
use crate::truth::TruthBuilder;

pub use gates::visibility_problem;

/// The scene to check.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// Folder that holds the folder of the scene.
    pub data: &'a Path,
    /// Benchmark folder with tracks, queries and truth.
    pub bench: &'a BenchDir,
    pub profile: Profile,
    pub scene: &'a Name,
}

/// Counts of what was checked, and how well the views agree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneStats {
    pub scene: Name,
    /// Whether there are no errors; there may be warnings.
    pub good: bool,
    pub views: usize,
    /// Frames per view.
    pub frames: usize,
    /// Pictures that could be read.
    pub pictures: usize,
    pub instances: usize,
    /// Agreement across views; null if fewer than two views could be read.
    pub cross_view: Option<Summary>,
}

/// Checks one scene; `tick` is called once per frame.
pub fn check_scene(request: Request, tick: &dyn Fn()) -> (Option<SceneStats>, Report) {
    let mut report = Report::default();
    let dir = SceneDir::new(request.data, request.scene);
    let scene = match Scene::read(&dir.scene()) {
        Ok(scene) => scene,
        Err(error) => {
            match interrupted(request, &dir) {
                Some((message, hint)) => report.error("L4D101", dir.root(), "scene.json", message, hint),
                None => report.data_error("L4D101", &error),
            }
            return (None, report);
        }
    };
    contract::check_header(&scene, request, &dir, &mut report);
    let truth = match TruthBuilder::new(&scene) {
        Some(truth) if scene.profile == request.profile && scene.name == *request.scene => truth,
        _ => return (None, report),
    };
    contract::check_files(&scene, &dir, &mut report);
    let tracks = read_tracks(request, &mut report);
    if let Some(tracks) = &tracks {
        contract::check_against_tracks(&scene, tracks, &dir, &mut report);
    }
    let checksums = checksums::Checksums::read(&dir, &mut report);
    let source =
        pictures::Source { scene: &scene, dir: &dir, tracks: tracks.as_ref(), checksums: &checksums };
    let seen = pictures::stream(&source, truth, tick, &mut report);
    let cross_view = cross_view::judge(&seen.comparisons, &scene, &dir, &mut report);
    if seen.complete {
        truth::compare_with_committed(&seen.truth, request, &mut report);
    }
    if seen.complete && scene.profile != Profile::Tiny {
        gates::check(&seen.truth, &scene, request, &mut report);
    }
    let stats = SceneStats {
        scene: scene.name.clone(),
        good: !report.has_errors(),
        views: scene.cameras.len(),
        frames: scene.profile.frames().count(),
        pictures: seen.pictures,
        instances: scene.instances.len(),
        cross_view,
    };
    (Some(stats), report)
}

/// Message and hint for a scene whose rendering was interrupted; none for any other.
fn interrupted(request: Request, dir: &SceneDir) -> Option<(String, String)> {
    if dir.scene().exists() || !dir.root().join("frames").exists() {
        return None;
    }
    let committed = || Tracks::read(&request.bench.tracks(request.scene));
    let tracks = Tracks::read(&dir.tracks()).or_else(|_| committed()).ok()?;
    let (mut all, mut present) = (0, 0);
    for camera in tracks.views(request.profile) {
        for frame in request.profile.frames() {
            all += 1;
            present += usize::from(dir.frame(&camera.name, frame).is_file());
        }
    }
    let command = format!("`l4d build-scenes --profile {} --scenes {}`", request.profile, request.scene);
    let message = match all - present {
        0 => format!("is missing: the render was interrupted when all {all} pictures were there"),
        lacking => format!("is missing: the render was interrupted, and {lacking} of {all} pictures lack"),
    };
    Some((message, format!("run {command}, which goes on with what lacks")))
}

fn read_tracks(request: Request, report: &mut Report) -> Option<Tracks> {
    Tracks::read(&request.bench.tracks(request.scene))
        .map_err(|error| report.data_error("L4D112", &error))
        .ok()
}

#[cfg(test)]
mod tests;
