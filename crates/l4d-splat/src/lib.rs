//! 4D Gaussian splatting: a scene as Gaussians whose parameters depend on time.
//!
//! Owns the model ([`Gaussians`], [`Model`]), its checkpoints, rasterization forward and backward, and training. Refuses
//! to know what a query means, and graphics hardware (`l4d-gpu` draws the same model).

pub mod checkpoint;
pub mod clip;
pub mod conformance;
pub mod deform;
pub mod gaussians;
pub mod language;
pub mod model;
pub mod neighbours;
pub mod optimise;
pub mod raster;
pub mod source;
pub mod speed;
pub mod splats;
pub mod synthetic;
mod train;
pub mod training_run;
pub mod view;

pub use gaussians::{Gaussians, ShDegree};
pub use l4d_formats::{Tensor, tensor};
pub use model::Model;
