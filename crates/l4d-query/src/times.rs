//! A set of canonical frames: when something holds.

use std::ops::{BitAnd, BitOr};

use l4d_data::Interval;
use l4d_data::timeline::FRAME_COUNT;

/// Canonical frames, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Times(u128);

impl Times {
    pub const NEVER: Self = Self(0);
    /// In the whole clip.
    pub const ALWAYS: Self = Self((1 << FRAME_COUNT) - 1);

    /// The frames at which `test` holds.
    pub fn when(test: impl FnMut(u32) -> bool) -> Self {
        let mut test = test;
        Self((0..FRAME_COUNT).filter(|&frame| test(frame)).fold(0, |bits, frame| bits | 1 << frame))
    }

    /// The whole clip or nothing.
    pub fn constant(holds: bool) -> Self {
        if holds { Self::ALWAYS } else { Self::NEVER }
    }

    /// The frames of an interval.
    pub fn of(interval: Interval) -> Self {
        Self::when(|frame| interval.contains(frame))
    }

    /// Whether it holds at a frame.
    pub fn at(self, frame: u32) -> bool {
        self.0 >> frame & 1 == 1
    }

    /// The first frame.
    pub fn first(self) -> Option<u32> {
        self.any().then(|| self.0.trailing_zeros())
    }

    /// The last frame.
    pub fn last(self) -> Option<u32> {
        self.any().then(|| u128::BITS - 1 - self.0.leading_zeros())
    }

    /// Whether it ever holds.
    pub fn any(self) -> bool {
        self != Self::NEVER
    }

    /// Whether it always holds.
    pub fn all(self) -> bool {
        self == Self::ALWAYS
    }

    /// Number of frames.
    pub fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// The other frames of the clip.
    pub fn complement(self) -> Self {
        Self(!self.0 & Self::ALWAYS.0)
    }

    /// Frames, ascending.
    pub fn frames(self) -> impl Iterator<Item = u32> + Clone {
        (0..FRAME_COUNT).filter(move |&frame| self.at(frame))
    }

    /// The runs of consecutive frames, ascending.
    pub fn intervals(self) -> Vec<Interval> {
        let mut intervals: Vec<[u32; 2]> = Vec::new();
        for frame in self.frames() {
            match intervals.last_mut() {
                Some([_, last]) if *last + 1 == frame => *last = frame,
                _ => intervals.push([frame, frame]),
            }
        }
        intervals.into_iter().filter_map(|bounds| Interval::try_from(bounds).ok()).collect()
    }

    /// The frames within `reach` of a frame at which it begins or ends to hold.
    pub fn near_edges(self, reach: u32) -> Self {
        let changes: Vec<u32> =
            (1..FRAME_COUNT).filter(|&frame| self.at(frame) != self.at(frame - 1)).collect();
        Self::when(|frame| changes.iter().any(|&edge| edge <= frame + reach && frame < edge + reach))
    }
}

impl BitAnd for Times {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Times {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// When at least one of them holds.
pub fn any_of(times: impl IntoIterator<Item = Times>) -> Times {
    times.into_iter().fold(Times::NEVER, BitOr::bitor)
}

/// When all of them hold.
pub fn all_of(times: impl IntoIterator<Item = Times>) -> Times {
    times.into_iter().fold(Times::ALWAYS, BitAnd::bitand)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(first: u32, last: u32) -> Interval {
        Interval::new(first, last).unwrap()
    }

    #[test]
    fn runs_and_complements() {
        let times = Times::of(interval(0, 20)) | Times::of(interval(40, 96));
        assert_eq!(times.intervals(), [interval(0, 20), interval(40, 96)]);
        assert_eq!(times.complement().intervals(), [interval(21, 39)]);
        assert_eq!(times.count() + times.complement().count(), FRAME_COUNT);
        assert!(Times::ALWAYS.all() && !Times::NEVER.any());
        assert_eq!((times.first(), times.last()), (Some(0), Some(96)));
        assert_eq!((Times::of(interval(7, 9)).first(), Times::NEVER.last()), (Some(7), None));
    }

    #[test]
    fn edges_are_inside_the_clip() {
        let times = Times::of(interval(10, 20));
        assert_eq!(times.near_edges(3).intervals(), [interval(7, 12), interval(18, 23)]);
        assert!(!Times::ALWAYS.near_edges(3).any());
    }
}
