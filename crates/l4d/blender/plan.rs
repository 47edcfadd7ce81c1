//! The plan of a scene: tracks, cameras and USD stage, made by one short worker before anything is rendered.
//!
//! A plan stays good as long as the scripts that made it are unchanged; `plan.json` lists them with digests.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Result;
use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::layout::SceneDir;
use l4d_data::store::make_folder;
use l4d_data::tracks::Tracks;
use l4d_data::{Draw, Name, json};
use serde::Deserialize;

use super::env::BlenderEnv;
use super::worker::{self, WorkerEnd, WorkerEvent};
use crate::out::Printer;

/// What `plan.json` says; the rest of it is for people.
#[derive(Debug, Deserialize)]
struct PlanCard {
    scene: Name,
    variant: u32,
    seed: u64,
    bpy: String,
    scripts: BTreeMap<String, String>,
}

/// A planned scene.
#[derive(Debug)]
pub(crate) struct Plan {
    pub(crate) tracks: Tracks,
    pub(crate) bpy: String,
    pub(crate) scripts_sha256: String,
}

/// The plan in `dir` if the scripts that made it are those of today, otherwise a new one.
pub(crate) fn plan(
    env: &BlenderEnv,
    dir: &SceneDir,
    scene: &Name,
    draw: Draw,
    work: &Path,
    out: &Printer,
) -> Result<Plan> {
    if let Some(plan) = read_current(env.scripts(), dir, scene, draw) {
        return Ok(plan);
    }
    make_folder(dir.root())?;
    let mut command = env.command();
    command.args(["plan", "--scene", scene]);
    command.args(["--variant", &draw.variant.to_string(), "--seed", &draw.seed.to_string(), "--out"]);
    command.arg(dir.root());
    let log = worker::log_path(work, "plan", scene);
    let end = worker::run(command, &log, &mut |event| {
        if let WorkerEvent::Warning { message } = event {
            out.warn(format!("{scene}: {message}"));
        }
        Ok(true)
    })?;
    match end {
        WorkerEnd::Done | WorkerEnd::Stopped => read(dir),
        WorkerEnd::Refused(error) | WorkerEnd::Died(error) => {
            Err(error.context(format!("cannot plan {scene}")))
        }
    }
}

fn read_current(scripts: &Path, dir: &SceneDir, scene: &Name, draw: Draw) -> Option<Plan> {
    let card: PlanCard = json::read(&dir.plan()).ok()?;
    let same_draw = (&card.scene, card.variant, card.seed) == (scene, draw.variant, draw.seed);
    let unchanged = |(script, digest): (&String, &String)| {
        sha256_file(&scripts.join(script)).is_ok_and(|now| now == *digest)
    };
    (same_draw && dir.usd().exists() && card.scripts.iter().all(unchanged)).then(|| read(dir).ok())?
}

fn read(dir: &SceneDir) -> Result<Plan> {
    let card: PlanCard = json::read(&dir.plan())?;
    let lines: String = card.scripts.iter().map(|(script, digest)| format!("{digest}  {script}\n")).collect();
    Ok(Plan {
        tracks: Tracks::read(&dir.tracks())?,
        bpy: card.bpy,
        scripts_sha256: sha256_hex(lines.as_bytes()),
    })
}
