//! Rendering: which pictures are missing, who renders them, and what to do when a worker dies.

use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::store::list_folder;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, DataError, Draw, Name, Profile, Progress, Shard, StageError, json};
use l4d_frames::exr::read_frame;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::env::BlenderEnv;
use crate::plan::Plan;
use crate::worker::{self, WorkerEnd, WorkerEvent};

const JOB_SCHEMA: &str = "l4d/render-job/1";
/// With a single thread Cycles keeps a second one spinning, which doubles the processor time of a picture.
const LEAST_THREADS: usize = 2;

/// How pictures are made; pictures made otherwise are never mixed with them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderSettings {
    /// Pixels, frames, views.
    pub profile: Profile,
    /// Permutation of the recipe.
    pub variant: u32,
    /// Of everything random.
    pub seed: u64,
    /// Of the colour pass, per pixel.
    pub samples: u32,
    /// Version of bpy.
    pub bpy: String,
    /// Of the scripts that planned the scene.
    pub scripts_sha256: String,
}

/// One picture.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Image {
    /// Canonical frame.
    pub frame: u32,
    /// Camera.
    pub view: Name,
}

/// What a worker is asked to render.
#[derive(Debug, Serialize)]
struct Job<'a> {
    schema: &'a str,
    scene: &'a Name,
    variant: u32,
    seed: u64,
    profile: Profile,
    width: u32,
    height: u32,
    samples: u32,
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
pub struct PlannedScene {
    /// Of the recipe.
    pub name: Name,
    /// Where its pictures go.
    pub dir: SceneDir,
    /// Tracks and cameras.
    pub plan: Plan,
    /// How it is rendered.
    pub settings: RenderSettings,
}

impl PlannedScene {
    /// A plan with the settings that its pictures are rendered with.
    pub fn new(name: Name, dir: SceneDir, plan: Plan, profile: Profile, draw: Draw, samples: u32) -> Self {
        let settings = RenderSettings {
            profile,
            variant: draw.variant,
            seed: draw.seed,
            samples,
            bpy: plan.bpy.clone(),
            scripts_sha256: plan.scripts_sha256.clone(),
        };
        Self { name, dir, plan, settings }
    }

    /// Every picture of the profile, frame by frame: a worker then moves through time once.
    pub fn images(&self) -> Vec<Image> {
        let profile = self.settings.profile;
        let views: Vec<&Name> = self.plan.tracks.views(profile).map(|camera| &camera.name).collect();
        let of_frame = |frame| views.iter().map(move |view| Image { frame, view: (*view).clone() });
        profile.frames().flat_map(of_frame).collect()
    }

    /// Makes sure that what the folder holds was rendered with the same settings.
    ///
    /// # Errors
    /// Pictures of other settings, unless `overwrite` removes them.
    pub fn claim(&self, overwrite: bool) -> Result<()> {
        let path = self.dir.root().join("render.json");
        let frames = self.dir.root().join("frames");
        if frames.exists() && json::read::<RenderSettings>(&path).ok().as_ref() != Some(&self.settings) {
            if !overwrite {
                return Err(StageError::new(
                    format!("{} holds pictures of other scripts, seeds or samples", frames.display()),
                    "add --overwrite to render them again, or choose another folder with --data",
                ));
            }
            std::fs::remove_dir_all(&frames).map_err(|error| DataError::io(&frames, "remove", error))?;
            std::fs::remove_file(self.dir.scene()).ok();
        }
        json::write(&path, &self.settings)?;
        Ok(())
    }

    /// The pictures that are not on disk, or torn, or of another size.
    pub fn missing(&self) -> Vec<Image> {
        let size = UVec2::new(self.settings.profile.width(), self.settings.profile.height());
        let is_good = |image: &Image| read_frame(&self.dir.frame(&image.view, image.frame), size).is_ok();
        let views_without_card: Vec<&Name> = self
            .plan
            .tracks
            .views(self.settings.profile)
            .map(|camera| &camera.name)
            .filter(|view| !self.dir.view_card(view).exists())
            .collect();
        self.images()
            .into_par_iter()
            .filter(|image| views_without_card.contains(&&image.view) || !is_good(image))
            .collect()
    }

