//! How a model is learned from pictures, with depth or without.
//!
//! What stands still is told from what moves by depth and colour alone ([`Motion`]); where nobody measured depth, it is
//! found by comparing pictures, and only says where Gaussians begin. *Coarse*: Gaussians on what stands
//! still learn the mean pictures of the standing cameras, without a field. *Fine*: Gaussians on what moves are added
//! at one moment, the clip is unfolded from there to both ends, then everything learns everywhere; only what moves
//! or changes colour goes through the deformation field. Owns schedules, initial points, density and the loop. Refuses to
//! know files, held-out views and instances.

mod colmap;
mod density;
mod error;
#[cfg(test)]
mod fake;
mod footage;
mod holes;
mod learn;
mod motion;
mod nearest;
mod place;
mod points;
mod quality;
mod settings;
mod sight;
mod start;
mod state;
mod stereo;
mod survey;
mod trainer;
mod unfold;
mod window;

pub use colmap::{ColouredPoint, read_points};
pub use error::TrainError;
pub use footage::{Footage, FootageError, Picture, Shot};
pub use motion::{Ground, Kind, Motion};
pub use quality::{Quality, Region, measure};
pub use settings::{Settings, Stage};
pub use start::Start;
pub use trainer::{Report, Trainer};
