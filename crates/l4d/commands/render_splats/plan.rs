//! What is to be drawn: which model, from where, when, how large, and where it goes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_data::layout::{SceneDir, WorkDir};
use l4d_data::scene::Scene;
use l4d_data::timeline::LAST_FRAME;
use l4d_data::truth::frame_key;
use l4d_data::{Camera, DataError, Draw, Name, Split, json};
use l4d_splat::model::time_of_frame;
use l4d_splat::view::View;
use serde::Deserialize;

use crate::cli::RenderSplatsArgs;
use crate::commands::build_scenes::data_folder;
use crate::out::refusal;

/// Index of a camera and of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Shot {
    pub(super) view: usize,
    pub(super) instant: usize,
}

/// A time that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Instant {
    /// File stem.
    pub(super) key: String,
    /// Canonical frame; none for times between frames.
    pub(super) frame: Option<u32>,
    /// From 0 to 1.
    pub(super) time: f32,
}

#[derive(Debug)]
pub(super) struct Plan {
    pub(super) model: PathBuf,
    pub(super) out: PathBuf,
    pub(super) cameras: Vec<Camera>,
    /// Pixels that the numbers of the cameras belong to.
    camera_size: [u32; 2],
    pub(super) size: [u32; 2],
    pub(super) instants: Vec<Instant>,
}

/// The part of `scene.json` that says from where; other fields may stand beside it.
#[derive(Debug, Deserialize)]
struct CameraFile {
    width: u32,
    height: u32,
    cameras: Vec<Camera>,
}

impl Plan {
    pub(super) fn of(args: &RenderSplatsArgs) -> Result<Self> {
        let scene = args.scene.as_deref().map(Name::new).transpose()?;
        let work = scene.as_ref().map(|scene| WorkDir::new(&args.work, args.profile, scene));
        let place = |given: &Option<PathBuf>, default: fn(&WorkDir) -> PathBuf| {
            given
                .clone()
                .or_else(|| work.as_ref().map(default))
                .ok_or_else(|| refusal("there is no scene", "name a scene, or --model, --cameras and --out"))
        };
        let file = match &args.cameras {
            Some(path) => read_cameras(path)?,
            None => scene_cameras(args, scene.as_ref())?,
        };
        let plan = Self {
            model: place(&args.model, WorkDir::splats)?,
            out: place(&args.out, WorkDir::clips)?,
            camera_size: [file.width, file.height],
            size: args.size.map_or([file.width, file.height], |size| size.0),
            cameras: chosen(file.cameras, args)?,
            instants: instants(args)?,
        };
        // Whatever cannot be drawn is refused before the first file is written.
        for shot in plan.shots() {
            plan.view(shot)?;
        }
        Ok(plan)
    }

    /// All pictures, view by view.
    pub(super) fn shots(&self) -> impl Iterator<Item = Shot> + use<> {
        let (views, instants) = (self.cameras.len(), self.instants.len());
        (0..views).flat_map(move |view| (0..instants).map(move |instant| Shot { view, instant }))
    }

    pub(super) fn shot_count(&self) -> usize {
        self.cameras.len() * self.instants.len()
    }

    /// From where a picture is drawn.
    pub(super) fn view(&self, shot: Shot) -> Result<View> {
        let (camera, instant) = (&self.cameras[shot.view], &self.instants[shot.instant]);
        let frame = match instant.frame {
            Some(frame) => frame,
            None if camera.world_from_camera.len() == 1 => 0,
            None => {
                return Err(refusal(
                    format!("camera {} moves, and is known at canonical frames alone", camera.name),
                    "choose --frames instead of --times",
                ));
            }
        };
        Ok(View::of_camera(camera, frame, self.camera_size, self.size)?)
    }

    /// A camera with the numbers that belong to the pictures that are drawn.
    pub(super) fn drawn_camera(&self, view: usize) -> Camera {
        self.cameras[view].resized(self.camera_size, self.size)
    }
}

fn scene_cameras(args: &RenderSplatsArgs, scene: Option<&Name>) -> Result<CameraFile> {
    let Some(name) = scene else {
        return Err(refusal("there are no cameras", "name a scene, or a file with --cameras"));
    };
    let data = data_folder(args.data.as_deref(), args.profile, Draw::default());
    let scene = Scene::read(&SceneDir::new(&data, name).scene())?;
    Ok(CameraFile { width: scene.width, height: scene.height, cameras: scene.cameras })
}

fn read_cameras(path: &Path) -> Result<CameraFile> {
    let file: CameraFile = json::read(path)?;
    let wrong = |place: String, message: String| {
        DataError::invalid(path, place, message, "mend the camera, or take it out of the file")
    };
    if file.cameras.is_empty() {
        return Err(wrong("field `cameras`".to_owned(), "is empty".to_owned()).into());
    }
    let mut names = BTreeSet::new();
    for camera in &file.cameras {
        let problem = camera
            .problem()
            .or_else(|| (!names.insert(&camera.name)).then(|| "the name stands there twice".to_owned()));
        if let Some(problem) = problem {
            return Err(wrong(format!("camera {}", camera.name), problem).into());
        }
    }
    Ok(file)
}

/// The views that were asked for, else all training ones; all of a file that has none.
fn chosen(cameras: Vec<Camera>, args: &RenderSplatsArgs) -> Result<Vec<Camera>> {
    let known: Vec<String> = cameras.iter().map(|camera| camera.name.to_string()).collect();
    if let Some(view) = args.views.iter().find(|view| !known.contains(view)) {
        return Err(refusal(
            format!("there is no view `{}`", view.escape_debug()),
            format!("choose among {}", known.join(", ")),
        ));
    }
    let any_training = cameras.iter().any(|camera| camera.split == Split::Train);
    let is_meant = |camera: &Camera| {
        if args.views.is_empty() {
            camera.split == Split::Train || !any_training
        } else {
            args.views.iter().any(|view| view.as_str() == camera.name.as_str())
        }
    };
    Ok(cameras.into_iter().filter(is_meant).collect())
}

fn instants(args: &RenderSplatsArgs) -> Result<Vec<Instant>> {
    if let Some(frame) = args.frames.iter().find(|frame| **frame > LAST_FRAME) {
        return Err(refusal(
            format!("frame {frame} is beyond the clip"),
            format!("frames are 0 to {LAST_FRAME}"),
        ));
    }
    if let Some(time) = args.times.iter().find(|time| !(0.0..=1.0).contains(*time)) {
        return Err(refusal(format!("time {time} is outside the clip"), "times are 0 to 1"));
    }
    let at_frame =
        |frame: u32| Instant { key: frame_key(frame), frame: Some(frame), time: time_of_frame(frame) };
    let at_time = |time: &f32| Instant { key: format!("t{time:.6}"), frame: None, time: *time };
    let mut instants: Vec<Instant> = if !args.times.is_empty() {
        args.times.iter().map(at_time).collect()
    } else if !args.frames.is_empty() {
        args.frames.iter().copied().map(at_frame).collect()
    } else {
        args.profile.frames().map(at_frame).collect()
    };
    instants.sort_by(|a, b| a.time.total_cmp(&b.time));
    instants.dedup_by(|a, b| a.key == b.key);
    Ok(instants)
}