    /// Removes what killed workers left half-written. Only safe while nothing renders into the folder.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn sweep(&self) -> Result<(), DataError> {
        for camera in self.plan.tracks.views(self.settings.profile) {
            let folder = self.dir.view(&camera.name);
            let entries = std::fs::read_dir(&folder)
                .map_err(|source| DataError::io(&folder, "list the folder", source))?;
            for entry in entries.flatten() {
                let name = entry.file_name().to_string_lossy().into_owned();
                if name.starts_with('.') && name.ends_with(".tmp") {
                    std::fs::remove_file(entry.path())
                        .map_err(|source| DataError::io(&entry.path(), "remove", source))?;
                }
            }
        }
        Ok(())
    }
}

/// Renders what is missing of the scenes. Gives the number of pictures that this call rendered.
///
/// # Errors
/// The first worker that refuses, or dies without having made a picture.
pub fn render(
    env: &BlenderEnv,
    scenes: &[PlannedScene],
    shard: Option<Shard>,
    jobs: usize,
    work: &SharedWork,
    progress: &dyn Progress,
) -> Result<u64> {
    let jobs = jobs.max(1);
    let missing = scenes.iter().map(|scene| of_shard(scene.missing(), shard, scene.settings.profile));
    let open: Vec<(&PlannedScene, Vec<Image>)> =
        scenes.iter().zip(missing).filter(|(_, images)| !images.is_empty()).collect();
    let total = open.iter().map(|(_, images)| images.len() as u64).sum();
    if total == 0 {
        return Ok(0);
    }
    let crew = Crew {
        env,
        work,
        progress,
        threads: (thread::available_parallelism().map_or(1, NonZeroUsize::get) / jobs).max(LEAST_THREADS),
        queue: Mutex::new(pieces(open, jobs)),
        stop: AtomicBool::new(false),
    };
    progress.start("rendering", total);
    let ends: Vec<Result<()>> = thread::scope(|scope| {
        let hands: Vec<_> = (0..jobs).map(|_| scope.spawn(|| crew.work_off())).collect();
        let join = |hand: thread::ScopedJoinHandle<'_, Result<()>>| {
            hand.join().unwrap_or_else(|_| Err(StageError::new("a supervisor panicked", "please report it")))
        };
        hands.into_iter().map(join).collect()
    });
    progress.finish();
    ends.into_iter().collect::<Result<()>>()?;
    Ok(total)
}

/// Whole scenes, since every worker has to build the scene that it renders; only those that are left over when all
/// workers got equally many are cut up.
fn pieces(open: Vec<(&PlannedScene, Vec<Image>)>, jobs: usize) -> VecDeque<Piece<'_>> {
    let whole = open.len() - open.len() % jobs;
    let mut pieces = VecDeque::new();
    for (place, (scene, images)) in open.into_iter().enumerate() {
        let workers = if place < whole { 1 } else { jobs };
        let length = images.len().div_ceil(workers);
        for (number, images) in images.chunks(length).enumerate() {
            pieces.push_back(Piece { scene, number, images: images.to_vec() });
        }
    }
    pieces
}

/// Shard i of n renders every n-th frame of the profile, so that the views of a frame stay together.
fn of_shard(images: Vec<Image>, shard: Option<Shard>, profile: Profile) -> Vec<Image> {
    let Some(Shard { index, count }) = shard else { return images };
    let is_ours = |image: &Image| (image.frame / profile.stride()) as usize % count == index - 1;
    images.into_iter().filter(is_ours).collect()
}

