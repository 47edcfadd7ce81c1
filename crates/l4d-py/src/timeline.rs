//! When: the canonical frames of a profile.

use l4d_data::Profile;
use l4d_data::timeline::{FPS, FRAME_COUNT, LAST_FRAME};
use pyo3::prelude::*;

use crate::error::{Failure, Result};

/// The frames of a profile on the one canonical timeline: 97 frames at 24 a second, numbered 0 to 96.
///
/// A profile (`"tiny"`, `"small"` or `"full"`) renders every `stride`-th of them and keeps their numbers, so that file
/// names, intervals, masks and results of all profiles speak the same numbers.
#[pyclass(frozen, get_all, module = "l4d")]
pub(crate) struct Timeline {
    /// Name of the profile.
    profile: &'static str,
    /// Canonical numbers of the rendered frames, ascending.
    frames: Vec<u32>,
    /// Every how many canonical frames one is rendered.
    stride: u32,
    /// Canonical frames of the whole clip: 97.
    frame_count: u32,
    /// Canonical frames a second: 24.
    fps: f64,
}

impl Timeline {
    /// Refuses captures, which have timelines of their own.
    pub(crate) fn of(profile: Profile) -> Result<Self> {
        if !profile.is_rendered() {
            let hint = "ask the benchmark for the frames of a scene: `Benchmark.clip`";
            return Err(Failure::argument(
                "profile",
                "captures have a timeline each, not that of a profile",
                hint,
            ));
        }
        let (profile, frames, stride) = (profile.as_str(), profile.frames().collect(), profile.stride());
        Ok(Self { profile, frames, stride, frame_count: FRAME_COUNT, fps: FPS })
    }
}

#[pymethods]
impl Timeline {
    #[new]
    fn new(profile: &str) -> Result<Self> {
        Self::of(parse_profile(profile)?)
    }

    /// Seconds from the start of the clip to a canonical frame.
    fn seconds(&self, frame: u32) -> Result<f64> {
        Ok(f64::from(check_frame(frame)?) / FPS)
    }

    /// A canonical frame as a time from 0 (start of the clip) to 1 (its end): what splats take.
    fn unit_time(&self, frame: u32) -> Result<f32> {
        Ok(l4d_splat::model::time_of_frame(check_frame(frame)?))
    }

    fn __repr__(&self) -> String {
        format!("Timeline('{}': {} frames, every {})", self.profile, self.frames.len(), self.stride)
    }
}

pub(crate) fn parse_profile(text: &str) -> Result<Profile> {
    let hint = "choose among tiny, small, full, or real for captures";
    text.parse().map_err(|message: String| Failure::argument("profile", message, hint))
}

/// Refuses a frame outside the canonical clip.
pub(crate) fn check_frame(frame: u32) -> Result<u32> {
    if frame <= LAST_FRAME {
        return Ok(frame);
    }
    let message = format!("{frame} is beyond the clip");
    Err(Failure::argument("frame", message, format!("give a canonical frame, 0 to {LAST_FRAME}")))
}
