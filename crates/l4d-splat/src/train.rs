//! How a model is learned from pictures, with depth or without.
//!
//! What stands still is told from what moves by depth and colour alone ([`Motion`]); where nobody measured depth, it is
//! found by comparing pictures, and only says where Gaussians begin. *Coarse*: Gaussians on what stands
//! still learn the mean pictures of the standing cameras, without a field. *Fine*: Gaussians on what moves are added
//! at one moment, the clip is unfolded from there to both ends, then everything learns everywhere; only what moves
//! or changes colour goes through the deformation field. Owns schedules, initial points, density and the loop. Refuses to
//! know files, held-out views and instances.

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
