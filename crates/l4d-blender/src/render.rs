//! Rendering: which pictures are missing, who renders them, and what to do when a worker dies.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::parallel::in_parallel;
use l4d_data::store::Temporary;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, DataError, Name, Profile, Progress, StageError, json};
use l4d_frames::exr::read_frame;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::env::BlenderEnv;
use crate::part::Part;
use crate::plan::{Plan, Recipe};
use crate::worker::{self, WorkerEnd, WorkerEvent};

const JOB_SCHEMA: &str = "l4d/render-job/1";
/// With a single thread Cycles keeps a second one spinning, which doubles the processor time of a picture.
const LEAST_THREADS: usize = 2;

/// How pictures are made; pictures made otherwise are never mixed with them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RenderSettings {
    pub(crate) profile: Profile,
    /// Always 0; there were others once.
    pub(crate) variant: u32,
    pub(crate) seed: u64,
    /// Of the colour pass, per pixel.
    pub(crate) samples: u32,
    /// Version of bpy.
    pub(crate) bpy: String,
    /// Of the scripts that planned the scene.
    pub(crate) scripts_sha256: String,
}

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct Image {
    pub(crate) frame: u32,
    pub(crate) view: Name,
}

/// What a worker is asked to render.
#[derive(Debug, Serialize)]
struct Job<'a> {
    schema: &'a str,
    scene: &'a Name,
    seed: u64,
    profile: Profile,
    width: u32,
    height: u32,
    samples: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipes: Option<&'a Path>,
    denoise: bool,
    threads: usize,
    out: &'a Path,
    tracks: PathBuf,
    images: &'a [Image],
}

/// A scene and the pictures of it that one worker renders.
#[derive(Debug)]
struct Piece<'a> {
    scene: &'a PlannedScene,
    number: usize,
    images: Vec<Image>,
}

/// A scene that is ready to be rendered.
#[derive(Debug)]
pub(crate) struct PlannedScene {
    pub(crate) recipe: Recipe,
    pub(crate) dir: SceneDir,
    pub(crate) plan: Plan,
    pub(crate) settings: RenderSettings,
}

impl PlannedScene {
    pub(crate) fn new(recipe: Recipe, dir: SceneDir, plan: Plan, profile: Profile, samples: u32) -> Self {
        let settings = RenderSettings {
            profile,
            variant: 0,
            seed: recipe.seed,
            samples,
            bpy: plan.bpy.clone(),
            scripts_sha256: plan.scripts_sha256.clone(),
        };
        Self { recipe, dir, plan, settings }
    }

    /// Every picture of the profile, frame by frame: a worker then moves through time once.
    pub(crate) fn images(&self) -> Vec<Image> {
        let profile = self.settings.profile;
        let views: Vec<&Name> = self.plan.tracks.views(profile).map(|camera| &camera.name).collect();
        let of_frame = |frame| views.iter().map(move |view| Image { frame, view: (*view).clone() });
        profile.frames().flat_map(of_frame).collect()
    }

    /// Makes sure that what the folder holds was rendered with the same settings.
    /// Pictures of other settings are refused, unless `overwrite` removes them.
    pub(crate) fn claim(&self, overwrite: bool) -> Result<()> {
        let path = self.dir.root().join("render.json");
        let frames = self.dir.root().join("frames");
        if frames.exists() && json::read::<RenderSettings>(&path).ok().as_ref() != Some(&self.settings) {
            if !overwrite {
                return Err(StageError::new(
                    format!("{} holds pictures of other scripts, seeds or samples", frames.display()),
                    "add --force to render them again, or choose another folder with --data",
                ));
            }
            std::fs::remove_dir_all(&frames).map_err(|error| DataError::io(&frames, "remove", error))?;
            std::fs::remove_file(self.dir.scene()).ok();
        }
        json::write(&path, &self.settings)?;
        Ok(())
    }

    /// Whether every picture of the profile is on disk. What is torn is not, which takes reading them all; so the first
    /// look is for files that are not there.
    pub(crate) fn is_whole(&self) -> bool {
        let is_there = |image: &Image| self.dir.frame(&image.view, image.frame).exists();
        self.images().iter().all(is_there) && self.missing_of(self.images()).is_empty()
    }

    /// Those of some pictures that are not on disk, or torn, or of another size.
    fn missing_of(&self, images: Vec<Image>) -> Vec<Image> {
        let size = UVec2::new(self.settings.profile.width(), self.settings.profile.height());
        let is_good = |image: &Image| read_frame(&self.dir.frame(&image.view, image.frame), size).is_ok();
        let views_without_card: Vec<&Name> = self
            .plan
            .tracks
            .views(self.settings.profile)
            .map(|camera| &camera.name)
            .filter(|view| !self.dir.view_card(view).exists())
            .collect();
        images
            .into_par_iter()
            .filter(|image| views_without_card.contains(&&image.view) || !is_good(image))
            .collect()
    }
}

