//! The one canonical timeline of the synthetic scenes and the profiles that sample it. Captures have timelines of their
//! own, which their cards and their truth state.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::stage::StageError;

/// Frames of a synthetic clip, numbered 0 to 96.
pub const FRAME_COUNT: u32 = 97;
/// Last canonical frame.
pub const LAST_FRAME: u32 = FRAME_COUNT - 1;
/// Frames per second of the canonical timeline.
pub const FPS: f64 = 24.0;
/// Shortest interval in which anything may be declared, so that every profile samples it.
pub const MIN_INTERVAL: u32 = 13;

/// Canonical frames `first..=last`, both inclusive. JSON: `[first, last]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "[u32; 2]", into = "[u32; 2]")]
pub struct Interval {
    first: u32,
    last: u32,
}

/// An interval whose end lies before its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interval [{0}, {1}] ends before it starts")]
pub struct IntervalError(u32, u32);

impl Interval {
    /// The whole canonical clip.
    pub const WHOLE: Self = Self { first: 0, last: LAST_FRAME };

    /// `first..=last`.
    ///
    /// # Errors
    /// An interval that ends before it starts.
    pub fn new(first: u32, last: u32) -> Result<Self, IntervalError> {
        if last < first { Err(IntervalError(first, last)) } else { Ok(Self { first, last }) }
    }

    /// First frame inside.
    pub fn first(self) -> u32 {
        self.first
    }

    /// Last frame inside.
    pub fn last(self) -> u32 {
        self.last
    }

    /// Number of frames inside.
    pub fn frame_count(self) -> u32 {
        self.last - self.first + 1
    }

    /// Whether `frame` lies inside.
    pub fn contains(self, frame: u32) -> bool {
        (self.first..=self.last).contains(&frame)
    }
}

impl TryFrom<[u32; 2]> for Interval {
    type Error = IntervalError;

    fn try_from([first, last]: [u32; 2]) -> Result<Self, IntervalError> {
        Self::new(first, last)
    }
}

impl From<Interval> for [u32; 2] {
    fn from(interval: Interval) -> Self {
        [interval.first, interval.last]
    }
}

/// When the frames of a clip were: its first frame is at time 0, its last at time 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timeline {
    whole: Interval,
    frames_per_second: f64,
}

impl Timeline {
    /// The frames that are asked for, else those of the clip; ascending, each once.
    ///
    /// # Errors
    /// A frame beyond the clip.
    pub fn chosen(self, frames: &[u32], clip: &[u32]) -> Result<Vec<u32>, StageError> {
        let whole = self.whole();
        if let Some(frame) = frames.iter().find(|frame| !whole.contains(**frame)) {
            return Err(StageError::new(
                format!("frame {frame} is beyond the clip"),
                format!("frames are {} to {}", whole.first(), whole.last()),
            ));
        }
        let mut frames = if frames.is_empty() { clip } else { frames }.to_vec();
        frames.sort_unstable();
        frames.dedup();
        Ok(frames)
    }

    /// That of all rendered scenes.
    pub const CANONICAL: Self = Self { whole: Interval::WHOLE, frames_per_second: FPS };

    /// That of a capture whose moments have these numbers. Where the frame rate is unknown, they are
    /// taken to follow as canonical frames do.
    pub fn new(whole: Interval, frames_per_second: Option<f64>) -> Self {
        Self { whole, frames_per_second: frames_per_second.unwrap_or(FPS) }
    }

    /// From the first frame to the last.
    pub fn whole(self) -> Interval {
        self.whole
    }

    /// Frames per second.
    pub fn frames_per_second(self) -> f64 {
        self.frames_per_second
    }

    /// Time of a frame, 0 to 1 over the clip; frames before and after the clip count as its ends.
    pub fn time(self, frame: u32) -> f32 {
        self.share(frame) as f32
    }

    /// Time of a frame since the first one, seconds.
    pub fn seconds(self, frame: u32) -> f64 {
        f64::from(frame.saturating_sub(self.whole.first)) / self.frames_per_second
    }

    /// How long the clip lasts, from its first frame to its last, seconds.
    pub fn duration_s(self) -> f64 {
        self.seconds(self.whole.last)
    }

    /// The canonical frame at the same time of the clip: rules that count canonical frames hold for it.
    pub fn canonical(self, frame: u32) -> u32 {
        (self.share(frame) * f64::from(LAST_FRAME)).round() as u32
    }

    fn share(self, frame: u32) -> f64 {
        let Interval { first, last } = self.whole;
        let inside = frame.clamp(first, last);
        f64::from(inside - first) / f64::from((last - first).max(1))
    }
}

/// Whether a list has one entry for the whole synthetic clip, or one a frame.
pub(crate) fn is_per_clip<T>(list: &[T]) -> bool {
    list.len() == 1 || list.len() == FRAME_COUNT as usize
}

