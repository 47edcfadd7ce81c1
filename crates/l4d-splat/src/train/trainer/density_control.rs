//! Which Gaussians there are: input of density control, and what it leaves alone.

use rand_chacha::ChaCha8Rng;

use super::super::densify::{DensityInput, densify};
use super::super::loss::LossGradients;
use super::super::scene_stats::nearest_m;
use super::super::settings::Stage;
use super::super::state::State;
use super::Trainer;
use crate::gaussians::Gaussians;

/// Iterations between changes of the number of Gaussians, and the share of a stage after which there are none.
const RENEWAL: u64 = 100;
const LAST_RENEWAL: f64 = 0.7;
/// Gaussians wider than this are split where they are refined, pixels.
const SPLIT_PX: f32 = 3.0;
/// Gaussians wider than this share of their distance from the nearest camera go.
const WIDEST: f32 = 0.5;

impl Trainer<'_> {
    /// Counts what density control wants to know.
    pub(super) fn note(&mut self, result: &LossGradients, opacities: &[f32]) {
        let stats = &mut self.state.stats;
        for (row, &opacity) in opacities.iter().enumerate() {
            stats.gradient_norms[row] += result.gradient_norms[row];
            stats.seen[row] += result.seen[row];
            stats.peak[row] = stats.peak[row].max(opacity);
        }
    }

    /// Takes the gradients of the backdrop away: what shines through a surface that is not yet filled would make the
    /// backdrop vanish rather than the surface fill.
    pub(super) fn freeze_backdrop(&self, by: &mut Gaussians) {
        let gaussians = &self.state.model.gaussians;
        for row in (0..gaussians.len()).filter(|&row| self.is_backdrop(&gaussians.means[row])) {
            for (list, width) in by.flat_mut().into_iter().zip(gaussians.sh_degree.widths()) {
                list[row * width..][..width].fill(0.0);
            }
        }
    }

    fn is_backdrop(&self, mean: &[f32; 3]) -> bool {
        nearest_m(mean, &[self.middle]) > self.backdrop_m
    }

    /// Gaussians that are kept for what moves while static Gaussians are learned.
    fn reserved(&self) -> usize {
        let later = if self.movers.is_empty() { 0 } else { self.most_filled() };
        self.movers.len() + later
    }

    /// Most Gaussians that are added where points are missing.
    pub(super) fn most_filled(&self) -> usize {
        (self.movers.len() / 2).max(self.settings.gaussians / 20).min(self.settings.gaussians / 5)
    }

    /// Changes the number of Gaussians where the schedule has it.
    pub(super) fn densify(&mut self, stage: Stage, random: &mut ChaCha8Rng) {
        let (start, length, reserved) = match stage {
            Stage::Coarse => (0, self.settings.coarse, self.reserved()),
            Stage::Fine => (self.schedule.whole_start(), self.settings.fine, 0),
            Stage::Unfold { .. } | Stage::Done => return,
        };
        let done = self.state.iteration - start;
        let period = if stage == Stage::Fine { 3 * RENEWAL } else { RENEWAL };
        if !done.is_multiple_of(period) || done as f64 > LAST_RENEWAL * length as f64 {
            return;
        }
        let backdrop: Vec<bool> =
            self.state.model.gaussians.means.iter().map(|mean| self.is_backdrop(mean)).collect();
        let State { model, stats, .. } = &mut self.state;
        let refined = |row: usize| {
            if backdrop[row] { 0.0 } else { stats.gradient_norms[row] / stats.seen[row].max(1.0) }
        };
        let gradient_norm: Vec<f32> = (0..backdrop.len()).map(refined).collect();
        // What was never looked at is not known to be faint.
        let opacity: Vec<f32> = std::iter::zip(&stats.peak, &stats.seen)
            .map(|(&peak, &seen)| if seen > 0.0 { peak } else { 1.0 })
            .collect();
        let cameras: Vec<[f64; 3]> =
            self.views.cameras().iter().map(|camera| camera.view(0).centre()).collect();
        let away_m: Vec<f32> = model.gaussians.means.iter().map(|mean| nearest_m(mean, &cameras)).collect();
        let focal = self.views.cameras()[0].view(0).focal()[0] as f32;
        let widest =
            |(away_m, &backdrop): (&f32, &bool)| if backdrop { f32::INFINITY } else { WIDEST * away_m };
        let widest_m: Vec<f32> = away_m.iter().zip(&backdrop).map(widest).collect();
        let split_m: Vec<f32> = away_m.iter().map(|away_m| SPLIT_PX * away_m / focal).collect();
        let most = self.settings.gaussians.saturating_sub(reserved);
        let input = DensityInput {
            gradient_norm: &gradient_norm,
            opacity: &opacity,
            widest_m: &widest_m,
            split_m: &split_m,
            most,
        };
        let change = densify(&mut model.gaussians, &input, random);
        self.state.follow(&change);
    }
}
