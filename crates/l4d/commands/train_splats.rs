//! `l4d train-splats`: a 4D model of a scene, learned from its training cameras.

mod folder;
mod input;
mod pictures;
mod report;

use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use l4d_data::Progress as _;
use l4d_data::{Benchmark, Name, Workspace};
use l4d_solve::account::peak_memory_bytes;
use l4d_splat::train::{InitialPoints, Quality, Settings, Stage, Trainer, measure, read_points};

use self::folder::{Claim, Origin, SplatsFolder};
use self::input::{HeldOut, Input};
use self::pictures::PictureSource;
use self::report::{Effort, Report};
use crate::cli::splats::{InitArg, TrainSplatsArgs};
use crate::out::{ExitStatus, Printer};
use crate::rasterizer;

/// Held-out pictures that the progress shows the error of.
const GLANCES: usize = 5;

pub(crate) fn run(args: &TrainSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let begin = Instant::now();
    let name = Name::new(&args.scene)?;
    let draw = Benchmark::open(&args.bench).map(|bench| bench.manifest.draw()).unwrap_or_default();
    let space = Workspace::new(args.profile, draw).with_data(args.data.as_deref()).with_work(&args.work);
    let dir = space.scene(&name);
    let source = PictureSource::open(args, &dir)?;
    let settings = settings(args);
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let init = init(args);
    let initial = initial_points(&init)?;
    let work = args.out.clone().unwrap_or_else(|| space.work(&name).splats());

    out.start("reading", source.picture_count());
    let input = Input::read(&dir, &source, &|| out.advance(1))?;
    let held_out = HeldOut::read(&dir, &source, &|| out.advance(1))?;
    out.finish();
    let read_seconds = begin.elapsed().as_secs_f64();

    let origin = Origin {
        scene: name,
        profile: args.profile,
        settings: serde_json::to_value(&settings)?,
        init: init.to_string(),
        saw_depth: source.has_depth,
        track: source.track(),
        sampling: source.sampling,
        rasterizer: opened.rasterizer.name(),
        adapter: opened.adapter,
        trained_on: input.digests,
        compared_with: held_out.digests.clone(),
    };
    let folder = SplatsFolder::new(work);
    let claim = folder.claim(&origin, args.overwrite)?;
    if let Claim::Done(document) = claim {
        out.note(format!("{} holds this model already", folder.root().display()));
        return report::print(&document, origin.track, args.json, out);
    }

    let begin = Instant::now();
    let mut trainer = Trainer::new(&input.views, settings, &initial, opened.rasterizer.as_ref())
        .with_context(|| dir.root().display().to_string())?;
    let prepare_seconds = begin.elapsed().as_secs_f64();
    let mut before_seconds = 0.0;
    if let Claim::Resume(checkpoint) = claim {
        before_seconds = folder::seconds_of(&checkpoint);
        out.note(format!("{}: going on after iteration {}", folder.root().display(), checkpoint.iteration));
        trainer.resume(*checkpoint).with_context(|| folder.root().display().to_string())?;
    }
    let (train_seconds, fine) = train(&mut trainer, &held_out, args, &folder, &origin, before_seconds, out)
        .with_context(|| format!("iteration {}", trainer.iteration()))?;

    let begin = Instant::now();
    let report = Report {
        train: trainer.measure(&all_pictures(trainer_pictures(&input.views)))?,
        test: quality_of(&trainer, &held_out, usize::MAX)?,
        iterations: trainer.iteration(),
        settled: trainer.settled(),
        gaussians: trainer.model().gaussians.len(),
        dynamic: trainer.model().dynamic.len(),
        pictures_bytes: input.views.bytes(),
        peak_memory_bytes: peak_memory_bytes(),
        read_seconds,
        prepare_seconds,
        train_seconds,
        measure_seconds: begin.elapsed().as_secs_f64(),
        fine,
    };
    let document = folder.settle(trainer.model(), &trainer, &origin, &report)?;
    report::print(&document, origin.track, args.json, out)
}

