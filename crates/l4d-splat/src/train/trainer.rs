//! The training loop. Each iteration depends on nothing but settings, pictures and the state before it, so that
//! training resumes from a checkpoint as if it had never stopped. Writes no files.

mod density_control;
mod dropout;
mod step;
mod targets;

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::checkpoint::own::Checkpoint;
use crate::deform::{DeformationField, FieldGradients, Init, Trace};
use crate::model::Model;
use crate::raster::Rasterizer;

use super::TrainError;
use super::crop::ChangedRegion;
use super::initial_points::InitialPoints;
use super::loss::Weights;
use super::missing::missing_points;
use super::motion::{Motion, SurfaceKind};
use super::points::{Point, gaussians};
use super::quality::{Quality, Region, measure};
use super::scene_stats::{bounds, busiest, typical_depth_m};
use super::settings::{Rates, Schedule, Settings, Stage};
use super::state::State;
use super::time_span::{Span, repeat_ends};
use super::views::{TrainingViews, TrainingViewsError};

/// Iterations between evaluations on training pictures.
const EVALUATION_PERIOD: u64 = 500;
const EVALUATION_PICTURES: usize = 12;
/// A smaller gain of PSNR counts as no progress, dB.
const PROGRESS_DB: f32 = 0.03;
/// Share of the most Gaussians with which training begins; the rest is for density control.
const INITIAL_SHARE: f32 = 0.75;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Report {
    pub(crate) iteration: u64,
    pub(crate) stage: Stage,
    pub(crate) loss: f64,
    /// Errors on training pictures, every [`EVALUATION_PERIOD`] iterations.
    pub(crate) quality: Option<Quality>,
}

/// The state of training between two iterations, with everything that an iteration needs.
pub(crate) struct Trainer<'a> {
    views: &'a TrainingViews,
    rasterizer: &'a dyn Rasterizer,
    settings: Settings,
    motion: Motion,
    /// Pixels that change, by camera and moment; none where nothing does.
    regions: Vec<Option<ChangedRegion>>,
    /// The moment at which unfolding begins.
    anchor: usize,
    /// Moving points, which are added when the fine stage begins.
    movers: Vec<Point>,
    /// Centre of the cameras in the world, metres.
    middle: [f64; 3],
    /// Gaussians farther than this from `middle` are the backdrop and are not trained, metres.
    backdrop_m: f32,
    schedule: Schedule,
    /// Of the coarse stage, and of the fine one with unfolding.
    rates: [Rates; 2],
    weights: Weights,
    state: State,
    trace: Trace,
    /// Gradients of the deformation field, kept to reuse the memory.
    by_field: Option<FieldGradients>,
}

impl<'a> Trainer<'a> {
    /// Training before its first iteration.
    pub(crate) fn new(
        views: &'a TrainingViews,
        settings: Settings,
        initial: &InitialPoints,
        rasterizer: &'a dyn Rasterizer,
    ) -> Result<Self, TrainError> {
        check(views, &settings)?;
        let motion = Motion::of(views, settings.dynamic_threshold);
        let anchor = busiest(views, &motion);
        let beginning = match initial {
            InitialPoints::Surfaces => (settings.gaussians as f32 * INITIAL_SHARE) as usize,
            InitialPoints::Points(_) => settings.gaussians,
        };
        let (points, backdrop_m) = initial.points(views, &motion, anchor, beginning.max(1));
        if points.is_empty() {
            let message = "nothing tells how far away things are: no two cameras see the same from different places; \
                           start from the points of a COLMAP model";
            return Err(TrainError::Invalid(message.to_owned()));
        }
        let (movers, backgrounds): (Vec<Point>, Vec<Point>) =
            points.into_iter().partition(|point| point.kind == SurfaceKind::Moving);
        let extent_m = views.extent_m();
        let reach = Span::reach(anchor, views.moments());
        let schedule = Schedule::new(&settings, reach);
        let rates = [
            settings.rates(extent_m, schedule.fine_start())?,
            settings.rates(extent_m, schedule.end() - schedule.fine_start())?,
        ];
        let model = Model { gaussians: gaussians(&backgrounds, settings.degree()), ..Model::default() };
        let moves = backgrounds.iter().map(|point| point.kind == SurfaceKind::Flickering).collect();
        let regions = (0..views.cameras().len() * views.moments())
            .into_par_iter()
            .map(|index| (index / views.moments(), index % views.moments()))
            .map(|(camera, moment)| ChangedRegion::of_changes(views, &motion, camera, moment))
            .collect();
        Ok(Self {
            weights: Weights {
                depth: if views.has_depth() { settings.depth_weight } else { 0.0 },
                typical_depth_m: typical_depth_m(views),
            },
            state: State::new(model, moves, &rates[0]),
            trace: Trace::default(),
            by_field: None,
            views,
            rasterizer,
            settings,
            motion,
            regions,
            anchor,
            movers,
            middle: views.middle(),
            // Slightly less because of rounding; no other Gaussian is nearly as far.
            backdrop_m: 0.99 * backdrop_m,
            schedule,
            rates,
        })
    }

