//! Why training cannot begin or go on.

use crate::deform::DeformError;
use crate::model::ModelError;
use crate::optimise::OptimiseError;
use crate::raster::RasterError;
use crate::splats::SplatError;
use crate::view::ViewError;

use super::views::TrainingViewsError;

/// What stopped training.
#[derive(Debug, thiserror::Error)]
pub enum TrainError {
    /// Pictures that cannot be trained on.
    #[error(transparent)]
    TrainingViews(#[from] TrainingViewsError),
    /// A setting with which nothing can be learned.
    #[error("setting `{setting}` is {value}: must be {range}")]
    Setting {
        /// Name of the field.
        setting: &'static str,
        /// What stands there.
        value: f64,
        /// What may stand there.
        range: &'static str,
    },
    /// Pictures without depth that cannot be compared.
    #[error(
        "nothing tells how far away things are: no two cameras see the same from different places; \
         start from the points of a COLMAP model"
    )]
    NothingToStartFrom,
    /// A checkpoint that was not written by this training.
    #[error("the state of training lacks `{name}`, or it has another size: train again")]
    Checkpoint {
        /// Name of the number or list.
        name: String,
    },
    /// A part of a view that cannot be drawn.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A picture that was not drawn.
    #[error("drawing failed")]
    Raster(#[from] RasterError),
    /// The model has no state at a time.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Gaussians that cannot be drawn.
    #[error("training has diverged")]
    Splat(#[from] SplatError),
    /// The deformation field has no answer.
    #[error("training has diverged")]
    Deform(#[from] DeformError),
    /// A step that cannot be taken.
    #[error("an optimiser step failed")]
    Optimise(#[from] OptimiseError),
}
