//! The model that answers are lifted onto, with the rasterizer that projects it, and a cache that all answers of a
//! scene share.
//!
//! Owns the states of the model at each time, without colours, which lifting does not need. Does not know what an
//! answer is.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use l4d_data::StageError;
use l4d_ground::ViewClip;
use l4d_ground::panoptic::GaussianProjector;
use l4d_splat::gaussians::ShDegree;
use l4d_splat::raster::{Projected, RasterError, RasterSettings, Rasterizer};
use l4d_splat::splats::{SplatParts, Splats};
use l4d_splat::view::View;
use l4d_splat::{Model, model::ModelError};

use super::error::LiftError;

/// A model with the rasterizer that projects it.
#[derive(Clone, Copy)]
pub struct RenderedModel<'a> {
    pub model: &'a Model,
    pub rasterizer: &'a dyn Rasterizer,
    /// Background and quantiles have no effect here.
    pub raster: &'a RasterSettings,
    /// Cache that answers share; none to compute each state anew.
    pub states: Option<&'a ModelStates>,
}

impl RenderedModel<'_> {
    /// The model at a time from 0 to 1.
    ///
    /// # Errors
    /// A time outside the clip, and a model without a state at it.
    pub fn at(&self, time: f32) -> Result<Splats, LiftError> {
        check_time(time)?;
        self.model.at(time).map_err(|source| LiftError::Model { time, source })
    }

    /// The model at a time without its colours, which masks do not depend on: a fifth of the memory.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn shapes_at(&self, time: f32) -> Result<Arc<Splats>, LiftError> {
        let work_out = || {
            let parts = self.at(time)?.into_parts();
            let sh = vec![[0.0; 3]; parts.means.len()];
            Splats::new(SplatParts { sh_degree: ShDegree::ZERO, sh, ..parts })
                .map_err(|source| LiftError::Model { time, source: ModelError::Splat(source) })
        };
        match self.states {
            Some(states) => states.get(time, work_out),
            None => work_out().map(Arc::new),
        }
    }
}

impl GaussianProjector for RenderedModel<'_> {
    fn gather(
        &self,
        clip: &ViewClip,
        frame: u32,
        pixels: &[f32],
        channels: usize,
    ) -> Result<Vec<f32>, StageError> {
        self.with_projected(clip, frame, |projected| projected.gather_features(pixels, channels))
            .map_err(stage_error)
    }

    fn splat(
        &self,
        clip: &ViewClip,
        frame: u32,
        features: &[f32],
        channels: usize,
    ) -> Result<Vec<f32>, StageError> {
        self.with_projected(clip, frame, |projected| projected.splat_features(features, channels))
            .map_err(stage_error)
    }
}

impl RenderedModel<'_> {
    /// Projects the model at a frame into the camera of a clip, and asks the projection for something.
    fn with_projected<T>(
        &self,
        clip: &ViewClip,
        frame: u32,
        ask: impl FnOnce(&dyn Projected) -> Result<T, RasterError>,
    ) -> Result<T, LiftError> {
        let size = [clip.width, clip.height];
        let view = View::of_camera(&clip.camera, frame, size, size)
            .map_err(|source| LiftError::View { view: clip.camera.name.to_string(), source })?;
        let splats = self.shapes_at(clip.timeline.time(frame))?;
        let projected = self.rasterizer.prepare(&splats, &view, self.raster)?;
        Ok(ask(projected.as_ref())?)
    }
}

fn stage_error(error: LiftError) -> StageError {
    StageError::of(&error, "draw the clips again, or train the model again")
}

/// Whether a time lies in the clip.
pub(super) fn check_time(time: f32) -> Result<(), LiftError> {
    if (0.0..=1.0).contains(&time) { Ok(()) } else { Err(LiftError::Time { time }) }
}

