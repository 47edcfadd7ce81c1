//! What an answer leaves: masks on disk, and what each stage decided, in words.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use l4d_data::Camera;
use l4d_data::store::write_atomic;
use l4d_frames::{Mask, png};
use l4d_solve::clips::{Plan, Shot};
use l4d_solve::scene::SolveScene;
use l4d_solve::solve::Solved;
use serde_json::{Map, Value, json};

use crate::cli::solver::QueryArgs;
use crate::out::Printer;

/// `masks/<camera>/<frame or time>.png`
pub(super) fn masks(folder: &Path, plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> Result<()> {
    for (shot, mask) in masks {
        let (camera, instant) = (&plan.cameras[shot.view], &plan.instants[shot.instant]);
        let path = folder.join("masks").join(camera.name.as_str()).join(format!("{}.png", instant.key));
        write_atomic(&path, &png::encode(mask))?;
    }
    Ok(())
}

/// Camera -> frame or time -> pixels of the answer.
pub(super) fn pixels(plan: &Plan, masks: &BTreeMap<Shot, Mask>) -> Value {
    let mut cameras = Map::new();
    for (shot, mask) in masks {
        let (camera, instant) = (&plan.cameras[shot.view], &plan.instants[shot.instant]);
        let of_camera = cameras.entry(camera.name.to_string()).or_insert_with(|| json!({}));
        of_camera[&instant.key] = json!(mask.area());
    }
    Value::Object(cameras)
}

/// What a camera sees of the answer.
pub(super) struct Sight<'p> {
    pub(super) camera: &'p Camera,
    /// Frames in which it is seen.
    pub(super) seen: usize,
    /// All frames.
    pub(super) frames: usize,
    /// Pixels in the frame with the most.
    pub(super) most_px: u64,
}

/// Camera by camera.
pub(super) fn sights<'p>(plan: &'p Plan, masks: &BTreeMap<Shot, Mask>) -> Vec<Sight<'p>> {
    let of_camera = |(view, camera): (usize, &'p Camera)| {
        let areas: Vec<u64> =
            masks.iter().filter(|(shot, _)| shot.view == view).map(|(_, mask)| mask.area()).collect();
        Sight {
            camera,
            seen: areas.iter().filter(|&&pixels| pixels > 0).count(),
            frames: areas.len(),
            most_px: areas.iter().copied().max().unwrap_or(0),
        }
    };
    plan.cameras.iter().enumerate().map(of_camera).collect()
}

/// Stage by stage.
pub(super) fn tell(
    args: &QueryArgs,
    scene: &SolveScene,
    solved: &Solved,
    sights: &[Sight<'_>],
    out: &Printer,
) -> Result<()> {
    out.data(format!(
        "clips      {} views x {} frames",
        scene.clips.len(),
        scene.clips.first().map_or(0, |clip| clip.frames.len())
    ))?;
    out.data("\ngrounding")?;
    for (clip, grounding) in scene.clips.iter().zip(&solved.groundings) {
        let marked = grounding.masks.values().filter(|mask| !mask.is_empty()).count();
        out.data(format!(
            "  {:<8} {:<12} {marked:>3} frames marked",
            clip.camera.name.as_str(),
            grounding.outcome.word()
        ))?;
        if let Some(why) = grounding.outcome.why() {
            out.data(format!("           {}", l4d_data::error::inert(&why)))?;
        }
        if args.explain {
            for note in &grounding.notes {
                out.data(format!("           {}", l4d_data::error::inert(note)))?;
            }
        }
    }
    out.data("\nconsensus")?;
    let table = if args.explain { solved.consensus.explain() } else { solved.consensus.summary() };
    for line in table.lines() {
        out.data(format!("  {line}"))?;
    }
    if !sights.is_empty() {
        out.data("\nmasks")?;
    }
    for Sight { camera, seen, frames, most_px } in sights {
        let name = camera.name.as_str();
        out.data(format!("  {name:<8} seen in {seen} of {frames} frames, at most {most_px} pixels"))?;
    }
    out.data("\nseconds")?;
    for entry in &solved.account.0 {
        let stage = serde_json::to_value(entry.stage)?;
        out.data(format!("  {:<10} {:>7.2}", stage.as_str().unwrap_or_default(), entry.seconds))?;
    }
    Ok(())
}