/// How much of a scene is rendered, or that it is not rendered at all. Renderings keep the canonical frame numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Profile {
    /// 128x96, 4+1 views, 9 frames: tests and the quickstart.
    Tiny,
    /// 256x192, 12+1 views, 49 frames: a laptop.
    Small,
    /// 640x480, 16+1 views, 97 frames: the official one.
    Full,
    /// Captures: each scene has its own size, views and timeline, and its truth states them.
    Real,
}

impl Profile {
    /// All profiles of renderings, smallest first.
    pub const ALL: [Self; 3] = [Self::Tiny, Self::Small, Self::Full];

    /// Name as written in paths and files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Tiny => "tiny",
            Self::Small => "small",
            Self::Full => "full",
            Self::Real => "real",
        }
    }

    /// Whether scenes are made for it. All that follows from a profile alone follows from these only.
    pub fn is_rendered(self) -> bool {
        self != Self::Real
    }

    /// Picture width, pixels; 0 for real scenes, whose sizes differ.
    pub fn width(self) -> u32 {
        match self {
            Self::Tiny => 128,
            Self::Small => 256,
            Self::Full => 640,
            Self::Real => 0,
        }
    }

    /// Picture height, pixels; 0 for real scenes, whose sizes differ.
    pub fn height(self) -> u32 {
        self.width() / 4 * 3
    }

    /// Every how many canonical frames one is rendered.
    pub fn stride(self) -> u32 {
        match self {
            Self::Tiny => 12,
            Self::Small => 2,
            Self::Full | Self::Real => 1,
        }
    }

    /// Training views, without the held-out one; 0 for real scenes, whose rigs differ.
    pub fn training_views(self) -> usize {
        match self {
            Self::Tiny => 4,
            Self::Small => 12,
            Self::Full => 16,
            Self::Real => 0,
        }
    }

    /// Canonical numbers of the rendered frames, ascending; none for real scenes.
    pub fn frames(self) -> impl Iterator<Item = u32> + Clone {
        let count = if self.is_rendered() { FRAME_COUNT } else { 0 };
        (0..count).step_by(self.stride() as usize)
    }
}

impl fmt::Display for Profile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.as_str())
    }
}

impl FromStr for Profile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut all = Self::ALL.into_iter().chain([Self::Real]);
        all.find(|profile| profile.as_str() == text)
            .ok_or_else(|| format!("unknown profile `{text}`: use tiny, small or full, or real for captures"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_profile_samples_every_allowed_interval() {
        for profile in Profile::ALL {
            let frames: Vec<u32> = profile.frames().collect();
            assert_eq!((frames[0], frames[frames.len() - 1]), (0, LAST_FRAME), "{profile}");
            for first in 0..=(FRAME_COUNT - MIN_INTERVAL) {
                let interval = Interval::new(first, first + MIN_INTERVAL - 1).unwrap();
                assert!(
                    frames.iter().any(|&frame| interval.contains(frame)),
                    "{profile} misses {interval:?}"
                );
            }
        }
    }

    #[test]
    fn frame_counts_are_those_of_the_contract() {
        let counts = Profile::ALL.map(|profile| profile.frames().count());
        assert_eq!(counts, [9, 49, 97]);
        assert_eq!(Profile::Full.height(), 480);
    }

    #[test]
    fn nothing_of_a_real_scene_follows_from_its_profile() {
        let real: Profile = "real".parse().unwrap();
        assert!(!real.is_rendered() && !Profile::ALL.contains(&real));
        assert_eq!((real.width(), real.height(), real.training_views(), real.frames().count()), (0, 0, 0, 0));
        assert_eq!(serde_json::to_string(&real).unwrap(), "\"real\"");
        assert!("huge".parse::<Profile>().unwrap_err().contains("real for captures"));
    }

    #[test]
    fn a_clip_begins_at_0_and_ends_at_1() {
        let canonical = Timeline::CANONICAL;
        assert_eq!([0, 48, 96, 500].map(|frame| canonical.time(frame)), [0.0, 0.5, 1.0, 1.0]);
        assert_eq!((canonical.seconds(48), canonical.duration_s(), canonical.canonical(7)), (2.0, 4.0, 7));
        let capture = Timeline::new(Interval::new(151, 171).unwrap(), Some(10.0));
        assert_eq!([3, 151, 161, 171, 172].map(|frame| capture.time(frame)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        assert_eq!((capture.seconds(161), capture.canonical(161), capture.canonical(171)), (1.0, 48, 96));
        let picture = Timeline::new(Interval::new(5, 5).unwrap(), None);
        assert_eq!((picture.time(5), picture.duration_s(), picture.frames_per_second()), (0.0, 0.0, FPS));
    }

    #[test]
    fn reversed_intervals_are_refused() {
        assert!(serde_json::from_str::<Interval>("[5, 4]").is_err());
        assert_eq!(serde_json::from_str::<Interval>("[4, 4]").unwrap().frame_count(), 1);
    }
}
