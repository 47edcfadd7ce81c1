//! The plan of a scene: tracks, cameras and USD stage, made by one short worker before anything is rendered.
//!
//! A plan stays good as long as the scripts that made it are unchanged; `plan.json` lists them with digests.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::layout::SceneDir;
use l4d_data::store::{list_folder, make_folder};
use l4d_data::tracks::Tracks;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, DataError, Draw, Name, Progress, json};
use serde::Deserialize;

use crate::Result;
use crate::env::BlenderEnv;
use crate::worker::{self, WorkerEnd, WorkerEvent};

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
pub struct Plan {
    /// Where everything is at each canonical frame.
    pub tracks: Tracks,
    /// Version of bpy.
    pub bpy: String,
    /// Of the scripts that made it.
    pub scripts_sha256: String,
}

/// The plan in `dir` if the scripts that made it are unchanged, otherwise a new one.
///
/// # Errors
/// A worker that refuses or dies, with the end of its log.
pub fn plan(
    env: &BlenderEnv,
    dir: &SceneDir,
    scene: &Name,
    draw: Draw,
    work: &SharedWork,
    progress: &dyn Progress,
) -> Result<Plan> {
    if let Some(plan) = read_current(env.scripts(), dir, scene, draw) {
        return Ok(plan);
    }
    make_folder(dir.root())?;
    let mut command = env.command();
    command.args(["plan", "--scene", scene]);
    command.args(["--variant", &draw.variant.to_string(), "--seed", &draw.seed.to_string(), "--out"]);
    command.arg(dir.root());
    let end = worker::run(command, &work.log("plan", scene), &mut |event| {
        if let WorkerEvent::Warning { message } = event {
            progress.warn(&format_args!("{scene}: {message}"));
        }
        true
    })?;
    match end {
        WorkerEnd::Done | WorkerEnd::Stopped => read(dir),
        WorkerEnd::Refused(error) | WorkerEnd::Died(error) => {
            Err(error).at(format_args!("cannot plan {scene}"))
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

/// Scenes that have a recipe, sorted.
///
/// # Errors
/// A folder that cannot be listed.
pub fn recipes(scripts: &Path) -> Result<Vec<String>, DataError> {
    let names = list_folder(&scripts.join("scenes"))?;
    let stems =
        names.iter().filter_map(|name| name.strip_suffix(".py")).filter(|stem| !stem.starts_with('_'));
    Ok(stems.map(str::to_owned).collect())
}
