//! Numbers with their uncertainty, or with the reason why there are none.

use std::fmt;

use rand::RngExt as _;
use serde::Serialize;

use super::coefficients::Undefined;
use crate::order::random_of;

/// Two-sided 95 % of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;
/// An interval needs a value in at least this share of the draws.
const LEAST_DEFINED: f64 = 0.95;

/// A number with a 95 % interval, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// The number; null where it is undefined.
    pub value: Option<f64>,
    /// 95 % interval; null where there is none.
    pub interval: Option<[f64; 2]>,
    /// Why the number, or else the interval, is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undefined: Option<String>,
}

impl fmt::Display for Estimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reason = self.undefined.as_deref().unwrap_or("unknown");
        match (self.value, self.interval) {
            (None, _) => write!(formatter, "undefined ({reason})"),
            (Some(value), None) => write!(formatter, "{value:.3} [undefined: {reason}]"),
            (Some(value), Some([low, high])) => write!(formatter, "{value:.3} [{low:.3}, {high:.3}]"),
        }
    }
}

/// A part of a whole with Wilson's interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Share {
    /// The part.
    pub count: usize,
    /// The whole.
    pub of: usize,
    /// 95 % interval of the share; null of nothing.
    pub interval: Option<[f64; 2]>,
}

impl Share {
    pub(crate) fn new(count: usize, of: usize) -> Self {
        Self { count, of, interval: wilson(count, of) }
    }

    /// The share; none of nothing.
    pub fn rate(&self) -> Option<f64> {
        (self.of > 0).then(|| self.count as f64 / self.of as f64)
    }
}

/// Wilson's 95 % score interval of a share.
pub fn wilson(count: usize, of: usize) -> Option<[f64; 2]> {
    if of == 0 {
        return None;
    }
    let n = of as f64;
    let share = count as f64 / n;
    let centre = share + Z * Z / (2.0 * n);
    let reach = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    Some([((centre - reach) / scale).max(0.0), ((centre + reach) / scale).min(1.0)])
}

/// Values of `statistics` over all clusters, with percentile intervals over draws of as many clusters with
/// replacement. `statistics` gets the clusters to sum, each as often as it was drawn.
pub(super) fn bootstrap<const N: usize>(
    clusters: usize,
    draws: usize,
    seed: u64,
    name: &str,
    mut statistics: impl FnMut(&[usize]) -> [Result<f64, Undefined>; N],
) -> [Estimate; N] {
    let values = statistics(&(0..clusters).collect::<Vec<_>>());
    let mut drawn: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(draws));
    if clusters > 1 {
        let mut random = random_of(&["l4d/bootstrap/1", &seed.to_string(), name]);
        let mut chosen = vec![0; clusters];
        for _ in 0..draws {
            chosen.fill_with(|| random.random_range(0..clusters));
            for (values, value) in drawn.iter_mut().zip(statistics(&chosen)) {
                values.extend(value.ok());
            }
        }
    }
    std::array::from_fn(|which| estimate(values[which], &mut drawn[which], draws, clusters))
}

fn estimate(value: Result<f64, Undefined>, drawn: &mut [f64], draws: usize, clusters: usize) -> Estimate {
    let value = match value {
        Ok(value) => value,
        Err(reason) => {
            return Estimate { value: None, interval: None, undefined: Some(reason.to_string()) };
        }
    };
    let without = |reason: String| Estimate { value: Some(value), interval: None, undefined: Some(reason) };
    if clusters < 2 {
        return without("one scene has no spread".to_owned());
    }
    if (drawn.len() as f64) < LEAST_DEFINED * draws as f64 {
        return without(format!("undefined in {} of {draws} draws", draws - drawn.len()));
    }
    drawn.sort_unstable_by(f64::total_cmp);
    Estimate {
        value: Some(value),
        interval: Some([quantile(drawn, 0.025), quantile(drawn, 0.975)]),
        undefined: None,
    }
}

/// Linear interpolation between order statistics.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64)
}
