//! What an iteration learns: what it looks at, what that says, and the steps that follow.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::super::TrainError;
use super::super::loss::{LossGradients, Target, loss_gradients};
use super::super::scene_stats::sample;
use super::super::state::State;
use super::super::time_span::Span;
use super::Trainer;
use super::dropout::Dropout;
use crate::gaussians::Gaussians;
use crate::optimise::{GroupUpdate, PlaneWeights, plane_penalty};
use crate::splats::Splats;

/// Every so many fine iterations look at whole pictures, the others at what changes.
const WHOLE: u64 = 8;
/// Every so many iterations the planes are kept smooth, so many times as strongly.
const SMOOTHING: u64 = 4;
/// Moments of the outer part of the span are looked at this often while the clip unfolds.
const FRONTIER: f64 = 0.6;

impl Trainer<'_> {
    pub(super) fn background_step(&mut self, random: &mut ChaCha8Rng) -> Result<f64, TrainError> {
        let with_background: Vec<usize> = (0..self.views.cameras().len())
            .filter(|&camera| self.motion.background(camera).is_some())
            .collect();
        if with_background.is_empty() || self.state.model.gaussians.is_empty() {
            return Ok(0.0);
        }
        let targets: Vec<Target> = sample(&with_background, self.settings.views, random)
            .into_iter()
            .filter_map(|camera| self.background_target(camera))
            .collect();
        let splats = self.state.model.gaussians.activate()?;
        let result = self.loss_gradients(splats, &targets, None, random)?;
        let mut by_gaussians = result.gradients.through_activation(&self.state.model.gaussians);
        self.freeze_backdrop(&mut by_gaussians);
        self.state.update_gaussians(self.state.iteration, &by_gaussians)?;
        Ok(result.loss)
    }

    pub(super) fn clip_step(
        &mut self,
        span: Span,
        unfolding: bool,
        random: &mut ChaCha8Rng,
    ) -> Result<f64, TrainError> {
        let moment = if unfolding && random.random_bool(FRONTIER) {
            if random.random_bool(0.5) { span.first } else { span.last }
        } else {
            random.random_range(span.first..=span.last)
        };
        let whole = self.state.iteration.is_multiple_of(WHOLE) && !unfolding;
        let targets = self.clip_targets(moment, whole, random)?;
        if targets.is_empty() {
            return Ok(0.0);
        }
        let time = self.views.time(moment);
        let model = &self.state.model;
        let mut raw = model.gaussians.clone();
        if let Some(field) = &model.field {
            let positions: Vec<[f32; 3]> =
                model.dynamic.iter().map(|&row| model.gaussians.means[row as usize]).collect();
            raw.add_rows(&field.trace(&positions, time, &mut self.trace)?, &model.dynamic)?;
        }
        let splats = raw.activate()?;
        // Parts of pictures are about what moves; static Gaussians there have been learned without the noise of one moment.
        let trainable = (!whole && model.field.is_some()).then(|| self.state.moves.clone());
        let result = self.loss_gradients(splats, &targets, trainable.as_deref(), random)?;
        let mut by_gaussians = result.gradients.through_activation(&raw);
        self.freeze_backdrop(&mut by_gaussians);
        let step = self.state.iteration - self.schedule.fine_start();
        let model = &mut self.state.model;
        if let Some(field) = &mut model.field {
            let by_field = self.by_field.get_or_insert_with(|| field.zero_gradients());
            by_field.clear();
            let upstream = by_gaussians.select(&model.dynamic);
            let by_positions = field.backward(&mut self.trace, &upstream, by_field)?;
            for (&row, slope) in model.dynamic.iter().zip(by_positions) {
                for (sum, slope) in by_gaussians.means[row as usize].iter_mut().zip(slope) {
                    *sum += slope;
                }
            }
            if self.state.iteration.is_multiple_of(SMOOTHING) {
                plane_penalty(field, &PlaneWeights::default().times(SMOOTHING as f32), by_field)?;
            }
            let (parameters, gradients) = (field.parameters_mut(), by_field.lists());
            let shares = vec![
                GroupUpdate { parameters: parameters.planes, gradients: gradients.planes },
                GroupUpdate { parameters: parameters.layers, gradients: gradients.layers },
            ];
            self.state.field.step(step, shares)?;
        }
        self.state.update_gaussians(step, &by_gaussians)?;
        Ok(result.loss)
    }

    /// What the targets say to the Gaussians, of which some sit out.
    fn loss_gradients(
        &mut self,
        splats: Splats,
        targets: &[Target],
        trainable: Option<&[bool]>,
        random: &mut ChaCha8Rng,
    ) -> Result<LossGradients, TrainError> {
        let opacities = splats.opacities().to_vec();
        let way = self.state.iteration as f64 / self.schedule.end() as f64;
        let dropout = Dropout::draw(splats.len(), f64::from(self.settings.dropout) * way, random);
        let shown = dropout.applied(splats)?;
        let mut result = loss_gradients(self.rasterizer, &shown, targets, trainable, self.weights)?;
        dropout.backward(&shown, &mut result);
        self.note(&result, &opacities);
        Ok(result)
    }
}

impl State {
    fn update_gaussians(&mut self, step: u64, by: &Gaussians) -> Result<(), TrainError> {
        let lists = self.model.gaussians.flat_mut().into_iter().zip(by.flat());
        let update = |(list, by)| GroupUpdate { parameters: vec![list], gradients: vec![by] };
        Ok(self.splats.step(step, lists.map(update).collect())?)
    }
}
