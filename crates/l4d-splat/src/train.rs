//! How a model is learned from pictures, with depth or without.
//!
//! Static and dynamic are separated by depth and colour alone ([`Motion`]). *Coarse*: static Gaussians learn the mean
//! pictures of the static cameras, without a field. *Fine*: Gaussians of what moves are added at one moment, the clip is
//! learned from there to both ends, then everything learns; only what moves or changes colour goes through the
//! deformation field. Refuses to know files, held-out views and instances.

mod colmap;
mod crop;
mod densify;
mod depth;
mod initial_points;
mod loss;
mod missing;
mod motion;
mod pinhole;
mod points;
mod quality;
mod scene_stats;
mod settings;
mod state;
mod stereo;
#[cfg(test)]
mod test_world;
mod time_span;
mod trainer;
mod views;

use crate::deform::DeformError;
use crate::model::ModelError;
use crate::optimise::OptimiseError;
use crate::raster::RasterError;
use crate::splats::SplatError;
use crate::view::ViewError;

pub(crate) use colmap::read_points;
pub(crate) use initial_points::InitialPoints;
pub(crate) use motion::Motion;
pub(crate) use quality::{Quality, Region, measure};
pub use settings::Settings;
pub(crate) use settings::Stage;
pub(crate) use trainer::Trainer;
pub(crate) use views::{Picture, TrainingViews};

/// What stopped training.
#[derive(Debug, thiserror::Error)]
pub(crate) enum TrainError {
    /// Pictures that cannot be trained on.
    #[error(transparent)]
    TrainingViews(#[from] views::TrainingViewsError),
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