/// Renders what is missing of the scenes. Gives the number of pictures that this call rendered, or the error of the
/// first worker that refuses or dies without having made a picture.
pub(crate) fn render(
    env: &BlenderEnv,
    scenes: &[PlannedScene],
    part: &Part,
    jobs: usize,
    work: &SharedWork,
    progress: &dyn Progress,
) -> Result<u64> {
    let jobs = jobs.max(1);
    let mut open = Vec::new();
    for scene in scenes {
        let missing = scene.missing_of(part.of(scene.images(), scene.settings.profile)?);
        if !missing.is_empty() {
            open.push((scene, missing));
        }
    }
    let total = open.iter().map(|(_, images): &(_, Vec<Image>)| images.len() as u64).sum();
    if total == 0 {
        return Ok(0);
    }
    let crew = Workers {
        env,
        work,
        progress,
        threads: (thread::available_parallelism().map_or(1, NonZeroUsize::get) / jobs).max(LEAST_THREADS),
        stop: AtomicBool::new(false),
    };
    progress.start("rendering", total);
    let end = in_parallel(&pieces(open, jobs), jobs, |piece| crew.render_piece(piece));
    progress.finish();
    end.map(|_| total)
}

/// Whole scenes, since every worker has to build the scene that it renders; only those that are left over when all
/// workers got equally many are cut up.
fn pieces(open: Vec<(&PlannedScene, Vec<Image>)>, jobs: usize) -> Vec<Piece<'_>> {
    let whole = open.len() - open.len() % jobs;
    let mut pieces = Vec::new();
    for (place, (scene, images)) in open.into_iter().enumerate() {
        let workers = if place < whole { 1 } else { jobs };
        let length = images.len().div_ceil(workers);
        for (number, images) in images.chunks(length).enumerate() {
            pieces.push(Piece { scene, number, images: images.to_vec() });
        }
    }
    pieces
}

/// What the supervisors of workers share.
struct Workers<'a> {
    env: &'a BlenderEnv,
    work: &'a SharedWork,
    progress: &'a dyn Progress,
    threads: usize,
    /// One of them failed: the workers of the others are stopped.
    stop: AtomicBool,
}

impl Workers<'_> {
    /// Renders a piece; a worker that dies after making progress is replaced, one that made none is not.
    fn render_piece(&self, piece: &Piece<'_>) -> Result<()> {
        let mut images = piece.images.clone();
        let end = self
            .render_images(piece, &mut images)
            .at(format_args!("cannot render {}", piece.scene.recipe.scene));
        self.stop.fetch_or(end.is_err(), Ordering::Relaxed);
        end
    }

    fn render_images(&self, piece: &Piece<'_>, images: &mut Vec<Image>) -> Result<()> {
        while !images.is_empty() {
            let before = images.len();
            match self.run_worker(piece, images)? {
                WorkerEnd::Done if images.is_empty() => {}
                WorkerEnd::Stopped => return Ok(()),
                WorkerEnd::Done => {
                    let message = format!("the worker left out {} pictures", images.len());
                    let hint = "run the command again; if it stays, please report it";
                    return Err(StageError::new(message, hint));
                }
                WorkerEnd::Died(error) if images.len() < before => {
                    self.progress
                        .warn(&format_args!("{}: starting a new worker: {error}", piece.scene.recipe.scene));
                }
                WorkerEnd::Died(error) | WorkerEnd::Refused(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn run_worker(&self, piece: &Piece<'_>, images: &mut Vec<Image>) -> Result<WorkerEnd> {
        let scene = piece.scene;
        let root = std::path::absolute(scene.dir.root())
            .map_err(|error| DataError::io(scene.dir.root(), "resolve", error))?;
        let profile = scene.settings.profile;
        let job = Job {
            schema: JOB_SCHEMA,
            scene: &scene.recipe.scene,
            seed: scene.settings.seed,
            profile,
            width: profile.width(),
            height: profile.height(),
            samples: scene.settings.samples,
            recipes: scene.recipe.folder(),
            denoise: true,
            threads: self.threads,
            tracks: root.join("tracks.json"),
            out: &root,
            images,
        };
        let name = format!("{}-{profile}-{}-{}", scene.recipe.scene, std::process::id(), piece.number);
        let mut file = Temporary::create(&self.work.jobs())?;
        let job = serde_json::to_vec(&job).map_err(std::io::Error::from);
        let written = job.and_then(|job| file.write(&job)).and_then(|()| file.flush());
        written.map_err(|error| DataError::io(file.path(), "write", error))?;
        let mut command = self.env.command();
        command.arg("render").arg(file.path());
        self.progress.item(&scene.recipe.scene);
        worker::run(command, &self.work.log("render", &name), &mut |event| {
            match event {
                WorkerEvent::Image { view, frame } => {
                    self.progress.advance(1);
                    images.retain(|image| !(image.view.as_str() == view && image.frame == *frame));
                }
                WorkerEvent::Warning { message } => self.progress.warn(message),
                WorkerEvent::Start { device } => {
                    tracing::info!(scene = %scene.recipe.scene, device, "worker started");
                }
                _ => {}
            }
            !self.stop.load(Ordering::Relaxed)
        })
    }
}
