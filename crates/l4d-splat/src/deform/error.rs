//! Why a deformation field cannot be built or asked.

/// What is wrong with a field, its input or its output: the field, the row and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DeformError(pub(super) String);

impl DeformError {
    pub(super) fn length(field: &str, found: usize, expected: usize) -> Self {
        Self(format!("`{field}` has {found} numbers, but {expected} belong to these rows"))
    }

    /// A position that is not finite.
    pub(super) fn position(row: usize, [x, y, z]: [f32; 3]) -> Self {
        Self(format!("row {row}: the position ({x}, {y}, {z}) is not finite"))
    }

    /// A dynamic row that the Gaussians do not have.
    pub(super) fn row(row: usize, index: u32, count: usize) -> Self {
        Self(format!("dynamic row {row} names Gaussian {index}, but there are {count}"))
    }
}
