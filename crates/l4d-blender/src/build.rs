//! The stage `build-scenes`: plan, render what is missing, settle.

use std::path::PathBuf;

use l4d_data::layout::BenchDir;
use l4d_data::parallel::in_parallel;
use l4d_data::store::sweep;
use l4d_data::workspace::SharedWork;
use l4d_data::{Name, Progress, Report, Workspace};

use crate::Result;
use crate::env::BlenderEnv;
use crate::part::Part;
use crate::plan::{Recipe, plan};
use crate::render::{PlannedScene, render};
use crate::settle::{commit, commit_truth, settle};

/// What is to be built.
#[derive(Debug)]
pub struct BuildRequest<'a> {
    pub scenes: &'a [Name],
    /// Of those in Python.
    pub seed: u64,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// Receives tracks and truth; its compositions come before recipes in Python.
    pub bench: &'a BenchDir,
    /// Logs and job files.
    pub work: &'a SharedWork,
    /// Of the colour pass, per pixel.
    pub samples: u32,
    /// No picture, only tracks.
    pub tracks_only: bool,
    /// Render again what other scripts, seeds or samples rendered before.
    pub overwrite: bool,
    /// Replace committed tracks and truth that differ.
    pub update_benchmark: bool,
    /// Blender processes at once.
    pub jobs: usize,
    /// Which of the pictures.
    pub part: &'a Part,
}

/// What was built.
#[derive(Debug, Default)]
pub struct Built {
    /// Folders of the scenes that are whole.
    pub settled: Vec<PathBuf>,
    /// Pictures that this run rendered; none where only tracks were asked for.
    pub rendered: Option<u64>,
    /// Scenes that lack pictures, of which only a part was asked for.
    pub unfinished: Vec<Name>,
}

/// Builds scenes. A killed build that is run again ends with the same bytes.
///
/// # Errors
/// Whatever planning, rendering and settling meet. Committed tracks or truth that differ are findings (L4D120).
pub fn build(
    env: &BlenderEnv,
    request: &BuildRequest<'_>,
    progress: &dyn Progress,
    report: &mut Report,
) -> Result<Built> {
    let profile = request.space.profile();
    // Some scenes at once: a plan is mostly one thread's work.
    let recipe = |name| Recipe::of(request.bench, name, request.seed);
    let recipes: Vec<Recipe> = request.scenes.iter().map(recipe).collect::<Result<_>>()?;
    progress.start("planning", recipes.len() as u64);
    let plans = in_parallel(&recipes, request.jobs, |recipe| {
        progress.item(&recipe.scene);
        let plan = plan(env, &request.space.scene(&recipe.scene), recipe, request.work, progress);
        progress.advance(1);
        plan
    })?;
    progress.finish();
    let mut planned = Vec::new();
    for (recipe, plan) in recipes.into_iter().zip(plans) {
        request.part.check(&plan.tracks, profile)?;
        commit(&request.bench.tracks(&recipe.scene), &plan.tracks, request.update_benchmark, report)?;
        let dir = request.space.scene(&recipe.scene);
        planned.push(PlannedScene::new(recipe, dir, plan, profile, request.samples));
    }
    if request.tracks_only {
        return Ok(Built::default());
    }
    planned.iter().try_for_each(|scene| scene.claim(request.overwrite))?;
    let rendered = Some(render(env, &planned, request.part, request.jobs, request.work, progress)?);
    if !request.part.is_all() {
        let unfinished: Vec<Name> = planned
            .iter()
            .filter(|scene| !scene.is_whole())
            .map(|scene| scene.recipe.scene.clone())
            .collect();
        if !unfinished.is_empty() {
            return Ok(Built { rendered, unfinished, settled: Vec::new() });
        }
    }
    let mut settled = Vec::new();
    for scene in &planned {
        sweep(scene.dir.root())?;
        let truth = settle(scene)?;
        commit_truth(
            &request.bench.truth(profile, &scene.recipe.scene),
            &truth,
            request.update_benchmark,
            report,
        )?;
        settled.push(scene.dir.root().to_owned());
    }
    Ok(Built { rendered, settled, unfinished: Vec::new() })
}
