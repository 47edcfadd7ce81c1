//! The deformation field: how the parameters of Gaussians change with time.
//!
//! A HexPlane gives features of a place at a time, a linear layer mixes them, and five heads turn them into offsets
//! of centre, log-scale, quaternion, opacity logit and colour (the backbone of the paper's section 4; equations of
//! 4DGaussians, so that its checkpoints give the same offsets). This module owns the field, its derivative and its
//! names in checkpoints. It refuses to know files, pictures, losses and which Gaussians move.
//!
//! All results have the same bytes for any number of threads: rows are cut into blocks of a fixed size, and what is
//! summed over rows is summed in a fixed order. They are not the same on machines with other vector units, since the
//! matrix products are not.

mod bounds;
mod config;
mod error;
mod field;
mod grid;
mod init;
mod lanes;
pub mod matmul;
mod network;
mod offsets;
mod sample;
mod tensors;

pub use bounds::Bounds;
pub use config::{DeformConfig, TimeAxis};
pub use error::DeformError;
pub use field::{DeformationField, FieldGradients, Parameters, Trace};
pub(crate) use grid::Plane;
pub use init::Init;
pub use offsets::Offsets;
