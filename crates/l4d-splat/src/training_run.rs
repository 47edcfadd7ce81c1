//! The stage `train-splats`: a 4D model of a scene, learned from the pictures of its training cameras. A killed training
//! goes on from its last checkpoint.

mod folder;
mod input;
mod pictures;
mod report;
#[cfg(test)]
mod stereo_error;

use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use l4d_data::layout::SceneDir;
use l4d_data::results::Track;
use l4d_data::stage::peak_memory_bytes;
use l4d_data::{At as _, Name, Profile, Progress, StageError};
use serde_json::Value;

use self::folder::{Claim, Origin, Spent, SplatsFolder};
use self::input::{HeldOut, Input};
use self::pictures::PictureSource;
use self::report::Report;
use crate::checkpoint::own::Sampling;
use crate::raster::Rasterizer;
use crate::train::{InitialPoints, Quality, Stage, Trainer, measure, read_points};
pub use crate::train::{Preset, Settings};

type Result<T, E = StageError> = std::result::Result<T, E>;

fn plain(error: impl Error) -> StageError {
    StageError::of(&error, "check the scene with `l4d check-scenes`, or train with other settings")
}

/// Held-out pictures that the progress shows the error of.
const GLANCES: usize = 5;

/// What is learned, and how.
pub struct TrainingRequest<'a> {
    pub scene: &'a Name,
    /// Which pictures of it.
    pub profile: Profile,
    /// Where they are.
    pub dir: &'a SceneDir,
    /// Receives the model.
    pub folder: PathBuf,
    /// Of the training.
    pub settings: Settings,
    /// Learn from rendered depth as well as from colour.
    pub sees_depth: bool,
    /// Points of a COLMAP model at which to begin, in place of the surfaces that depth, or comparing pictures, shows.
    pub points: Option<PathBuf>,
    /// Which pictures of a capture are taken, and how small.
    pub sampling: Sampling,
    /// How long what was learned is in memory alone.
    pub between_checkpoints: Duration,
    /// Replace a model that has other settings or pictures.
    pub overwrite: bool,
    /// Set when training is to end early: it saves what it has learned first.
    pub stop: &'a AtomicBool,
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
}

/// A finished training.
#[derive(Debug)]
pub struct Trained {
    /// `manifest.json`.
    pub manifest: Value,
    /// With which methods those are ranked that use the model.
    pub track: Track,
}

impl Trained {
    /// How good the model is and what it took, for a terminal.
    pub fn table(&self) -> String {
        report::table(&self.manifest)
    }
}

/// Trains a model, or finds it trained.
///
/// # Errors
/// Pictures that are not there or not of the profile, a folder that holds another model, and whatever training meets.
pub fn train_scene(request: &TrainingRequest<'_>, progress: &dyn Progress) -> Result<Trained> {
    let begin = Instant::now();
    let source = PictureSource::open(request)?;
    let (init, initial) = match &request.points {
        Some(path) => (path.display().to_string(), InitialPoints::Points(read_points(path)?)),
        None => {
            let surfaces = if request.sees_depth { "depth" } else { "pictures" };
            (surfaces.to_owned(), InitialPoints::Surfaces)
        }
    };
    let settings = Settings {
        depth_weight: if request.sees_depth { request.settings.depth_weight } else { 0.0 },
        // Where depth says where surfaces are, dropout gains nothing.
        dropout: if request.sees_depth { 0.0 } else { request.settings.dropout },
        ..request.settings.clone()
    };
    progress.start("reading", source.picture_count());
    let input = Input::read(request.dir, &source, &|| progress.advance(1))?;
    let held_out = HeldOut::read(request.dir, &source, &|| progress.advance(1))?;
    progress.finish();
    let read_seconds = begin.elapsed().as_secs_f64();

    let origin = Origin {
        scene: request.scene.clone(),
        profile: request.profile,
        settings: serde_json::to_value(&settings).map_err(plain)?,
        init,
        saw_depth: source.sees_depth,
        track: source.track(),
        sampling: source.sampling,
        rasterizer: request.rasterizer.name(),
        adapter: request.adapter.clone(),
        trained_on: input.digests,
        compared_with: held_out.digests.clone(),
    };
    let track = origin.track;
    let folder = SplatsFolder(request.folder.clone());
    let place = folder.0.display();
    let _files = folder.take(request.overwrite)?;
    let claim = folder.claim(&origin, request.overwrite)?;
    if let Claim::Done(manifest) = claim {
        progress.note(&format_args!("{place} holds this model already"));
        return Ok(Trained { manifest, track });
    }

    let begin = Instant::now();
    let mut trainer = Trainer::new(&input.views, settings, &initial, request.rasterizer)
        .map_err(plain)
        .at(request.dir.root().display())?;
    let prepare_seconds = begin.elapsed().as_secs_f64();
    let mut spent = Spent::default();
    if let Claim::Resume(checkpoint) = claim {
        spent = Spent::of(&checkpoint);
        progress.note(&format_args!("{place}: going on after iteration {}", checkpoint.iteration));
        trainer.resume(*checkpoint).map_err(plain).at(place)?;
    }
    let run = Run { request, held_out: &held_out, folder: &folder, origin: &origin, progress };
    let trained = run.train(&mut trainer, spent);
    let spent = trained.at(format_args!("iteration {}", trainer.iteration()))?;

    let begin = Instant::now();
    let pictures = all_pictures(input.views.cameras().len(), input.views.moments());
    let report = Report {
        train: trainer.measure(&pictures).map_err(plain)?,
        test: quality_of(&trainer, &held_out, usize::MAX)?,
        iterations: trainer.iteration(),
        settled: trainer.settled(),
        gaussians: trainer.model().gaussians.len(),
        dynamic: trainer.model().dynamic.len(),
        pictures_bytes: input.views.bytes(),
        peak_memory_bytes: peak_memory_bytes(),
        read_seconds,
        prepare_seconds,
        train_seconds: spent.seconds,
        measure_seconds: begin.elapsed().as_secs_f64(),
        fine: spent.fine,
    };
    let manifest = folder.settle(&trainer, &origin, &report)?;
    Ok(Trained { manifest, track })
}