/// Supervisors that share a queue of pieces; each runs one worker at a time.
struct Crew<'a> {
    env: &'a BlenderEnv,
    work: &'a SharedWork,
    progress: &'a dyn Progress,
    threads: usize,
    queue: Mutex<VecDeque<Piece<'a>>>,
    stop: AtomicBool,
}

impl Crew<'_> {
    fn work_off(&self) -> Result<()> {
        loop {
            let piece = self.queue.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
            let Some(piece) = piece else { return Ok(()) };
            if self.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let end = self.render_piece(piece);
            if end.is_err() {
                self.stop.store(true, Ordering::Relaxed);
                return end;
            }
        }
    }

    /// Renders a piece; a worker that dies after making progress is replaced, one that made none is not.
    fn render_piece(&self, mut piece: Piece<'_>) -> Result<()> {
        while !piece.images.is_empty() {
            let before = piece.images.len();
            match self.run_worker(&mut piece)? {
                WorkerEnd::Done if piece.images.is_empty() => {}
                WorkerEnd::Stopped => return Ok(()),
                WorkerEnd::Done => {
                    let message = format!(
                        "the worker left out {} pictures of {}",
                        piece.images.len(),
                        piece.scene.name
                    );
                    return Err(StageError::new(
                        message,
                        "run the command again; if it stays, please report it",
                    ));
                }
                WorkerEnd::Died(error) if piece.images.len() < before => {
                    self.progress.warn(&format_args!("{}: starting a new worker: {error}", piece.scene.name));
                }
                WorkerEnd::Died(error) | WorkerEnd::Refused(error) => {
                    return Err(error).at(format_args!("cannot render {}", piece.scene.name));
                }
            }
        }
        Ok(())
    }

    fn run_worker(&self, piece: &mut Piece<'_>) -> Result<WorkerEnd> {
        let scene = piece.scene;
        let root = std::path::absolute(scene.dir.root())
            .map_err(|error| DataError::io(scene.dir.root(), "resolve", error))?;
        let profile = scene.settings.profile;
        let job = Job {
            schema: JOB_SCHEMA,
            scene: &scene.name,
            variant: scene.settings.variant,
            seed: scene.settings.seed,
            profile,
            width: profile.width(),
            height: profile.height(),
            samples: scene.settings.samples,
            denoise: true,
            threads: self.threads,
            tracks: root.join("tracks.json"),
            out: &root,
            images: &piece.images,
        };
        let name = format!("{}-{profile}-{}-{}", scene.name, std::process::id(), piece.number);
        let job_path = self.work.job(&name);
        json::write(&job_path, &job)?;
        let mut command = self.env.command();
        command.arg("render").arg(&job_path);
        self.progress.item(&scene.name);
        let end = worker::run(command, &self.work.log("render", &name), &mut |event| {
            match event {
                WorkerEvent::Image { view, frame } => {
                    self.progress.advance(1);
                    piece.images.retain(|image| !(image.view.as_str() == view && image.frame == *frame));
                }
                WorkerEvent::Warning { message } => self.progress.warn(message),
                WorkerEvent::Start { device } => {
                    tracing::info!(scene = %scene.name, device, "worker started");
                }
                _ => {}
            }
            !self.stop.load(Ordering::Relaxed)
        });
        std::fs::remove_file(&job_path).ok();
        end
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_partition_the_pictures_and_keep_frames_whole() {
        let view = |name: &str| Name::new(name).unwrap();
        let images: Vec<Image> = Profile::Small
            .frames()
            .flat_map(|frame| ["a", "b"].map(|name| Image { frame, view: view(name) }))
            .collect();
        let parts: Vec<Vec<Image>> = (1..=2)
            .map(|index| of_shard(images.clone(), Some(Shard { index, count: 2 }), Profile::Small))
            .collect();
        let mut all: Vec<Image> = parts.concat();
        all.sort();
        assert_eq!(all, images);
        assert!(parts.iter().all(|part| part.len() >= images.len() / 2 - 2 && part.len() % 2 == 0));
    }
}
