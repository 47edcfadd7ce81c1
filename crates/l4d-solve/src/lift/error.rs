//! Why evidence was not lifted, or an answer not drawn.

use l4d_data::{DataError, StageError};
use l4d_splat::model::ModelError;
use l4d_splat::optimise::OptimiseError;
use l4d_splat::raster::RasterError;
use l4d_splat::view::ViewError;

impl From<LiftError> for StageError {
    fn from(error: LiftError) -> Self {
        let hint = match &error {
            LiftError::Data(error) => error.hint(),
            _ => None,
        };
        Self::of(&error, hint)
    }
}

/// Why lifting failed.
#[derive(Debug, thiserror::Error)]
pub enum LiftError {
    /// Nothing to learn from.
    #[error("there is no evidence: no view has a frame with a mask; let at least one view through")]
    NoEvidence,
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
    #[error("lift setting `{field}` is {value}: {remedy}")]
    Setting {
        /// Name of the field.
        field: &'static str,
        /// What is there.
        value: f64,
        /// What may be there.
        remedy: &'static str,
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
    /// The answer belongs to other Gaussians.
    #[error(
        "the answer was lifted onto another model (of {answered} Gaussians, digest {wanted}; this one has {found} and \
         {digest}): lift it again, or give the model that it belongs to"
    )]
    OtherModel {
        /// Gaussians of the model that was lifted onto.
        answered: usize,
        /// Its digest.
        wanted: String,
        /// Gaussians of the model at hand.
        found: usize,
        /// Its digest.
        digest: String,
    },
    /// A time outside the clip.
    #[error("time {time} lies outside the clip: times go from 0 to 1")]
    Time {
        /// What was asked for.
        time: f32,
    },
    /// What the disk holds or refuses.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Somebody wanted it to end.
    #[error("cancelled")]
    Cancelled,
}
