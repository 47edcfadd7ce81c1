//! From where and when masks are wanted.

use l4d_data::{Camera, Interval, Rig, StageError};

use super::Ask;
use crate::clips::{Instant, Plan};
use crate::scene::{Places, SolveScene};

/// The cameras that were named, else those of the file, else the held-out one; at the moments of the clips, or at the
/// times that were named.
pub(super) fn plan(
    order: &Ask<'_>,
    range: Option<Interval>,
    scene: &SolveScene,
    places: &Places,
) -> Result<Plan, StageError> {
    let file = order.camera_file.map(Rig::read).transpose()?;
    let rig = file.as_ref().unwrap_or(&scene.rig);
    let cameras = match (order.cameras, &file) {
        ([], Some(file)) => file.cameras.clone(),
        ([], None) => scene.judged(places)?.cameras,
        (names, _) => {
            names.iter().map(|name| camera(rig, name).cloned()).collect::<Result<_, StageError>>()?
        }
    };
    // Of the scene's own cameras, pictures as large as the clips.
    let (camera_size, size) = match &file {
        None => (scene.plan.camera_size, scene.plan.size),
        Some(file) => (file.size(), file.size()),
    };
    // `range` has been taken out of the moments of the clips already.
    let mut plan = Plan { cameras, camera_size, size, instants: scene.plan.instants.clone() };
    if !order.times.is_empty() {
        plan.instants = instants(order.times, &plan.cameras)?;
    }
    if let Some(range) = range {
        let ends = [range.first(), range.last()].map(|frame| scene.timeline.time(frame));
        plan.instants.retain(|instant| (ends[0]..=ends[1]).contains(&instant.time));
        if plan.instants.is_empty() {
            return Err(StageError::new(
                format!("no moment of the masks lies between frames {} and {}", range.first(), range.last()),
                "widen --from and --to, or choose another --time; clips have some frames alone",
            ));
        }
    }
    if let Some(size) = order.size {
        plan.size = size;
    }
    Ok(plan)
}

fn camera<'a>(rig: &'a Rig, name: &str) -> Result<&'a Camera, StageError> {
    rig.camera(name).ok_or_else(|| {
        let known: Vec<&str> = rig.cameras.iter().map(|camera| camera.name.as_str()).collect();
        StageError::new(
            format!("there is no camera `{}`", name.escape_debug()),
            format!("choose among {}", known.join(", ")),
        )
    })
}

/// Moments at these times, in order. A camera that moves is known at frames alone.
///
/// # Errors
/// A time outside 0 to 1, or a camera that moves.
pub(crate) fn instants(times: &[f32], cameras: &[Camera]) -> Result<Vec<Instant>, StageError> {
    if let Some(time) = times.iter().find(|time| !(0.0..=1.0).contains(*time)) {
        return Err(StageError::new(format!("time {time} is outside the clip"), "times are 0 to 1"));
    }
    if let Some(camera) = cameras.iter().find(|camera| camera.world_from_camera.len() > 1) {
        return Err(StageError::new(
            format!("camera {} moves, and is known at canonical frames alone", camera.name),
            "choose frames instead of times",
        ));
    }
    let mut instants: Vec<Instant> = times.iter().copied().map(Instant::at_time).collect();
    instants.sort_by(|a, b| a.time.total_cmp(&b.time));
    instants.dedup_by(|a, b| a.key == b.key);
    Ok(instants)
}
