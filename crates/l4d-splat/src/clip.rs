//! A model seen from several places at several times: its state is computed once a time, for all views of it.
//!
//! Owns the order of that work. Refuses to know where cameras come from and what becomes of the drawings.

use l4d_data::StageError;
use rayon::prelude::*;

use crate::model::{Model, ModelError};
use crate::raster::{Drawing, RasterError, RasterSettings, Rasterizer};
use crate::view::View;

/// A time and what is drawn at it; `Key` says which picture is which.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeViews<Key> {
    /// From 0 (start of the clip) to 1 (its end).
    pub time: f32,
    pub views: Vec<(Key, View)>,
}

/// Why a clip was not drawn.
#[derive(Debug, thiserror::Error)]
pub enum ClipError {
    /// The model has no state at this time.
    #[error("time {time}")]
    Model {
        /// From 0 to 1.
        time: f32,
        /// What is wrong.
        source: ModelError,
    },
    /// The rasterizer gave up.
    #[error("time {time}")]
    Raster {
        /// From 0 to 1.
        time: f32,
        /// What is wrong.
        source: RasterError,
    },
}

impl From<ClipError> for StageError {
    fn from(error: ClipError) -> Self {
        Self::of(&error, "take another checkpoint or train the scene again")
    }
}

/// Draws all views of all moments, moment after moment, and hands each drawing to `deliver`, which several threads
/// call at once, in any order within a moment. The first error ends it.
///
/// # Errors
/// A model without a state at one of the times, a rasterizer that fails, and what `deliver` refuses.
pub fn draw<Key: Sync, E: From<ClipError> + Send>(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    settings: &RasterSettings,
    moments: &[TimeViews<Key>],
    deliver: impl Fn(&Key, Drawing) -> Result<(), E> + Sync,
) -> Result<(), E> {
    for TimeViews { time, views } in moments.iter().filter(|moment| !moment.views.is_empty()) {
        let time = *time;
        let splats = model.at(time).map_err(|source| ClipError::Model { time, source })?;
        views.par_iter().try_for_each(|(key, view)| {
            let drawing = rasterizer.prepare(&splats, view, settings).and_then(|projected| projected.draw());
            deliver(key, drawing.map_err(|source| ClipError::Raster { time, source })?)
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::raster::Cpu;
    use crate::synthetic::Room;

    #[test]
    fn every_picture_is_that_of_its_time_and_view() {
        let room = Room::small(5);
        let (model, views) = (room.model().unwrap(), room.views([32, 24]).unwrap());
        let settings = RasterSettings::default();
        let moments: Vec<TimeViews<(usize, usize)>> = [0.0, 0.5, 1.0]
            .into_iter()
            .enumerate()
            .map(|(at, time)| TimeViews {
                time,
                views: views.iter().take(2).enumerate().map(|(view, seen)| ((at, view), *seen)).collect(),
            })
            .collect();
        let drawn = Mutex::new(Vec::new());
        let keep = |key: &(usize, usize), drawing: Drawing| {
            drawn.lock().unwrap().push((*key, drawing));
            Ok::<(), ClipError>(())
        };
        draw(&model, &Cpu::new(), &settings, &moments, keep).unwrap();
        let drawn = drawn.into_inner().unwrap();
        assert_eq!(drawn.len(), 6);
        for ((at, view), drawing) in &drawn {
            let splats = model.at(moments[*at].time).unwrap();
            let cpu = Cpu::new();
            let alone = cpu.prepare(&splats, &views[*view], &settings).unwrap().draw().unwrap();
            assert_eq!(*drawing, alone, "moment {at}, view {view}");
        }
        let late = [TimeViews { time: 1.5, views: vec![((0, 0), views[0])] }];
        let error = draw(&model, &Cpu::new(), &settings, &late, |_, _| Ok::<(), ClipError>(())).unwrap_err();
        assert_eq!(error.to_string(), "time 1.5");
    }
}
