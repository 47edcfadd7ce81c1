//! How parameters follow from errors: losses and penalties with their gradients, learning rates, and Adam.
//!
//! Everything here is a function of lists of numbers. It refuses to know what the lists mean to a scene, where
//! pictures come from and when training is done. Losses return their value and *add* their gradient, times a weight,
//! to a list that the caller owns, so that terms sum up without copies. A number that is not finite anywhere in the
//! input is an error that names it, and whatever would have been written is then as it was.

mod adam;
mod planes;

use rayon::prelude::*;

pub use adam::{Adam, Group, GroupUpdate, Moments};
pub use planes::{PlaneWeights, plane_penalty};

/// What cannot be computed with: list, index and value, or setting and range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OptimiseError(String);

impl OptimiseError {
    /// A setting outside its range.
    fn setting(setting: &str, value: f64, range: &str) -> Self {
        Self(format!("{setting} is {value}: must be {range}"))
    }
}

const CHUNK: usize = 1 << 14;

/// Every number of `list` is finite and so is its square.
///
/// Loops that may stop early are not turned into vector code, so whole chunks are tested first and the culprit is
/// looked for only in a chunk that has one.
fn check(list: &[f32], name: impl FnOnce() -> String) -> Result<(), OptimiseError> {
    let is_bad = |value: f32| !(value * value).is_finite();
    let has_bad = |chunk: &[f32]| chunk.iter().fold(false, |any, &value| any | is_bad(value));
    let Some(chunk) = list.par_chunks(CHUNK).position_first(has_bad) else { return Ok(()) };
    let inside = list[chunk * CHUNK..].iter().position(|&value| is_bad(value)).unwrap_or_default();
    let index = chunk * CHUNK + inside;
    Err(OptimiseError(format!(
        "{}: value {index} is {}: training has diverged; go back to an earlier checkpoint",
        name(),
        list[index]
    )))
}

/// `list` has the length of what it belongs to.
fn check_length(list: &str, found: usize, expected: usize) -> Result<(), OptimiseError> {
    if found == expected {
        return Ok(());
    }
    Err(OptimiseError(format!("{list} has {found} values, but {expected} belong here")))
}

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

/// Mean of |prediction - target| over all values (any channels, any order), 0 if there are none.
///
/// Adds `weight` times its gradient to `gradient`; where both are equal it is 0.
///
/// # Errors
/// Lists of different lengths, and a value that is not finite.
pub fn l1(
    prediction: &[f32],
    target: &[f32],
    weight: f32,
    gradient: &mut [f32],
) -> Result<f64, OptimiseError> {
    check_length("target", target.len(), prediction.len())?;
    check_length("gradient", gradient.len(), prediction.len())?;
    check(prediction, || "prediction".to_owned())?;
    check(target, || "target".to_owned())?;
    let count = prediction.len().max(1) as f64;
    let step = (f64::from(weight) / count) as f32;
    let mut sum = 0.0;
    for ((prediction, target), gradient) in prediction.iter().zip(target).zip(gradient) {
        let difference = prediction - target;
        sum += f64::from(difference.abs());
        // `signum` of zero is one.
        *gradient += if difference == 0.0 { 0.0 } else { step * difference.signum() };
    }
    Ok(sum / count)
}

/// Depth as the blending of Gaussians gives it.
#[derive(Debug, Clone, Copy)]
pub struct RenderedDepth<'a> {
    /// Sum of depth times blend weight of every pixel, metres; not divided by `alpha`.
    pub sum_m: &'a [f32],
    /// Sum of the blend weights of every pixel, 0 to 1.
    pub alpha: &'a [f32],
}

/// Where gradients are added, laid out as [`RenderedDepth`].
#[derive(Debug)]
pub struct DepthGradient<'a> {
    /// By `sum_m`.
    pub sum: &'a mut [f32],
    /// By `alpha`.
    pub alpha: &'a mut [f32],
}