/// Iterates to the end, saving now and then; gives the seconds since training began, those of earlier runs included,
/// and what the iterations on the whole clip took.
fn train(
    trainer: &mut Trainer<'_>,
    held_out: &HeldOut,
    args: &TrainSplatsArgs,
    folder: &SplatsFolder,
    origin: &Origin,
    before_seconds: f64,
    out: &Printer,
) -> Result<(f64, Effort)> {
    out.start("training", trainer.iterations());
    out.advance(trainer.iteration());
    let begin = Instant::now();
    let every = Duration::from_secs_f64(args.checkpoint_seconds.clamp(0.0, 1e6));
    let (mut saved, mut evaluated, mut at) = (Instant::now(), Instant::now(), trainer.iteration());
    let seconds = || before_seconds + begin.elapsed().as_secs_f64();
    let mut test = None;
    let mut fine = Effort::default();
    while trainer.stage() != Stage::Done {
        let report =
            if trainer.stage() == Stage::Fine { fine.spend(|| trainer.step()) } else { trainer.step() }?;
        out.advance(1);
        if let Some(quality) = report.quality {
            let ms = evaluated.elapsed().as_secs_f64() * 1e3 / (trainer.iteration() - at).max(1) as f64;
            test = quality_of(trainer, held_out, GLANCES)?.or(test);
            let line = progress(trainer, report.stage, &quality, test.as_ref(), ms);
            out.item(&line);
            out.note(format!("{}/{} {line}", trainer.iteration(), trainer.iterations()));
            (evaluated, at) = (Instant::now(), trainer.iteration());
        }
        if saved.elapsed() >= every {
            folder.save(trainer, origin, seconds())?;
            saved = Instant::now();
        }
    }
    out.finish();
    Ok((seconds(), fine))
}

fn progress(
    trainer: &Trainer<'_>,
    stage: Stage,
    quality: &Quality,
    test: Option<&Quality>,
    ms: f64,
) -> String {
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
    Ok(Some(measure(trainer.model(), trainer.rasterizer(), &held_out.views, &picks, &region)?))
}

fn trainer_pictures(views: &l4d_splat::train::TrainingViews) -> (usize, usize) {
    (views.cameras().len(), views.moments())
}

fn all_pictures((cameras, moments): (usize, usize)) -> Vec<(usize, usize)> {
    (0..cameras).flat_map(|camera| (0..moments).map(move |moment| (camera, moment))).collect()
}

fn settings(args: &TrainSplatsArgs) -> Settings {
    let default = Settings::of_profile(args.profile);
    Settings {
        seed: args.seed,
        gaussians: args.gaussians.unwrap_or(default.gaussians),
        sh_degree: args.sh_degree.unwrap_or(default.sh_degree),
        dynamic_threshold: args.dynamic_threshold.unwrap_or(default.dynamic_threshold),
        coarse: args.coarse.unwrap_or(default.coarse),
        unfold: args.unfold.unwrap_or(default.unfold),
        fine: args.fine.unwrap_or(default.fine),
        views: args.views_per_iteration.unwrap_or(default.views),
        depth_weight: args.depth_weight.unwrap_or(default.depth_weight),
        dssim_weight: args.dssim_weight.unwrap_or(default.dssim_weight),
        patience: args.patience.unwrap_or(default.patience),
        ..default
    }
}

fn init(args: &TrainSplatsArgs) -> InitArg {
    let usual = || if args.profile.is_rendered() { InitArg::Depth } else { InitArg::Sweep };
    args.init.clone().unwrap_or_else(usual)
}

fn initial_points(init: &InitArg) -> Result<InitialPoints> {
    Ok(match init {
        // TrainingViews without depth is compared.
        InitArg::Depth | InitArg::Sweep => InitialPoints::Depth,
        InitArg::Random => InitialPoints::Random,
        InitArg::Points(path) => InitialPoints::Points(read_points(path)?),
    })
}
