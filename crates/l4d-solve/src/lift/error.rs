//! Why evidence was not lifted, or an answer not drawn.

use std::ops::RangeInclusive;

use l4d_data::StageError;
use l4d_splat::model::ModelError;
use l4d_splat::optimise::OptimiseError;
use l4d_splat::raster::RasterError;
use l4d_splat::view::ViewError;

impl From<LiftError> for StageError {
    fn from(error: LiftError) -> Self {
        Self::of(&error, "lift with other settings, or train the scene again")
    }
}

/// Why lifting failed.
#[derive(Debug, thiserror::Error)]
pub enum LiftError {
    /// A mask that does not belong to its picture.
    #[error("view `{view}`, frame {frame}: {message}")]
    Evidence {
        /// Name of the camera.
        view: String,
        /// Canonical frame.
        frame: u32,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// A setting with which nothing can be lifted.
    #[error("lift setting `{field}` is {value}: {hint}")]
    Setting {
        /// Name of the field.
        field: &'static str,
        /// What is there.
        value: f64,
        /// What may be there.
        hint: &'static str,
    },
    /// A camera that cannot be drawn from.
    #[error("view `{view}`")]
    View {
        /// Name of the camera.
        view: String,
        /// What is wrong.
        source: ViewError,
    },
    /// The model has no state at this time.
    #[error("the model at time {time}")]
    Model {
        /// From 0 to 1.
        time: f32,
        /// What is wrong.
        source: ModelError,
    },
    /// The rasterizer gave up.
    #[error("drawing failed")]
    Raster(#[from] RasterError),
    /// The field can't learn any further.
    #[error("the identity field stopped learning at iteration {iteration}")]
    Learning {
        /// From 0.
        iteration: u32,
        /// What is wrong.
        source: OptimiseError,
    },
    /// A time outside the clip.
    #[error("time {time} lies outside the clip: times go from 0 to 1")]
    Time {
        /// What was asked for.
        time: f32,
    },
}

/// Refuses the first of these settings (name, value, range, range in words) that is outside its range.
pub(super) fn check_ranges<const N: usize>(
    settings: [(&'static str, f64, RangeInclusive<f64>, &'static str); N],
) -> Result<(), LiftError> {
    match settings.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
        Some((field, value, _, hint)) => Err(LiftError::Setting { field, value, hint }),
        None => Ok(()),
    }
}
