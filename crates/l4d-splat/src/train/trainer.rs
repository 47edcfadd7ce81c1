//! The loop: one iteration after the other, each a function of the state before it.

mod control;
mod lessons;
mod targets;

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::checkpoint::own::Checkpoint;
use crate::deform::{DeformationField, FieldGradients, Init, Trace};
use crate::model::Model;
use crate::optimise::Rates;
use crate::raster::Rasterizer;

use super::TrainError;
use super::density::append;
use super::footage::{Footage, FootageError};
use super::holes::holes;
use super::learn::Weights;
use super::motion::{Kind, Motion};
use super::points::{Point, gaussians};
use super::quality::{Quality, Region, measure};
use super::settings::{Schedule, Settings, Stage};
use super::start::Start;
use super::state::State;
use super::survey::{bounds, busiest, typical_depth_m};
use super::unfold::{Span, repeat_ends};
use super::window::Part;

/// Iterations between looks at the training pictures.
const LOOK: u64 = 500;
/// Pictures of a look.
const LOOK_PICTURES: usize = 12;
/// Less progress than this is none, dB.
const PROGRESS_DB: f32 = 0.03;
/// Share of the budget with which training begins; density control has the rest.
const BEGINNING: f32 = 0.75;

/// What came of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Which one.
    pub iteration: u64,
    /// What it was about.
    pub stage: Stage,
    /// Its loss.
    pub loss: f64,
    /// Errors on training pictures, at some iterations.
    pub look: Option<Quality>,
}

/// Training, between two iterations.
pub struct Trainer<'a> {
    footage: &'a Footage,
    rasterizer: &'a dyn Rasterizer,
    settings: Settings,
    motion: Motion,
    /// What changes, by shot and moment.
    parts: Vec<Option<Part>>,
    /// The moment from which the clip is unfolded.
    anchor: usize,
    /// What is added when the fine stage begins.
    movers: Vec<Point>,
    /// Between the cameras, world axes, metres.
    middle: [f64; 3],
    /// Gaussians that are so far from there stay as they are, metres.
    backdrop_m: f32,
    schedule: Schedule,
    rates: [Rates; 2],
    weights: Weights,
    state: State,
    trace: Trace,
    by_field: Option<FieldGradients>,
}

impl<'a> Trainer<'a> {
    /// Training from the beginning.
    ///
    /// # Errors
    /// Footage without cameras, settings that cannot be.
    pub fn new(
        footage: &'a Footage,
        settings: Settings,
        start: &Start,
        rasterizer: &'a dyn Rasterizer,
    ) -> Result<Self, TrainError> {
        check(footage, &settings)?;
        let motion = Motion::of(footage, settings.dynamic_threshold);
        let anchor = busiest(footage, &motion);
        let beginning = match start {
            Start::Depth => (settings.gaussians as f32 * BEGINNING) as usize,
            Start::Random | Start::Points(_) => settings.gaussians,
        };
        let mut random = ChaCha8Rng::seed_from_u64(settings.seed);
        random.set_stream(u64::MAX);
        let (points, backdrop_m) = start.points(footage, &motion, anchor, beginning.max(1), &mut random);
        if points.is_empty() {
            return Err(TrainError::NothingToStartFrom);
        }
        let (movers, grounds): (Vec<Point>, Vec<Point>) =
            points.into_iter().partition(|point| point.kind == Kind::Moves);
        let extent_m = footage.extent_m();
        let reach = Span::reach(anchor, footage.moments());
        let schedule = Schedule::new(&settings, reach);
        let rates = [
            settings.rates(extent_m, schedule.fine_start())?,
            settings.rates(extent_m, schedule.end() - schedule.fine_start())?,
        ];
        let model = Model { gaussians: gaussians(&grounds, settings.degree()), ..Model::default() };
        let moves = grounds.iter().map(|point| point.kind == Kind::Flickers).collect();
        let parts = (0..footage.shots().len() * footage.moments())
            .into_par_iter()
            .map(|index| (index / footage.moments(), index % footage.moments()))
            .map(|(shot, moment)| Part::of_change(footage, &motion, shot, moment))
            .collect();
        Ok(Self {
            weights: Weights {
                dssim: settings.dssim_weight,
                depth: if footage.has_depth() { settings.depth_weight } else { 0.0 },
                typical_depth_m: typical_depth_m(footage),
            },
            state: State::new(model, moves, &rates[0]),
            trace: Trace::default(),
            by_field: None,
            footage,
            rasterizer,
            settings,
            motion,
            parts,
            anchor,
            movers,
            middle: footage.middle(),
            // Less, for rounding; nothing else is nearly as far.
            backdrop_m: 0.99 * backdrop_m,
            schedule,
            rates,
        })
    }

