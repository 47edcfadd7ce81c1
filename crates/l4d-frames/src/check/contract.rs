//! What can be checked without opening a picture: scene.json, the files that are there, the tracks.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::camera::ViewCard;
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::store::list_folder;
use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::truth::frame_key;
use l4d_data::{Camera, Report};

use super::Request;

/// Poses and intrinsics are written with micrometres and six digits.
const POSE_TOLERANCE: f64 = 2e-6;
const REBUILD: &str = "run `l4d build-scenes` again";

pub(super) fn check_header(scene: &Scene, request: Request, dir: &SceneDir, report: &mut Report) {
    let path = dir.scene();
    let mut expect = |field: &str, matches: bool, found: String, expected: String| {
        if !matches {
            let hint = "choose the --profile and --data that belong together, or build the scene again";
            report.error(
                "L4D102",
                &path,
                format!("field `{field}`"),
                format!("is {found}, but {expected} is expected"),
                hint,
            );
        }
    };
    let named = scene.name == *request.scene;
    expect("name", named, format!("`{}`", scene.name), format!("`{}`", request.scene));
    let profile = request.profile;
    expect("profile", scene.profile == profile, scene.profile.to_string(), profile.to_string());
    let stride = scene.profile.stride();
    expect("stride", scene.stride == stride, scene.stride.to_string(), stride.to_string());
    let bright = scene.exposure.is_finite() && scene.exposure > 0.0;
    expect("exposure", bright, scene.exposure.to_string(), "a positive number".to_owned());
    let frame_keys: BTreeSet<String> = scene.profile.frames().map(frame_key).collect();
    for camera in &scene.cameras {
        let known: BTreeSet<String> = scene
            .digests
            .get(&camera.name)
            .map(|digests| digests.keys().cloned().collect())
            .unwrap_or_default();
        if known != frame_keys {
            let message =
                format!("has digests of {} frames, but the profile has {}", known.len(), frame_keys.len());
            report.error("L4D102", &path, format!("field `digests.{}`", camera.name), message, REBUILD);
        }
    }
    for view in scene.digests.keys().filter(|view| scene.camera(view).is_none()) {
        report.error("L4D102", &path, format!("field `digests.{view}`"), "belongs to no view", REBUILD);
    }
}

/// Missing and superfluous views and frames. Files that start with a dot are half-written ones of a worker.
pub(super) fn check_files(scene: &Scene, dir: &SceneDir, report: &mut Report) {
    let views: BTreeSet<String> = scene.cameras.iter().map(|camera| camera.name.to_string()).collect();
    compare_listing(&dir.root().join("frames"), &views, &BTreeSet::new(), report);
    let frames: BTreeSet<String> =
        scene.profile.frames().map(|frame| format!("{}.exr", frame_key(frame))).collect();
    let cards = BTreeSet::from(["view.json".to_owned()]);
    for view in &views {
        compare_listing(&dir.view(view), &frames, &cards, report);
    }
    for camera in &scene.cameras {
        check_card(camera, [scene.width, scene.height], dir, report);
    }
}

/// The frames were rendered with the camera of `view.json`, where that is still beside them.
fn check_card(camera: &Camera, size: [u32; 2], dir: &SceneDir, report: &mut Report) {
    let path = dir.view_card(&camera.name);
    if !path.exists() {
        return;
    }
    match dir.read_view_card(&camera.name) {
        Ok(rendered) if rendered == ViewCard::new(camera.clone(), size) => {}
        Ok(_) => {
            let message = "what the frames were rendered with differs from scene.json";
            report.error("L4D102", &path, "camera", message, REBUILD);
        }
        Err(error) => report.data_error("L4D102", &error),
    }
}

fn compare_listing(
    folder: &Path,
    required: &BTreeSet<String>,
    allowed: &BTreeSet<String>,
    report: &mut Report,
) {
    let found: BTreeSet<String> = match list_folder(folder) {
        Ok(names) => names.into_iter().collect(),
        Err(error) => return report.data_error("L4D103", &error),
    };
    for missing in required.difference(&found) {
        report.error("L4D103", folder, missing.as_str(), "is missing", REBUILD);
    }
    for extra in found.iter().filter(|name| !required.contains(*name) && !allowed.contains(*name)) {
        let hint = "move it elsewhere: this folder holds what scene.json lists and nothing else";
        report.error("L4D103", folder, extra.as_str(), "does not belong to the scene", hint);
    }
}

pub(super) fn check_against_tracks(scene: &Scene, tracks: &Tracks, dir: &SceneDir, report: &mut Report) {
    let path = dir.scene();
    let mut differs = |place: String, message: &str| {
        let hint = "build tracks and pictures from the same recipe: `l4d build-scenes --force`, \
                    with --update-benchmark if the recipe is meant to have changed";
        report.error("L4D112", &path, place, format!("{message} differs from the tracks"), hint);
    };
    let same_recipe = (&scene.name, scene.scale, scene.variant, scene.seed)
        == (&tracks.scene, tracks.scale, tracks.variant, tracks.seed);
    if !same_recipe {
        differs("fields `name`, `scale`, `variant`, `seed`".into(), "the recipe");
    }
    if (scene.exposure - tracks.exposure).abs() > POSE_TOLERANCE {
        differs("field `exposure`".into(), "the exposure");
    }
    let described: Vec<_> = tracks.instances.iter().map(TrackedInstance::instance).collect();
    if scene.instances != described {
        differs("field `instances`".into(), "the list of instances");
    }
    if scene.events != tracks.events {
        differs("field `events`".into(), "the list of events");
    }
    let views: BTreeSet<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    let tracked: BTreeSet<&str> = tracks.views(scene.profile).map(|camera| camera.name.as_str()).collect();
    if views != tracked {
        differs("field `cameras`".into(), "the list of views");
    }
    for camera in &scene.cameras {
        let Some(tracked) = tracks.cameras.iter().find(|tracked| tracked.name == camera.name) else {
            continue;
        };
        if camera.split != tracked.split {
            differs(format!("camera {}", camera.name), "the split");
        }
        let tracked = tracked.camera([scene.width, scene.height]);
        let lens = |camera: &Camera| [camera.fx, camera.fy, camera.cx, camera.cy];
        if !near(&lens(camera), &lens(&tracked), f64::from(scene.width)) {
            differs(format!("camera {}", camera.name), "the lens");
        }
        let poses = |camera: &Camera| camera.world_from_camera.concat();
        if !near(&poses(camera), &poses(&tracked), 1.0) {
            differs(format!("camera {}", camera.name), "the pose");
        }
    }
}

/// Whether numbers are those that were written, in units of `unit`.
fn near(found: &[f64], expected: &[f64], unit: f64) -> bool {
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= POSE_TOLERANCE * unit;
    found.len() == expected.len() && found.iter().zip(expected).all(is_near)
}
