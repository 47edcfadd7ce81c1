//! What an answer leaves: masks on disk, and what each stage decided, in words.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
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

/// Stage by stage.
pub(super) fn tell(
    args: &QueryArgs,
    scene: &SolveScene,
    solved: &Solved,
    plan: &Plan,
    masks: &BTreeMap<Shot, Mask>,
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
    out.data("\nmasks")?;
    for (view, camera) in plan.cameras.iter().enumerate() {
        let of_view = || masks.iter().filter(|(shot, _)| shot.view == view).map(|(_, mask)| mask.area());
        let seen = of_view().filter(|&pixels| pixels > 0).count();
        let most = of_view().max().unwrap_or(0);
        out.data(format!(
            "  {:<8} seen in {seen} of {} frames, at most {most} pixels",
            camera.name.as_str(),
            of_view().count()
        ))?;
    }
    out.data("\nseconds")?;
    for entry in &solved.account.0 {
        let stage = serde_json::to_value(entry.stage)?;
        out.data(format!("  {:<10} {:>7.2}", stage.as_str().unwrap_or_default(), entry.seconds))?;
    }
    Ok(())
}
