//! The plan of a scene: tracks, cameras and USD stage, made by one short worker before anything is rendered.
//!
//! A plan stays good as long as the scripts that made it are unchanged; `plan.json` lists them with digests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::layout::{BenchDir, SceneDir};
use l4d_data::store::{list_folder, make_folder};
use l4d_data::tracks::Tracks;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, DataError, Name, Progress, json};
use serde::Deserialize;

use crate::Result;
use crate::env::BlenderEnv;
use crate::worker::{self, WorkerEnd, WorkerEvent};

/// What `plan.json` says; the rest of it is for people.
#[derive(Debug, Deserialize)]
struct PlanCard {
    scene: Name,
    seed: u64,
    bpy: String,
    scripts: BTreeMap<String, String>,
    /// Digest of the composition; none of a recipe in Python, which is among the scripts.
    #[serde(default)]
    composition: Option<String>,
}

/// What a scene is built from.
#[derive(Debug, Clone)]
pub struct Recipe {
    pub scene: Name,
    /// Of everything random.
    pub seed: u64,
    /// The folder of its composition, and the composition's digest; none for a recipe in Python.
    composition: Option<(PathBuf, String)>,
}

impl Recipe {
    /// The composition that a benchmark folder has for the scene, which fixes its own seed; otherwise the recipe in
    /// Python with this seed.
    ///
    /// # Errors
    /// A composition that cannot be read.
    pub fn of(bench: &BenchDir, scene: &Name, seed: u64) -> Result<Self> {
        let scene = scene.clone();
        Ok(match bench.read_composition(&scene)? {
            None => Self { scene, seed, composition: None },
            Some(composition) => {
                let digest = sha256_file(&bench.composition(&scene))?;
                Self { scene, seed: composition.seed, composition: Some((bench.recipes(), digest)) }
            }
        })
    }

    /// The folder that workers look for it in; none for the project's own.
    pub fn folder(&self) -> Option<&Path> {
        self.composition.as_ref().map(|(folder, _)| folder.as_path())
    }

    fn digest(&self) -> Option<&str> {
        self.composition.as_ref().map(|(_, digest)| digest.as_str())
    }
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
    recipe: &Recipe,
    work: &SharedWork,
    progress: &dyn Progress,
) -> Result<Plan> {
    if let Some(plan) = read_current(env.scripts(), dir, recipe) {
        return Ok(plan);
    }
    make_folder(dir.root())?;
    let Recipe { scene, seed, .. } = recipe;
    let mut command = env.command();
    command.args(["plan", "--scene", scene]);
    recipe.folder().map(|folder| command.arg("--recipes").arg(folder));
    command.args(["--seed", &seed.to_string(), "--out"]).arg(dir.root());
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

fn read_current(scripts: &Path, dir: &SceneDir, recipe: &Recipe) -> Option<Plan> {
    let card: PlanCard = json::read(&dir.plan()).ok()?;
    let same_recipe = (&card.scene, card.seed) == (&recipe.scene, recipe.seed)
        && card.composition.as_deref() == recipe.digest();
    let unchanged = |(script, digest): (&String, &String)| {
        sha256_file(&scripts.join(script)).is_ok_and(|now| now == *digest)
    };
    (same_recipe && dir.usd().exists() && card.scripts.iter().all(unchanged)).then(|| read(dir).ok())?
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