    /// Continues from a checkpoint. Pictures, settings and initial points have to be those that it was made with.
    pub(crate) fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), TrainError> {
        let fine = checkpoint.iteration > self.schedule.fine_start();
        self.state = State::restored(checkpoint, &self.rates[usize::from(fine)])?;
        self.by_field = None;
        Ok(())
    }

    /// Model and state; the caller adds scene and inputs.
    pub(crate) fn checkpoint(&self) -> Checkpoint {
        self.state.checkpoint()
    }

    pub(crate) fn model(&self) -> &Model {
        &self.state.model
    }

    pub(crate) fn rasterizer(&self) -> &'a dyn Rasterizer {
        self.rasterizer
    }

    pub(crate) fn iteration(&self) -> u64 {
        self.state.iteration
    }

    /// Number of iterations in all, unless training settles earlier.
    pub(crate) fn iterations(&self) -> u64 {
        self.schedule.end()
    }

    pub(crate) fn stage(&self) -> Stage {
        if self.state.settled { Stage::Done } else { self.schedule.at(self.state.iteration) }
    }

    /// Whether training stopped early for lack of progress.
    pub(crate) fn settled(&self) -> bool {
        self.state.settled
    }

    pub(crate) fn step(&mut self) -> Result<Report, TrainError> {
        // Within the pool from the start: each of its many short parallel parts would otherwise wake it anew.
        rayon::scope(|_| self.iterate())
    }

    fn iterate(&mut self) -> Result<Report, TrainError> {
        let iteration = self.state.iteration;
        let stage = self.stage();
        if iteration == self.schedule.fine_start() {
            self.begin_fine()?;
        }
        if iteration == self.schedule.whole_start() && stage == Stage::Fine {
            self.fill_holes()?;
        }
        let mut random = ChaCha8Rng::seed_from_u64(self.settings.seed);
        // A stream for each iteration, so that a checkpoint needs no state of the generator but the iteration.
        random.set_stream(iteration);
        let loss = match stage {
            Stage::Coarse => self.background_step(&mut random)?,
            Stage::Unfold { reach } => {
                let span = Span::around(self.anchor, reach, self.views.moments());
                let begins = (iteration - self.schedule.fine_start()).is_multiple_of(self.settings.unfold);
                if let Some(field) = self.state.model.field.as_mut().filter(|_| begins && reach > 0) {
                    let inner = Span::around(self.anchor, reach - 1, self.views.moments());
                    repeat_ends(field, self.views.time(inner.first), self.views.time(inner.last));
                }
                self.clip_step(span, true, &mut random)?
            }
            Stage::Fine => {
                let span = Span { first: 0, last: self.views.moments() - 1 };
                self.clip_step(span, false, &mut random)?
            }
            Stage::Done => return Ok(Report { iteration, stage, loss: 0.0, quality: None }),
        };
        self.state.iteration += 1;
        self.densify(stage, &mut random);
        let quality = if self.state.iteration.is_multiple_of(EVALUATION_PERIOD) {
            Some(self.evaluate(stage)?)
        } else {
            None
        };
        Ok(Report { iteration, stage, loss, quality })
    }

    /// Adds the moving points as Gaussians, and the deformation field if anything is dynamic.
    fn begin_fine(&mut self) -> Result<(), TrainError> {
        let movers = std::mem::take(&mut self.movers);
        let mut model = std::mem::take(&mut self.state.model);
        let mut moves = std::mem::take(&mut self.state.moves);
        model.gaussians.append(gaussians(&movers, self.settings.degree()));
        moves.resize(model.gaussians.len(), true);
        let iteration = self.state.iteration;
        let history = std::mem::take(&mut self.state.history);
        self.state = State { iteration, history, ..State::new(model, moves, &self.rates[1]) };
        let dynamic = self.state.dynamic();
        if !dynamic.is_empty() {
            let model = &mut self.state.model;
            let config = self.settings.field(self.views.moments());
            let bounds = bounds(&model.gaussians, &dynamic)?;
            model.field = Some(DeformationField::new(config, bounds, Init::Identity, self.settings.seed)?);
            model.dynamic = dynamic;
            self.state.add_field(&self.rates[1]);
        }
        self.movers = movers;
        Ok(())
    }

    /// Adds Gaussians for moving surfaces that unfolding did not reach from its first moment.
    fn fill_holes(&mut self) -> Result<(), TrainError> {
        let room = self.settings.gaussians.saturating_sub(self.state.model.gaussians.len());
        if self.state.model.field.is_none() || room == 0 {
            return Ok(());
        }
        let most = room.min(self.most_filled());
        let points = missing_points(&self.state.model, self.rasterizer, self.views, &self.motion, most)?;
        let count = self.state.model.gaussians.len();
        self.state.model.gaussians.append(gaussians(&points, self.settings.degree()));
        self.state.moves.resize(count + points.len(), true);
        self.state.follow_more(count);
        Ok(())
    }

    /// Measures training pictures spread over cameras and clip; settles training if the fine stage makes no progress.
    fn evaluate(&mut self, stage: Stage) -> Result<Quality, TrainError> {
        let (cameras, moments) = (self.views.cameras().len(), self.views.moments());
        let picks: Vec<(usize, usize)> = (0..EVALUATION_PICTURES)
            .map(|pick| (pick * 5 % cameras, pick * moments.saturating_sub(1) / (EVALUATION_PICTURES - 1)))
            .collect();
        let quality = self.measure(&picks)?;
        self.state.history.push(quality.psnr_db as f32);
        let patience = self.settings.patience;
        if stage == Stage::Fine && patience > 0 {
            let fine: usize =
                ((self.state.iteration - self.schedule.whole_start()) / EVALUATION_PERIOD) as usize;
            let (before, recent) =
                self.state.history.split_at(self.state.history.len().saturating_sub(patience));
            let best = |list: &[f32]| list.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            self.state.settled = fine > patience && best(recent) < best(before) + PROGRESS_DB;
        }
        Ok(quality)
    }

    /// Errors of the current model on training pictures `(camera, moment)`.
    pub(crate) fn measure(&self, picks: &[(usize, usize)]) -> Result<Quality, TrainError> {
        let region = |camera, moment| {
            let moving: Vec<bool> = (0..self.views.pixel_count())
                .map(|pixel| self.motion.moves(self.views, camera, moment, pixel))
                .collect();
            Region { depth: moving.clone(), moving, structure: false }
        };
        measure(&self.state.model, self.rasterizer, self.views, picks, &region)
    }
}

fn check(views: &TrainingViews, settings: &Settings) -> Result<(), TrainError> {
    if views.cameras().is_empty() {
        return Err(TrainingViewsError::nothing("cameras", "train on at least one").into());
    }
    let ranges = [
        ("gaussians", settings.gaussians as f64, 1.0..=1e7, "between 1 and 10 million"),
        ("sh_degree", f64::from(settings.sh_degree), 0.0..=3.0, "between 0 and 3"),
        ("dynamic_threshold", f64::from(settings.dynamic_threshold), 0.0..=1e6, "at least 0"),
        ("views", settings.views as f64, 1.0..=1e3, "between 1 and 1000"),
        ("depth_weight", f64::from(settings.depth_weight), 0.0..=1e3, "between 0 and 1000"),
    ];
    match ranges.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
        Some((setting, value, _, range)) => {
            Err(TrainError::Invalid(format!("setting `{setting}` is {value}: must be {range}")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
