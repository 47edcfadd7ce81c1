//! Labels: what the closed form says of each Gaussian, and how that changes with time.
//!
//! An answer has few states (there, not there, another referent), each holds a number a Gaussian, and each clip time
//! is in one of them. Between clip times the nearest one counts, of two equally near the earlier.

use serde::{Deserialize, Serialize};

use super::layer::Layer;

/// Blends above this belong to an answer whose Gaussians are labelled 0 or 1.
pub(super) const HALF: f32 = 0.5;

/// How labels become a mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cut {
    /// Gaussians above the threshold are 1, the others 0; pixels are cut at one half of that blend.
    #[default]
    Gaussians,
    /// The numbers are blended as they are, and pixels are cut at the threshold.
    Pixels,
}

/// Labels of all Gaussians over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// Clip times, ascending, 0 to 1.
    pub times: Vec<f32>,
    /// The state of each clip time: an index into `states`.
    pub state_of: Vec<u32>,
    /// For each state a number a Gaussian, 0 (not part of the answer) to 1.
    pub states: Vec<Vec<f32>>,
    /// Where to cut.
    pub threshold: f32,
    /// What is cut there.
    pub cut: Cut,
}

impl Labels {
    /// The numbers that hold at a time.
    pub fn at(&self, time: f32) -> &[f32] {
        let away = |other: f32| (other - time).abs();
        let nearest =
            (0..self.times.len()).min_by(|&a, &b| away(self.times[a]).total_cmp(&away(self.times[b])));
        let state = nearest.and_then(|nearest| self.state_of.get(nearest));
        state.and_then(|&state| self.states.get(state as usize)).map_or(&[], Vec::as_slice)
    }

    pub(super) fn layer(&self, time: f32) -> Layer {
        let numbers = self.at(time);
        let members: Vec<bool> = numbers.iter().map(|&number| number > self.threshold).collect();
        match self.cut {
            Cut::Gaussians => {
                let values = members.iter().map(|&member| f32::from(u8::from(member))).collect();
                Layer { values, cut: HALF, members }
            }
            Cut::Pixels => Layer { values: numbers.to_vec(), cut: self.threshold, members },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(cut: Cut) -> Labels {
        Labels {
            times: vec![0.0, 0.5, 1.0],
            state_of: vec![0, 0, 1],
            states: vec![vec![0.9, 0.2, 0.4], vec![0.0; 3]],
            threshold: 0.3,
            cut,
        }
    }

    #[test]
    fn the_nearest_clip_time_counts_and_of_two_the_earlier() {
        let labels = labels(Cut::Gaussians);
        assert_eq!(labels.at(0.74), labels.states[0]);
        assert_eq!(labels.at(0.75), labels.states[0]);
        assert_eq!(labels.at(0.76), labels.states[1]);
    }

    #[test]
    fn a_layer_is_cut_by_gaussian_or_by_pixel() {
        let hard = labels(Cut::Gaussians).layer(0.0);
        assert_eq!((hard.values, hard.cut), (vec![1.0, 0.0, 1.0], 0.5));
        let soft = labels(Cut::Pixels).layer(0.0);
        assert_eq!((soft.values, soft.cut), (vec![0.9, 0.2, 0.4], 0.3));
        assert_eq!(hard.members, [true, false, true]);
        assert_eq!(soft.members, hard.members);
    }
}
