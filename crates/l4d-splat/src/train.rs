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
#[cfg(test)]
mod hard_cases;
mod initial_points;
mod loss;
mod missing;
mod motion;
mod pinhole;
mod points;
mod quality;
mod scene_stats;
mod settings;
mod ssim;
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
#[cfg(test)]
pub(crate) use motion::background_errors;
pub(crate) use quality::{Quality, Region, decibels, measure};
pub(crate) use settings::Stage;
pub use settings::{Preset, Settings};
pub(crate) use trainer::Trainer;
pub(crate) use views::{Picture, TrainingViews};

#[derive(Debug, thiserror::Error)]
pub(crate) enum TrainError {
    #[error(transparent)]
    TrainingViews(#[from] views::TrainingViewsError),
    /// A setting, an initial model or a checkpoint that cannot be used: its name, and the hint.
    #[error("{0}")]
    Invalid(String),
    #[error(transparent)]
    View(#[from] ViewError),
    #[error("drawing failed")]
    Raster(#[from] RasterError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error("training has diverged")]
    Splat(#[from] SplatError),
    #[error("training has diverged")]
    Deform(#[from] DeformError),
    #[error("an optimiser step failed")]
    Optimise(#[from] OptimiseError),
}
