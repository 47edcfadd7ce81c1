//! 4D Gaussian splatting: a scene as Gaussians whose parameters depend on time.
//!
//! This crate owns the model ([`Gaussians`]), how it reaches a disk and comes back, how it becomes a picture and how
//! a picture's error becomes a gradient. It refuses to know where training pictures come from, what a query means,
//! and anything about graphics hardware (`l4d-gpu` draws the same model there).

pub mod checkpoint;
pub mod clip;
pub mod conformance;
pub mod deform;
pub mod gaussians;
pub mod model;
pub mod optimise;
pub mod raster;
pub mod real;
pub mod reduce;
pub mod source;
pub mod splats;
pub mod synthetic;
pub mod tensor;
pub mod train;
pub mod view;

pub use gaussians::{Gaussians, ShDegree};
pub use model::Model;
pub use tensor::Tensor;
