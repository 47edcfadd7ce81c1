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
mod error;
mod initial_points;
mod kd_tree;
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

pub use colmap::{ColouredPoint, read_points};
pub use error::TrainError;
pub use initial_points::InitialPoints;
pub use motion::{Background, Motion, SurfaceKind};
pub use quality::{Quality, Region, measure};
pub use settings::{Settings, Stage};
pub use trainer::{Report, Trainer};
pub use views::{Picture, TrainingCamera, TrainingViews, TrainingViewsError};
