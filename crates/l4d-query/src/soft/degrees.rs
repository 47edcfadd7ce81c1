//! A degree for each canonical frame: how far something holds, and when.

use l4d_data::timeline::FRAME_COUNT;

use super::belief::BeliefError;
use super::settings::{BEST_FRAMES, END_FRAMES, WORST_FRAMES};
use crate::reading::{Degree, Truth};
use crate::times::Times;

const FRAMES: usize = FRAME_COUNT as usize;
/// Steeper than this, the logistic function is a step, frames.
const LEAST_JITTER: f64 = 0.01;

/// From 0 to 1 at each canonical frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degrees([f64; FRAMES]);

impl Degrees {
    /// One degree for the whole clip, or one for each frame.
    ///
    /// # Errors
    /// Other counts, and what is not from 0 to 1.
    pub fn new(values: &[f64]) -> Result<Self, BeliefError> {
        if !values.iter().all(|value| (0.0..=1.0).contains(value)) {
            return Err(BeliefError::new("a degree", "is not from 0 to 1", "clamp what is perceived"));
        }
        match values {
            [only] => Ok(Self([*only; FRAMES])),
            _ => values.try_into().map(Self).map_err(|_ignored| {
                let message = format!("has {} frames", values.len());
                BeliefError::new("a list of degrees", message, "give 1, or one for each of 97 frames")
            }),
        }
    }

    /// The degrees.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// The frames in which it rather holds than not.
    pub fn likely(&self) -> Times {
        Times::when(|frame| self.at(frame) > 0.5)
    }

    /// As shares of the largest.
    pub(super) fn relative(self) -> Self {
        let most = self.0.iter().copied().fold(0.0, f64::max);
        if most > 0.0 { Self(self.0.map(|degree| degree / most)) } else { Self([1.0; FRAMES]) }
    }

    /// Probability that it begins at each frame, if it holds at some.
    fn onsets(&self) -> [f64; FRAMES] {
        let mut so_far = 0.0_f64;
        self.0.map(|degree| {
            let more = (degree - so_far).max(0.0);
            so_far = so_far.max(degree);
            more
        })
    }

    fn reversed(&self) -> Self {
        let mut reversed = self.0;
        reversed.reverse();
        Self(reversed)
    }
}

impl From<Times> for Degrees {
    fn from(times: Times) -> Self {
        Self::when(|frame| f64::from(u8::from(times.at(frame))))
    }
}

/// Probability that the second of two moments comes at least `lead` frames after the first.
fn precedes(first: &[f64; FRAMES], second: &[f64; FRAMES], lead: f64, jitter: f64) -> f64 {
    let total = first.iter().sum::<f64>() * second.iter().sum::<f64>();
    if total <= 0.0 {
        return f64::UNKNOWN;
    }
    let possible = |moments: &[f64; FRAMES]| {
        let all = moments.iter().copied().enumerate().filter(|(_, share)| *share > 0.0);
        all.map(|(frame, share)| (frame as f64, share)).collect::<Vec<_>>()
    };
    let (first, second) = (possible(first), possible(second));
    let pairs = first.iter().flat_map(|early| second.iter().map(move |late| (early, late)));
    // Frames are counted, so a difference of exactly `lead` is half a frame beyond the limit.
    let sum: f64 = pairs
        .map(|(early, late)| {
            early.1 * late.1 * logistic(late.0 - early.0 - lead + 0.5, jitter.max(LEAST_JITTER))
        })
        .sum();
    (sum / total).min(1.0)
}

/// How sure it is that a difference is above 0 which is known to a deviation, close to that of a normal error.
pub(super) fn logistic(difference: f64, deviation: f64) -> f64 {
    1.0 / (1.0 + (-1.7 * difference / deviation).exp())
}

impl Degree for f64 {
    const FALSE: Self = 0.0;
    const TRUE: Self = 1.0;
    const UNKNOWN: Self = 0.5;

    fn and(self, other: impl FnOnce() -> Self) -> Self {
        if self > 0.0 { self * other() } else { 0.0 }
    }

    fn or(self, other: Self) -> Self {
        self.max(other)
    }

    fn not(self) -> Self {
        1.0 - self
    }

    fn is_likely(self) -> bool {
        self >= 0.5
    }

    fn is_possible(self) -> bool {
        self > 0.0
    }
}

impl Truth for Degrees {
    type Degree = f64;

    fn constant(degree: f64) -> Self {
        Self([degree; FRAMES])
    }

    fn when(mut test: impl FnMut(u32) -> f64) -> Self {
        let mut frames = 0..FRAME_COUNT;
        Self([(); FRAMES].map(|()| frames.next().map_or(0.0, &mut test)))
    }

    fn at(&self, frame: u32) -> f64 {
        self.0[frame as usize]
    }

    fn at_start(&self) -> f64 {
        mean(&self.0[..END_FRAMES])
    }

    fn at_end(&self) -> f64 {
        mean(&self.0[FRAMES - END_FRAMES..])
    }

    fn ever(&self) -> f64 {
        let mut sorted = self.0;
        sorted.sort_by(|a, b| b.total_cmp(a));
        mean(&sorted[..BEST_FRAMES])
    }

    fn throughout(&self) -> f64 {
        let mut sorted = self.0;
        sorted.sort_by(f64::total_cmp);
        mean(&sorted[..WORST_FRAMES])
    }

    fn and(mut self, other: Self) -> Self {
        self.0.iter_mut().zip(other.0).for_each(|(own, other)| *own *= other);
        self
    }

    fn or(mut self, other: Self) -> Self {
        self.0.iter_mut().zip(other.0).for_each(|(own, other)| *own = own.max(other));
        self
    }

    fn not(self) -> Self {
        Self(self.0.map(|degree| 1.0 - degree))
    }

    fn leads(&self, other: &Self, lead: f64, jitter: f64) -> f64 {
        precedes(&self.onsets(), &other.onsets(), lead, jitter)
    }

    fn outlasts(&self, other: &Self, jitter: f64) -> f64 {
        // Seen from the end of the clip, what ends later comes first.
        precedes(&self.reversed().onsets(), &other.reversed().onsets(), 1.0, jitter)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
