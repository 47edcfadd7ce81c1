//! What all answers in a scene share, worked out once: the states of a model at the times of a clip, without colours,
//! and how much each view sees of each Gaussian then.
//!
//! Owns which times are kept, and for how long: as long as the value lives. Refuses to know what they are good for.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use l4d_splat::splats::Splats;
use l4d_splat::view::View;

use super::error::LiftError;

/// States of one model, drawn in one way. Only the times that were named are kept, so that memory is bounded by the clip.
#[derive(Debug, Default)]
pub struct ModelStates {
    /// By the bits of the time.
    kept: BTreeMap<u32, Moment>,
}

/// What is kept of one time.
#[derive(Debug, Default)]
struct Moment {
    state: OnceLock<Arc<Splats>>,
    /// For each Gaussian the sum of its blend weights over all pixels of a view.
    seen: Mutex<Vec<(View, Arc<[f32]>)>>,
}

impl ModelStates {
    /// Keeps the states at these times, each from when it is first asked for.
    pub fn at(times: impl IntoIterator<Item = f32>) -> Self {
        Self { kept: times.into_iter().map(|time| (time.to_bits(), Moment::default())).collect() }
    }

    /// The state at a time: the one that is kept, or what `work_out` gives.
    ///
    /// No lock is held meanwhile: work on the thread pool may come back here on the same thread. Two who ask at once
    /// may both work it out, with the same result.
    pub(super) fn get(
        &self,
        time: f32,
        work_out: impl FnOnce() -> Result<Splats, LiftError>,
    ) -> Result<Arc<Splats>, LiftError> {
        let Some(Moment { state, .. }) = self.kept.get(&time.to_bits()) else {
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

    /// How much a view sees of each Gaussian at a time, if that is known.
    pub(super) fn seen(&self, time: f32, view: &View) -> Option<Arc<[f32]>> {
        let seen = self.kept.get(&time.to_bits())?.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.iter().find(|(from, _)| from == view).map(|(_, seen)| Arc::clone(seen))
    }

    /// Keeps how much a view sees of each Gaussian at a time.
    pub(super) fn keep_seen(&self, time: f32, view: &View, sums: &Arc<[f32]>) {
        if let Some(Moment { seen, .. }) = self.kept.get(&time.to_bits()) {
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
    fn a_state_is_worked_out_once_and_only_at_times_of_the_clip() {
        let moments = ModelStates::at([0.0, 0.5]);
        let count = std::cell::Cell::new(0);
        let ask = |time: f32| {
            moments.get(time, || {
                count.set(count.get() + 1);
                Ok(Splats::default())
            })
        };
        let first = ask(0.5).unwrap();
        assert!(Arc::ptr_eq(&first, &ask(0.5).unwrap()));
        assert_eq!(count.get(), 1);
        ask(0.25).unwrap();
        ask(0.25).unwrap();
        assert_eq!(count.get(), 3);
    }

    #[test]
    fn what_a_view_sees_is_kept_at_times_of_the_clip() {
        let moments = ModelStates::at([0.5]);
        let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        let view = |focal| View::new([8, 6], [focal, focal], [4.0, 3.0], pose).unwrap();
        for (time, focal, value) in [(0.5, 5.0, 1.0), (0.5, 6.0, 2.0), (0.5, 5.0, 3.0), (0.25, 5.0, 4.0)] {
            moments.keep_seen(time, &view(focal), &Arc::from([value]));
        }
        assert_eq!(moments.seen(0.5, &view(5.0)).as_deref(), Some([1.0].as_slice()));
        assert_eq!(moments.seen(0.5, &view(6.0)).as_deref(), Some([2.0].as_slice()));
        assert_eq!(moments.seen(0.5, &view(7.0)), None);
        assert_eq!(moments.seen(0.25, &view(5.0)), None);
    }

    #[test]
    fn what_failed_is_tried_again() {
        let moments = ModelStates::at([0.5]);
        assert!(moments.get(0.5, || Err(LiftError::NoEvidence)).is_err());
        assert!(moments.get(0.5, || Ok(Splats::default())).is_ok());
    }
}