/// What a training needs while it runs.
struct Run<'a> {
    request: &'a TrainingRequest<'a>,
    held_out: &'a HeldOut,
    folder: &'a SplatsFolder,
    origin: &'a Origin,
    progress: &'a dyn Progress,
}

impl Run<'_> {
    /// Iterates to the end, saving now and then; gives what training took, earlier runs included.
    fn train(&self, trainer: &mut Trainer<'_>, before: Spent) -> Result<Spent> {
        let Self { request, held_out, folder, origin, progress } = *self;
        progress.start("training", trainer.iterations());
        progress.advance(trainer.iteration());
        let begin = Instant::now();
        let (mut saved, mut evaluated, mut at) = (Instant::now(), Instant::now(), trainer.iteration());
        let (mut test, mut fine) = (None, before.fine);
        let spent = |fine| Spent { seconds: before.seconds + begin.elapsed().as_secs_f64(), fine };
        while trainer.stage() != Stage::Done {
            let step = match trainer.stage() {
                Stage::Fine => fine.spend(|| trainer.step()),
                _ => trainer.step(),
            };
            let report = step.map_err(plain)?;
            progress.advance(1);
            if let Some(quality) = report.quality {
                let ms = evaluated.elapsed().as_secs_f64() * 1e3 / (trainer.iteration() - at).max(1) as f64;
                test = quality_of(trainer, held_out, GLANCES)?.or(test);
                let line = status(trainer, report.stage, &quality, test.as_ref(), ms);
                progress.item(&line);
                progress.note(&format_args!("{}/{} {line}", trainer.iteration(), trainer.iterations()));
                (evaluated, at) = (Instant::now(), trainer.iteration());
            }
            let is_stopped = request.stop.load(Ordering::Relaxed);
            if is_stopped || saved.elapsed() >= request.between_checkpoints {
                folder.save(trainer, origin, spent(fine))?;
                saved = Instant::now();
            }
            if is_stopped {
                let message = "stopped; what was learned until here is saved";
                return Err(StageError::new(message, "run the same command again: it goes on from there"));
            }
        }
        progress.finish();
        Ok(spent(fine))
    }
}

fn status(trainer: &Trainer<'_>, stage: Stage, quality: &Quality, test: Option<&Quality>, ms: f64) -> String {
    let stage = match stage {
        Stage::Coarse => "coarse",
        Stage::Unfold { .. } => "unfolding",
        Stage::Fine | Stage::Done => "fine",
    };
    let test = test.map_or_else(String::new, |test| format!(", test {:.2}", test.psnr_db));
    let count = trainer.model().gaussians.len();
    format!("{stage}, {count} Gaussians, PSNR train {:.2}{test} dB, {ms:.0} ms", quality.psnr_db)
}

/// Errors on so many held-out pictures, spread over the clip; none without a held-out camera.
fn quality_of(trainer: &Trainer<'_>, held_out: &HeldOut, most: usize) -> Result<Option<Quality>> {
    if held_out.views.cameras().is_empty() {
        return Ok(None);
    }
    let moments = held_out.views.moments();
    let count = most.min(moments).max(1);
    let picks: Vec<(usize, usize)> =
        (0..count).map(|pick| (0, pick * (moments - 1) / (count - 1).max(1))).collect();
    let region = |_, moment| held_out.region(moment);
    let quality = measure(trainer.model(), trainer.rasterizer(), &held_out.views, &picks, &region);
    quality.map(Some).map_err(plain)
}

fn all_pictures(cameras: usize, moments: usize) -> Vec<(usize, usize)> {
    (0..cameras).flat_map(|camera| (0..moments).map(move |moment| (camera, moment))).collect()
}
