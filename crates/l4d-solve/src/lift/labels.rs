//! Labels: what the closed form says of each Gaussian, and how that changes with time.
//!
//! An answer has few states (there, not there, another referent), each holds a number a Gaussian, and each clip time
//! is in one of them. Between clip times the nearest one counts, of two equally near the earlier.

use super::answer::Layer;

/// Gaussians are blended as 0 or 1; pixels whose blend lies above this belong to the answer.
pub(super) const HALF: f32 = 0.5;

/// Labels of all Gaussians over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Labels {
    /// Clip times, ascending, 0 to 1.
    pub times: Vec<f32>,
    /// The state of each clip time: an index into `states`.
    pub state_of: Vec<u32>,
    /// For each state a number a Gaussian, 0 (not part of the answer) to 1.
    pub states: Vec<Vec<f32>>,
    /// Gaussians above it belong to the answer.
    pub threshold: f32,
}

impl Labels {
    /// The numbers that hold at a time.
    fn at(&self, time: f32) -> &[f32] {
        let away = |other: f32| (other - time).abs();
        let nearest =
            (0..self.times.len()).min_by(|&a, &b| away(self.times[a]).total_cmp(&away(self.times[b])));
        let state = nearest.and_then(|nearest| self.state_of.get(nearest));
        state.and_then(|&state| self.states.get(state as usize)).map_or(&[], Vec::as_slice)
    }

    pub(super) fn layer(&self, time: f32) -> Layer {
        let is_member = |number: &f32| f32::from(u8::from(*number > self.threshold));
        Layer { values: self.at(time).iter().map(is_member).collect(), cut: HALF }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_clip_time_counts_and_of_two_the_earlier() {
        let labels = Labels {
            times: vec![0.0, 0.5, 1.0],
            state_of: vec![0, 0, 1],
            states: vec![vec![0.9, 0.2, 0.4], vec![0.0; 3]],
            threshold: 0.3,
        };
        for (time, state) in [(0.74, 0), (0.75, 0), (0.76, 1)] {
            assert_eq!(labels.at(time), labels.states[state]);
        }
        assert_eq!(labels.layer(0.0).values, [1.0, 0.0, 1.0]);
    }
}
