//! How fast a group of parameters learns, step by step.

use super::error::OptimiseError;

/// A learning rate that stays, or falls evenly on a logarithmic scale and then stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearningRate {
    first: f64,
    last: f64,
    steps: u64,
}

impl LearningRate {
    /// The same rate at every step.
    ///
    /// # Errors
    /// A rate that is not positive and finite.
    pub fn constant(rate: f64) -> Result<Self, OptimiseError> {
        Self::log_linear(rate, rate, 1)
    }

    /// `first` at step 0, `last` from step `steps` on, a straight line of logarithms between them.
    ///
    /// # Errors
    /// A rate that is not positive and finite; no steps.
    pub fn log_linear(first: f64, last: f64, steps: u64) -> Result<Self, OptimiseError> {
        for value in [first, last] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(OptimiseError::setting("learning rate", value, "positive and finite"));
            }
        }
        if steps == 0 {
            return Err(OptimiseError::setting("steps of a learning rate", 0.0, "at least 1"));
        }
        Ok(Self { first, last, steps })
    }

    /// The rate at a step.
    pub fn at(&self, step: u64) -> f64 {
        let way = step.min(self.steps) as f64 / self.steps as f64;
        // The ends are met exactly, so that a constant rate is constant.
        match way {
            0.0 => self.first,
            1.0 => self.last,
            _ if self.first == self.last => self.first,
            _ => (self.first.ln() * (1.0 - way) + self.last.ln() * way).exp(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_falls_by_the_same_factor_every_step() {
        let rate = LearningRate::log_linear(1.0e-2, 1.0e-4, 4).unwrap();
        let expected = [1.0e-2, 10.0_f64.powf(-2.5), 1.0e-3, 10.0_f64.powf(-3.5), 1.0e-4, 1.0e-4];
        for (step, expected) in expected.into_iter().enumerate() {
            assert!((rate.at(step as u64) / expected - 1.0).abs() < 1.0e-12);
        }
        assert_eq!(rate.at(u64::MAX), 1.0e-4);
        let constant = LearningRate::constant(0.05).unwrap();
        assert_eq!([0, 1, 7].map(|step| constant.at(step)), [0.05; 3]);
    }

    #[test]
    fn rates_without_a_logarithm_are_refused() {
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(LearningRate::constant(rate).is_err());
            assert!(LearningRate::log_linear(1.0, rate, 5).is_err());
        }
        assert!(LearningRate::log_linear(1.0, 0.5, 0).is_err());
    }
}
