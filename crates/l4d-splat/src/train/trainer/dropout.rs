//! Gaussians that sit out an iteration: no few of them are to explain alone what one camera sees (DropGaussian, Park et
//! al. 2025).

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::super::TrainError;
use super::super::loss::LossGradients;
use crate::splats::Splats;

/// Factors of opacities in an iteration: 0 for those that sit out.
pub(super) struct Dropout(Vec<f32>);

impl Dropout {
    /// Each of `count` Gaussians sits out with a probability of `rate`; the others are as much more opaque, so that as much
    /// is filled on average.
    pub(super) fn draw(count: usize, rate: f64, random: &mut ChaCha8Rng) -> Self {
        let kept = (1.0 / (1.0 - rate)) as f32;
        let all = if rate > 0.0 { count } else { 0 };
        Self((0..all).map(|_| if random.random_bool(rate) { 0.0 } else { kept }).collect())
    }

    pub(super) fn applied(&self, splats: Splats) -> Result<Splats, TrainError> {
        if self.0.is_empty() {
            return Ok(splats);
        }
        let mut parts = splats.into_parts();
        for (opacity, factor) in parts.opacities.iter_mut().zip(&self.0) {
            *opacity = (*opacity * factor).min(1.0);
        }
        Ok(Splats::new(parts)?)
    }

    /// From the opacities that were drawn (`shown`) back to those that are learned.
    pub(super) fn backward(&self, shown: &Splats, result: &mut LossGradients) {
        let opacities = &mut result.gradients.by.opacities;
        for ((by, factor), shown) in opacities.iter_mut().zip(&self.0).zip(shown.opacities()) {
            *by *= if *shown < 1.0 { *factor } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;
    use crate::splats::{SplatGradients, SplatParts};

    #[test]
    fn as_much_is_filled_on_average_and_what_sits_out_learns_nothing() {
        let count = 20_000;
        let parts = SplatParts {
            means: vec![[0.0; 3]; count],
            scales: vec![[1.0; 3]; count],
            rotations: vec![[1.0, 0.0, 0.0, 0.0]; count],
            opacities: vec![0.5; count],
            sh: vec![[0.0; 3]; count],
            ..SplatParts::default()
        };
        let splats = Splats::new(parts).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(7);
        assert_eq!(Dropout::draw(count, 0.0, &mut random).applied(splats.clone()).unwrap(), splats);
        let dropout = Dropout::draw(count, 0.2, &mut random);
        let shown = dropout.applied(splats.clone()).unwrap();
        let mean = shown.opacities().iter().map(|opacity| f64::from(*opacity)).sum::<f64>() / count as f64;
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let mut gradients = SplatGradients::zeros(&splats);
        gradients.by.opacities.fill(1.0);
        let mut result = LossGradients { gradients, gradient_norms: Vec::new(), seen: Vec::new(), loss: 0.0 };
        dropout.backward(&shown, &mut result);
        for (by, shown) in result.gradients.by.opacities.iter().zip(shown.opacities()) {
            assert_eq!(*by, if *shown == 0.0 { 0.0 } else { 1.25 });
        }
    }
}