/// Mean over the pixels that hit something of |sum - alpha * target|, 0 if none does.
///
/// That is the error of the expected depth, sum / alpha, times the coverage: it needs no division, says nothing of
/// what is transparent, and leaves opacity to the colours. Below `knee_m` the absolute value is replaced by a
/// parabola with the same slope at the knee (Huber), so that sub-knee noise doesn't make the sign of the gradient
/// jump; a knee of 0 is plain L1. Outliers beyond it pull with a constant force.
///
/// `target_m` is planar depth, +inf where nothing is hit. Adds `weight` times its gradient to `gradient`.
///
/// # Errors
/// Lists of different lengths, a value that is not finite, and a target that is neither positive nor +inf.
pub fn depth_l1(
    rendered: RenderedDepth<'_>,
    target_m: &[f32],
    knee_m: f32,
    weight: f32,
    gradient: DepthGradient<'_>,
) -> Result<f64, OptimiseError> {
    let RenderedDepth { sum_m, alpha } = rendered;
    for (list, found) in [
        ("alpha", alpha.len()),
        ("target depth", target_m.len()),
        ("gradient of depth", gradient.sum.len()),
        ("gradient of alpha", gradient.alpha.len()),
    ] {
        check_length(list, found, sum_m.len())?;
    }
    check(sum_m, || "depth".to_owned())?;
    check(alpha, || "alpha".to_owned())?;
    let is_depth =
        |depth_m: f32| depth_m > 0.0 && (depth_m * depth_m).is_finite() || depth_m == f32::INFINITY;
    if let Some(index) = target_m.iter().position(|&depth_m| !is_depth(depth_m)) {
        return Err(OptimiseError(format!(
            "target depth: pixel {index} is {} m: must be positive, or infinite where nothing is hit",
            target_m[index]
        )));
    }

    let count = target_m.iter().filter(|depth_m| depth_m.is_finite()).count().max(1) as f64;
    let step = (f64::from(weight) / count) as f32;
    let mut total = 0.0;
    let pixels = sum_m.iter().zip(alpha).zip(target_m).zip(gradient.sum).zip(gradient.alpha);
    for ((((sum_m, alpha), target_m), by_sum), by_alpha) in pixels {
        if target_m.is_finite() {
            let (value, slope) = huber(sum_m - alpha * target_m, knee_m);
            total += f64::from(value);
            *by_sum += step * slope;
            *by_alpha -= step * slope * target_m;
        }
    }
    Ok(total / count)
}

/// The absolute value, rounded off below the knee, and its slope.
fn huber(residual: f32, knee: f32) -> (f32, f32) {
    let size = residual.abs();
    if size < knee {
        (0.5 * residual * residual / knee, residual / knee)
    } else {
        (size - 0.5 * knee, if size == 0.0 { 0.0 } else { residual.signum() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_culprit_is_named_wherever_it_stands() {
        let mut list = vec![1.0; 3 * CHUNK + 7];
        assert_eq!(check(&list, String::new), Ok(()));
        assert_eq!(check(&[], String::new), Ok(()));
        for (index, value) in [(3 * CHUNK + 6, f32::NAN), (CHUNK + 1, f32::NEG_INFINITY), (0, 1.0e20)] {
            list[index] = value;
            let message = check(&list, || "planes".to_owned()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("planes: value {index} is {value}")), "{message}");
        }
    }

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

    #[test]
    fn the_knee_joins_parabola_and_line() {
        assert_eq!(huber(0.25, 0.5), (0.0625, 0.5));
        assert_eq!(huber(-0.5, 0.5), (0.25, -1.0));
        assert_eq!(huber(2.0, 0.5), (1.75, 1.0));
        assert_eq!(huber(-2.0, 0.0), (2.0, -1.0));
        assert_eq!(huber(0.0, 0.0), (0.0, 0.0));
    }
}
