//! Numbers with their uncertainty, or with the reason why there are none.

use std::fmt;

use rand::RngExt as _;
use serde::Serialize;

use super::coefficients::Undefined;
use crate::order::random_of;

/// Draws behind each interval.
pub(super) const DRAWS: usize = 1000;
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

/// `0.93 [0.80, 1.00]`.
impl fmt::Display for Estimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        // No minus before a zero.
        let hundredths = |value: f64| format!("{value:.2}").replace("-0.00", "0.00");
        formatter.pad(&match (self.value, self.interval) {
            (None, _) => "undefined".to_owned(),
            (Some(value), None) => hundredths(value),
            (Some(value), Some([low, high])) => {
                format!("{} [{}, {}]", hundredths(value), hundredths(low), hundredths(high))
            }
        })
    }
}

/// Values of `statistics` over all clusters, with percentile intervals over draws of as many clusters with
/// replacement. `statistics` gets the clusters, each as often as it was drawn.
pub(super) fn bootstrap<const N: usize>(
    clusters: usize,
    seed: u64,
    name: &str,
    statistics: impl Fn(&[usize]) -> [Result<f64, Undefined>; N],
) -> [Estimate; N] {
    let values = statistics(&(0..clusters).collect::<Vec<_>>());
    let mut drawn: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(DRAWS));
    if clusters > 1 {
        let mut random = random_of(&["l4d/bootstrap/1", &seed.to_string(), name]);
        let mut chosen = vec![0; clusters];
        for _ in 0..DRAWS {
            chosen.fill_with(|| random.random_range(0..clusters));
            for (values, value) in drawn.iter_mut().zip(statistics(&chosen)) {
                values.extend(value.ok());
            }
        }
    }
    std::array::from_fn(|which| estimate(values[which], &mut drawn[which], clusters))
}

fn estimate(value: Result<f64, Undefined>, drawn: &mut [f64], clusters: usize) -> Estimate {
    let (interval, undefined) = match value {
        Err(reason) => (None, Some(reason.to_owned())),
        Ok(_) if clusters < 2 => (None, Some("one scene has no spread".to_owned())),
        Ok(_) if (drawn.len() as f64) < LEAST_DEFINED * DRAWS as f64 => {
            (None, Some(format!("undefined in {} of {DRAWS} draws", DRAWS - drawn.len())))
        }
        Ok(_) => {
            drawn.sort_unstable_by(f64::total_cmp);
            (Some([0.025, 0.975].map(|share| quantile(drawn, share))), None)
        }
    };
    Estimate { value: value.ok(), interval, undefined }
}

/// Linear interpolation between order statistics.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (place - below as f64)
}
