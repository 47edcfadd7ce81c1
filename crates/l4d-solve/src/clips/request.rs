//! What `render-splats` draws: which model, from which cameras, when, how large, and into which folder. Draws nothing
//! itself.

use std::path::{Path, PathBuf};

use l4d_data::layout::WorkDir;
use l4d_data::{Camera, DataError, Name, Rig, Split, StageError, Timeline, Workspace};
use l4d_splat::checkpoint::foreign::Moments;
use l4d_splat::checkpoint::own::Sampling;
use l4d_splat::source::{ReaderOptions, Source};

use super::{DrawnTime, Flight, Plan, instants_at};

/// What a user asks for; whatever is left out gets its default.
#[derive(Debug)]
pub struct Wanted<'a> {
    /// Scene whose model, cameras and folders are the defaults.
    pub scene: Option<&'a Name>,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// Path of the model, if not that of the scene.
    pub model: Option<&'a Path>,
    /// How a model of another program is read.
    pub reader_options: ReaderOptions,
    /// A file of cameras, in place of those of the scene.
    pub cameras: Option<&'a Path>,
    /// Names of the cameras; empty for all training ones.
    pub views: &'a [String],
    /// A moving camera along them, in place of them.
    pub flight: Option<Flight>,
    /// Canonical frames; empty for those of the clip.
    pub frames: &'a [u32],
    /// Times, 0 to 1 over the clip, in place of frames.
    pub times: &'a [f32],
    /// Width and height of the pictures, pixels.
    pub size: Option<[u32; 2]>,
    /// Folder of the clips, if not that of the scene.
    pub out: Option<&'a Path>,
}

/// A model that was opened, what is drawn of it, and into which folder.
#[derive(Debug)]
pub struct ClipsRequest {
    /// Path of the model.
    pub model: PathBuf,
    /// What was read from that path.
    pub source: Source,
    /// Folder of the clips.
    pub out: PathBuf,
    /// Cameras, sizes and instants.
    pub plan: Plan,
    /// At which time of the clip each frame is.
    pub timeline: Timeline,
}

impl ClipsRequest {
    /// Resolves the defaults and opens the model. What cannot be drawn is refused here, before any file is written.
    ///
    /// # Errors
    /// Neither scene nor paths, unknown views, frames or times outside the clip.
    pub fn of(wanted: &Wanted<'_>) -> Result<Self, StageError> {
        let &Wanted { scene, space, .. } = wanted;
        let work = scene.map(|scene| space.work(scene));
        let place = |given: Option<&Path>, default: fn(&WorkDir) -> PathBuf| {
            given.map(Path::to_owned).or_else(|| work.as_ref().map(default)).ok_or_else(|| {
                StageError::new("there is no scene", "name a scene, or --splats, --cameras and --out")
            })
        };
        let model = place(wanted.model, WorkDir::splats)?;
        let own = || -> Result<Option<Rig>, DataError> { scene.map(|scene| space.rig(scene)).transpose() };
        let rig = match wanted.cameras {
            Some(path) => Rig::read(path)?,
            None => own()?.ok_or_else(|| {
                StageError::new("there are no cameras", "name a scene, or a file with --cameras")
            })?,
        };
        // A file of cameras has no timeline; that of the scene is taken if there is a scene.
        let clip = match wanted.cameras {
            Some(_) => own().ok().flatten().unwrap_or_else(|| rig.clone()),
            None => rig.clone(),
        };
        let source = Source::open(&model, wanted.reader_options)?;
        let sampling = source.sampling.unwrap_or(Sampling::WHOLE);
        let (size, camera_size) = match wanted.size {
            Some(size) => (size, rig.size()),
            None if rig.size() == clip.size() => sampling.sizes(rig.size()),
            None => (rig.size(), rig.size()),
        };
        let timeline = clip.timeline();
        let cameras = match &wanted.flight {
            None => chosen(rig.cameras, wanted.views)?,
            Some(flight @ Flight::Path(_)) => vec![flight.camera(&rig.cameras, timeline)?],
            Some(flight) => vec![flight.camera(&chosen(rig.cameras, wanted.views)?, timeline)?],
        };
        let clip = clip.clip(space.profile());
        let instants = match wanted.times {
            [] => instants(wanted.frames, &sampling.moments(&clip), timeline)?,
            times => instants_at(times, &cameras)?,
        };
        // A model whose times cannot be mapped to frames can still be drawn at explicit times.
        let source = match source.moments {
            Some(Moments::Unknown) if !wanted.times.is_empty() => source,
            _ => source.on(&model, timeline, &clip)?,
        };
        let plan = Plan { cameras, camera_size, size, instants };
        plan.pictures().try_for_each(|index| plan.view(index).map(drop))?;
        let default: fn(&WorkDir) -> PathBuf = match wanted.flight {
            None => WorkDir::clips,
            Some(_) => |work| work.clips().with_file_name("flight"),
        };
        Ok(Self { model, source, out: place(wanted.out, default)?, plan, timeline })
    }
}

/// The cameras named by `views`; if that is empty all training ones, or all cameras where none is for training.
fn chosen(cameras: Vec<Camera>, views: &[String]) -> Result<Vec<Camera>, StageError> {
    let known: Vec<String> = cameras.iter().map(|camera| camera.name.to_string()).collect();
    if let Some(view) = views.iter().find(|view| !known.contains(view)) {
        return Err(StageError::new(
            format!("there is no view `{}`", view.escape_debug()),
            format!("choose among {}", known.join(", ")),
        ));
    }
    let any_training = cameras.iter().any(|camera| camera.split == Split::Train);
    let is_meant = |camera: &Camera| match views {
        [] => camera.split == Split::Train || !any_training,
        views => views.iter().any(|view| view.as_str() == camera.name.as_str()),
    };
    Ok(cameras.into_iter().filter(is_meant).collect())
}

/// Instants at these frames, ascending; at those of the clip if there are none.
fn instants(frames: &[u32], clip_frames: &[u32], timeline: Timeline) -> Result<Vec<DrawnTime>, StageError> {
    let frames = timeline.chosen(frames, clip_frames)?;
    if frames.is_empty() {
        return Err(StageError::new("nothing says when", "name a scene, --frames or --times"));
    }
    Ok(frames.into_iter().map(|frame| DrawnTime::at_frame(frame, timeline)).collect())
}
