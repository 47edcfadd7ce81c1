//! What is to be drawn: which model, from where, when, how large, and where it goes.

use std::path::PathBuf;

use anyhow::Result;
use l4d_data::layout::WorkDir;
use l4d_data::{Camera, Draw, Name, Rig, Split, Timeline, Workspace};
use l4d_solve::clips::{Instant, Plan};
use l4d_splat::checkpoint::own::Sampling;
use l4d_splat::source::Source;

use crate::cli::splats::RenderSplatsArgs;
use crate::out::refusal;

/// A model, what is drawn of it, and where that goes.
#[derive(Debug)]
pub(super) struct Order {
    /// Where the model stands.
    pub(super) model: PathBuf,
    pub(super) source: Source,
    pub(super) out: PathBuf,
    pub(super) plan: Plan,
    pub(super) timeline: Timeline,
}

impl Order {
    pub(super) fn of(args: &RenderSplatsArgs) -> Result<Self> {
        let scene = args.scene.as_deref().map(Name::new).transpose()?;
        let work = scene
            .as_ref()
            .map(|scene| Workspace::new(args.profile, Draw::default()).with_work(&args.work).work(scene));
        let place = |given: &Option<PathBuf>, default: fn(&WorkDir) -> PathBuf| {
            given
                .clone()
                .or_else(|| work.as_ref().map(default))
                .ok_or_else(|| refusal("there is no scene", "name a scene, or --model, --cameras and --out"))
        };
        let model = place(&args.model, WorkDir::splats)?;
        let own = || scene.as_ref().map(|scene| scene_rig(args, scene)).transpose();
        let rig = match &args.cameras {
            Some(path) => Rig::read(path)?,
            None => own()?
                .ok_or_else(|| refusal("there are no cameras", "name a scene, or a file with --cameras"))?,
        };
        // A file of cameras says nothing of time; the scene does, where it is at hand.
        let clip = match &args.cameras {
            Some(_) => own().ok().flatten().unwrap_or_else(|| rig.clone()),
            None => rig.clone(),
        };
        let source = Source::open(&model)?;
        let sampling = source.sampling.unwrap_or(Sampling::WHOLE);
        let (size, camera_size) = match args.size {
            Some(size) => (size.0, rig.size()),
            None if rig.size() == clip.size() => sampling.sizes(rig.size()),
            None => (rig.size(), rig.size()),
        };
        let timeline = clip.timeline();
        let plan = Plan {
            camera_size,
            size,
            instants: instants(args, &sampling.moments(&clip.clip(args.profile)), timeline)?,
            cameras: chosen(rig.cameras, args)?,
        };
        // Whatever cannot be drawn is refused before the first file is written.
        refuse_unknown_poses(&plan)?;
        plan.shots().try_for_each(|shot| plan.view(shot).map(drop))?;
        Ok(Self { model, source, out: place(&args.out, WorkDir::clips)?, plan, timeline })
    }
}

fn refuse_unknown_poses(plan: &Plan) -> Result<()> {
    let is_between = plan.instants.iter().any(|instant| instant.frame.is_none());
    match plan.cameras.iter().find(|camera| is_between && camera.world_from_camera.len() > 1) {
        Some(camera) => Err(refusal(
            format!("camera {} moves, and is known at canonical frames alone", camera.name),
            "choose --frames instead of --times",
        )),
        None => Ok(()),
    }
}

fn scene_rig(args: &RenderSplatsArgs, name: &Name) -> Result<Rig> {
    let space = Workspace::new(args.profile, Draw::default()).with_data(args.data.as_deref());
    Ok(Rig::read(&space.scene(name).rig(args.profile))?)
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

/// `clip` is what is drawn where nothing else is asked for.
fn instants(args: &RenderSplatsArgs, clip: &[u32], timeline: Timeline) -> Result<Vec<Instant>> {
    let whole = timeline.whole();
    if let Some(frame) = args.frames.iter().find(|frame| !whole.contains(**frame)) {
        return Err(refusal(
            format!("frame {frame} is beyond the clip"),
            format!("frames are {} to {}", whole.first(), whole.last()),
        ));
    }
    if let Some(time) = args.times.iter().find(|time| !(0.0..=1.0).contains(*time)) {
        return Err(refusal(format!("time {time} is outside the clip"), "times are 0 to 1"));
    }
    let mut instants: Vec<Instant> = if !args.times.is_empty() {
        args.times.iter().copied().map(Instant::at_time).collect()
    } else if !args.frames.is_empty() {
        args.frames.iter().map(|&frame| Instant::at_frame(frame, timeline)).collect()
    } else {
        clip.iter().map(|&frame| Instant::at_frame(frame, timeline)).collect()
    };
    if instants.is_empty() {
        return Err(refusal("nothing says when", "name a scene, --frames or --times"));
    }
    instants.sort_by(|a, b| a.time.total_cmp(&b.time));
    instants.dedup_by(|a, b| a.key == b.key);
    Ok(instants)
}
