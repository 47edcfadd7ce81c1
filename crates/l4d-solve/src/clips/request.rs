//! What `render-splats` draws: which model, from where, when, how large, and where it goes.

use std::path::{Path, PathBuf};

use l4d_data::layout::WorkDir;
use l4d_data::{Camera, DataError, Name, Rig, Split, StageError, Timeline, Workspace};
use l4d_splat::checkpoint::foreign::Moments;
use l4d_splat::checkpoint::own::Sampling;
use l4d_splat::source::{ReaderOptions, Source};

use super::{Flight, Instant, Plan, instants_at};

/// What a user asks for; everything that is left out has its default.
#[derive(Debug)]
pub struct Wanted<'a> {
    /// Scene, if one is meant.
    pub scene: Option<&'a Name>,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// The model, if not that of the scene.
    pub model: Option<&'a Path>,
    /// What is said of a model of others.
    pub reader_options: ReaderOptions,
    /// A file of cameras, in place of those of the scene.
    pub cameras: Option<&'a Path>,
    /// Names of the cameras; empty for all training ones.
    pub views: &'a [String],
    /// A camera that flies along them, in place of them.
    pub flight: Option<Flight>,
    /// Canonical frames.
    pub frames: &'a [u32],
    /// Times, 0 to 1, in place of frames.
    pub times: &'a [f32],
    /// Width and height of the pictures, pixels.
    pub size: Option<[u32; 2]>,
    /// Folder of the clips, if not that of the scene.
    pub out: Option<&'a Path>,
}

/// A model, what is drawn of it, and where that goes.
#[derive(Debug)]
pub struct ClipsRequest {
    /// Where the model stands.
    pub model: PathBuf,
    /// What was read from there.
    pub source: Source,
    /// Folder of the clips.
    pub out: PathBuf,
    /// From where and when.
    pub plan: Plan,
    /// When frames were.
    pub timeline: Timeline,
}

impl ClipsRequest {
    /// Resolves what is wanted. Whatever cannot be drawn is refused before the first file is written.
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
        // A file of cameras says nothing of time; the scene does, where it is at hand.
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
        // Where nothing says how its times lie in the clip, they can still be asked for as they are.
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

/// The views that were asked for, else all training ones; all of a file that has none.
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

/// Moments at these frames, else at those of the clip, ascending.
fn instants(frames: &[u32], clip: &[u32], timeline: Timeline) -> Result<Vec<Instant>, StageError> {
    let frames = timeline.chosen(frames, clip)?;
    if frames.is_empty() {
        return Err(StageError::new("nothing says when", "name a scene, --frames or --times"));
    }
    Ok(frames.into_iter().map(|frame| Instant::at_frame(frame, timeline)).collect())
}
