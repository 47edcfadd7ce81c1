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
mod field;
mod grid;
pub mod matmul;
mod network;
mod offsets;
mod sample;
mod tensors;

pub use bounds::Bounds;
pub use config::{DeformConfig, TimeAxis};
pub use field::{DeformationField, FieldGradients, Init, Parameters, Trace};
pub(crate) use grid::Plane;
pub use offsets::Offsets;
pub(crate) use tensors::{PREFIX, plane_name};

/// What is wrong with a field, its input or its output: the field, the row and the hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DeformError(String);

impl DeformError {
    fn length(field: &str, found: usize, expected: usize) -> Self {
        Self(format!("`{field}` has {found} numbers, but {expected} belong to these rows"))
    }

    /// A position that is not finite.
    fn position(row: usize, [x, y, z]: [f32; 3]) -> Self {
        Self(format!("row {row}: the position ({x}, {y}, {z}) is not finite"))
    }

    /// A dynamic row that the Gaussians do not have.
    fn row(row: usize, index: u32, count: usize) -> Self {
        Self(format!("dynamic row {row} names Gaussian {index}, but there are {count}"))
    }
}