/// What the cache has of one time.
#[derive(Debug, Default)]
struct KeptState {
    state: OnceLock<Arc<Splats>>,
    /// For each Gaussian the sum of its blend weights over all pixels of a view.
    seen: Mutex<Vec<(View, Arc<[f32]>)>>,
}

/// Cache of a model's states without colours, and of how much each view sees of each Gaussian in them. Only the times
/// that [`Self::at`] names are kept, so that the clip bounds the memory.
#[derive(Debug, Default)]
pub struct ModelStates {
    /// By the bits of the time (`f32::to_bits`).
    kept: BTreeMap<u32, KeptState>,
}

impl ModelStates {
    /// An empty cache for these times; each state is computed when it is first asked for.
    pub fn at(times: impl IntoIterator<Item = f32>) -> Self {
        Self { kept: times.into_iter().map(|time| (time.to_bits(), KeptState::default())).collect() }
    }

    /// The state at a time: from the cache, else from `work_out`.
    ///
    /// No lock is held while `work_out` runs: the thread pool may run another task that comes here on the same thread,
    /// which would deadlock. Two threads that ask at once may both compute the state, with the same result.
    fn get(
        &self,
        time: f32,
        work_out: impl FnOnce() -> Result<Splats, LiftError>,
    ) -> Result<Arc<Splats>, LiftError> {
        let Some(KeptState { state, .. }) = self.kept.get(&time.to_bits()) else {
            return work_out().map(Arc::new);
        };
        match state.get() {
            Some(state) => Ok(Arc::clone(state)),
            None => {
                let new = Arc::new(work_out()?);
                Ok(Arc::clone(state.get_or_init(|| new)))
            }
        }
    }

    /// For each Gaussian the sum of its blend weights over the pixels of a view at a time, if that is kept.
    pub(super) fn seen(&self, time: f32, view: &View) -> Option<Arc<[f32]>> {
        let seen = self.kept.get(&time.to_bits())?.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.iter().find(|(from, _)| from == view).map(|(_, seen)| Arc::clone(seen))
    }

    /// Keeps these sums, if the time is one of the clip and the view has none yet.
    pub(super) fn keep_seen(&self, time: f32, view: &View, sums: &Arc<[f32]>) {
        if let Some(KeptState { seen, .. }) = self.kept.get(&time.to_bits()) {
            let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
            if seen.iter().all(|(from, _)| from != view) {
                seen.push((*view, Arc::clone(sums)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_computed_once_at_times_of_the_clip_and_again_after_an_error() {
        let states = ModelStates::at([0.0, 0.5]);
        assert!(states.get(0.5, || Err(LiftError::Time { time: 2.0 })).is_err());
        let count = std::cell::Cell::new(0);
        let ask = |time: f32| {
            let work_out = || {
                count.set(count.get() + 1);
                Ok(Splats::default())
            };
            states.get(time, work_out).unwrap()
        };
        assert!(Arc::ptr_eq(&ask(0.5), &ask(0.5)));
        assert_eq!(count.get(), 1);
        assert!(!Arc::ptr_eq(&ask(0.25), &ask(0.25)));
    }

    #[test]
    fn what_a_view_sees_is_kept_at_times_of_the_clip() {
        let states = ModelStates::at([0.5]);
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = |focal| View::new([8, 6], [focal, focal], [4.0, 3.0], pose).unwrap();
        for (time, focal, value) in [(0.5, 5.0, 1.0), (0.5, 6.0, 2.0), (0.5, 5.0, 3.0), (0.25, 5.0, 4.0)] {
            states.keep_seen(time, &view(focal), &Arc::from([value]));
        }
        assert_eq!(states.seen(0.5, &view(5.0)).as_deref(), Some([1.0].as_slice()));
        assert_eq!(states.seen(0.5, &view(6.0)).as_deref(), Some([2.0].as_slice()));
        assert_eq!(states.seen(0.5, &view(7.0)), None);
        assert_eq!(states.seen(0.25, &view(5.0)), None);
    }
}
