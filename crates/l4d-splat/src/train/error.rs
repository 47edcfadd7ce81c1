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
    /// A setting, an initial model or a checkpoint that cannot be used: its name, and the remedy.
    #[error("{0}")]
    Invalid(String),
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
    /// The deformation field cannot be evaluated.
    #[error("training has diverged")]
    Deform(#[from] DeformError),
    /// A step that cannot be taken.
    #[error("an optimiser step failed")]
    Optimise(#[from] OptimiseError),
}
