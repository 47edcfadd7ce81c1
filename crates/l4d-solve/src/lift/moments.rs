//! The states of a model at the times of a clip, without colours, worked out once for all answers in a scene.
//!
//! Owns which times are kept, and for how long: as long as the value lives. Refuses to know what states are good for.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use l4d_splat::splats::Splats;

use super::error::LiftError;

/// States of one model. Only the times that were named are kept, so that memory is bounded by the clip.
#[derive(Debug, Default)]
pub struct Moments {
    /// By the bits of the time.
    kept: BTreeMap<u32, OnceLock<Arc<Splats>>>,
}

impl Moments {
    /// Keeps the states at these times, each from when it is first asked for.
    pub fn at(times: impl IntoIterator<Item = f32>) -> Self {
        Self { kept: times.into_iter().map(|time| (time.to_bits(), OnceLock::new())).collect() }
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
        let Some(slot) = self.kept.get(&time.to_bits()) else { return work_out().map(Arc::new) };
        match slot.get() {
            Some(state) => Ok(Arc::clone(state)),
            None => {
                let state = Arc::new(work_out()?);
                Ok(Arc::clone(slot.get_or_init(|| state)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_worked_out_once_and_only_at_times_of_the_clip() {
        let moments = Moments::at([0.0, 0.5]);
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
    fn what_failed_is_tried_again() {
        let moments = Moments::at([0.5]);
        assert!(moments.get(0.5, || Err(LiftError::NoEvidence)).is_err());
        assert!(moments.get(0.5, || Ok(Splats::default())).is_ok());
    }
}