    /// The same training, where a checkpoint left it. Everything else has to be what it was then.
    ///
    /// # Errors
    /// A checkpoint that lacks something.
    pub fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), TrainError> {
        let fine = checkpoint.iteration > self.schedule.fine_start();
        self.state = State::restored(checkpoint, &self.rates[usize::from(fine)])?;
        self.by_field = None;
        Ok(())
    }

    /// Model and state; the caller adds what it knows of scene and inputs.
    pub fn checkpoint(&self) -> Checkpoint {
        self.state.checkpoint()
    }

    /// The model as it is.
    pub fn model(&self) -> &Model {
        &self.state.model
    }

    /// What draws.
    pub fn rasterizer(&self) -> &'a dyn Rasterizer {
        self.rasterizer
    }

    /// What moves.
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Iterations done.
    pub fn iteration(&self) -> u64 {
        self.state.iteration
    }

    /// Iterations in all, unless training settles earlier.
    pub fn iterations(&self) -> u64 {
        self.schedule.end()
    }

    /// What comes next.
    pub fn stage(&self) -> Stage {
        if self.state.settled { Stage::Done } else { self.schedule.at(self.state.iteration) }
    }

    /// Whether training ended before its last iteration because it had nothing left to gain.
    pub fn settled(&self) -> bool {
        self.state.settled
    }

    /// One iteration.
    ///
    /// # Errors
    /// Parameters that have diverged; a rasterizer that fails.
    pub fn step(&mut self) -> Result<Report, TrainError> {
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
        // A stream for each iteration: where the generator stands is the number of the iteration.
        random.set_stream(iteration);
        let loss = match stage {
            Stage::Coarse => self.learn_grounds(&mut random)?,
            Stage::Unfold { reach } => {
                let span = Span::around(self.anchor, reach, self.footage.moments());
                let begins = (iteration - self.schedule.fine_start()).is_multiple_of(self.settings.unfold);
                if let Some(field) = self.state.model.field.as_mut().filter(|_| begins && reach > 0) {
                    let inner = Span::around(self.anchor, reach - 1, self.footage.moments());
                    repeat_ends(field, self.footage.time(inner.first), self.footage.time(inner.last));
                }
                self.learn_clip(span, true, &mut random)?
            }
            Stage::Fine => {
                let span = Span { first: 0, last: self.footage.moments() - 1 };
                self.learn_clip(span, false, &mut random)?
            }
            Stage::Done => return Ok(Report { iteration, stage, loss: 0.0, look: None }),
        };
        self.state.iteration += 1;
        self.renew(stage, &mut random)?;
        let look = if self.state.iteration.is_multiple_of(LOOK) { Some(self.look(stage)?) } else { None };
        Ok(Report { iteration, stage, loss, look })
    }

    /// Adds what moves, and the field.
    fn begin_fine(&mut self) -> Result<(), TrainError> {
        let movers = std::mem::take(&mut self.movers);
        let mut model = std::mem::take(&mut self.state.model);
        let mut moves = std::mem::take(&mut self.state.moves);
        append(&mut model.gaussians, gaussians(&movers, self.settings.degree()));
        moves.resize(model.gaussians.len(), true);
        let iteration = self.state.iteration;
        let history = std::mem::take(&mut self.state.history);
        self.state = State { iteration, history, ..State::new(model, moves, &self.rates[1]) };
        let dynamic = self.state.dynamic();
        if !dynamic.is_empty() {
            let model = &mut self.state.model;
            let config = self.settings.field(self.footage.moments());
            let bounds = bounds(&model.gaussians, &dynamic)?;
            model.field = Some(DeformationField::new(config, bounds, Init::StandStill, self.settings.seed)?);
            model.dynamic = dynamic;
            self.state.teach_field(&self.rates[1]);
        }
        self.movers = movers;
        Ok(())
    }

    /// Adds what moves and could not be followed from the first moment.
    fn fill_holes(&mut self) -> Result<(), TrainError> {
        let room = self.settings.gaussians.saturating_sub(self.state.model.gaussians.len());
        if self.state.model.field.is_none() || room == 0 {
            return Ok(());
        }
        let most = room.min(self.most_filled());
        let points = holes(&self.state.model, self.rasterizer, self.footage, &self.motion, most)?;
        let count = self.state.model.gaussians.len();
        append(&mut self.state.model.gaussians, gaussians(&points, self.settings.degree()));
        self.state.moves.resize(count + points.len(), true);
        self.state.follow_more(count)
    }

    /// Looks at training pictures spread over cameras and clip.
    fn look(&mut self, stage: Stage) -> Result<Quality, TrainError> {
        let (shots, moments) = (self.footage.shots().len(), self.footage.moments());
        let picks: Vec<(usize, usize)> = (0..LOOK_PICTURES)
            .map(|pick| (pick * 5 % shots, pick * moments.saturating_sub(1) / (LOOK_PICTURES - 1)))
            .collect();
        let quality = self.measure(&picks)?;
        self.state.history.push(quality.psnr_db as f32);
        let patience = self.settings.patience;
        if stage == Stage::Fine && patience > 0 {
            let fine: usize = ((self.state.iteration - self.schedule.whole_start()) / LOOK) as usize;
            let (before, recent) =
                self.state.history.split_at(self.state.history.len().saturating_sub(patience));
            let best = |list: &[f32]| list.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            self.state.settled = fine > patience && best(recent) < best(before) + PROGRESS_DB;
        }
        Ok(quality)
    }

    /// Errors of the model as it is on training pictures `(shot, moment)`.
    ///
    /// # Errors
    /// As [`measure`].
    pub fn measure(&self, picks: &[(usize, usize)]) -> Result<Quality, TrainError> {
        let region = |shot, moment| {
            let moving: Vec<bool> = (0..self.footage.pixel_count())
                .map(|pixel| self.motion.moves(self.footage, shot, moment, pixel))
                .collect();
            Region { depth: moving.clone(), moving }
        };
        measure(&self.state.model, self.rasterizer, self.footage, picks, &region)
    }
}

fn check(footage: &Footage, settings: &Settings) -> Result<(), TrainError> {
    if footage.shots().is_empty() {
        let remedy = "train on at least one";
        return Err(FootageError::Nothing { what: "cameras", remedy }.into());
    }
    let ranges = [
        ("gaussians", settings.gaussians as f64, 1.0..=1e7, "between 1 and 10 million"),
        ("sh_degree", f64::from(settings.sh_degree), 0.0..=3.0, "between 0 and 3"),
        ("dynamic_threshold", f64::from(settings.dynamic_threshold), 0.0..=1e6, "at least 0"),
        ("views", settings.views as f64, 1.0..=1e3, "between 1 and 1000"),
        ("depth_weight", f64::from(settings.depth_weight), 0.0..=1e3, "between 0 and 1000"),
        ("dssim_weight", f64::from(settings.dssim_weight), 0.0..=1.0, "between 0 and 1"),
    ];
    match ranges.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
        Some((setting, value, _, range)) => Err(TrainError::Setting { setting, value, range }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
