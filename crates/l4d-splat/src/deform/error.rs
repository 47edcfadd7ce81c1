//! Why a deformation field cannot be built or asked.

/// What is wrong with a field, with what it is asked, or with what it answers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DeformError {
    /// A size of the configuration.
    #[error("deformation config: `{field}` is {value}: must be at least 1 and at most {most}")]
    Config {
        /// Field of [`super::DeformConfig`].
        field: &'static str,
        /// What stands there.
        value: u64,
        /// Largest value.
        most: u64,
    },
    /// The box that the planes span has no inside.
    #[error(
        "bounding box of the deformation field: axis {axis} runs from {min} to {max}: both must be finite and the \
         first (row 1 of `aabb`) smaller than the second (row 0); widen the box along this axis"
    )]
    Box {
        /// `x`, `y` or `z`.
        axis: char,
        /// Lower end, metres.
        min: f32,
        /// Upper end, metres.
        max: f32,
    },
    /// A tensor that is missing, has another shape, or holds a value that cannot be.
    #[error("tensor `{name}`: {message}")]
    Tensor {
        /// Key in the checkpoint.
        name: String,
        /// What is wrong with it.
        message: String,
    },
    /// A position that is not finite.
    #[error("row {row}: the position ({}, {}, {}) is not finite", position[0], position[1], position[2])]
    Position {
        /// Index in the list of positions.
        row: usize,
        /// What stands there.
        position: [f32; 3],
    },
    /// A time outside the clip.
    #[error("time is {time}: must be from 0 (first frame) to 1 (last frame)")]
    Time {
        /// What was asked for.
        time: f32,
    },
    /// Lists that belong together have different lengths.
    #[error("`{field}` has {found} numbers, but {expected} belong to these rows")]
    Length {
        /// Which list.
        field: &'static str,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
    /// A row that the Gaussians do not have.
    #[error("dynamic row {row} names Gaussian {index}, but there are {count}")]
    Row {
        /// Place in the list of dynamic rows.
        row: usize,
        /// Gaussian that it names.
        index: u32,
        /// Number of Gaussians.
        count: usize,
    },
    /// A gradient from further up that is not finite.
    #[error(
        "row {row}: the gradient of `{field}` is {value}: the loss or the rasterizer before it has diverged"
    )]
    Gradient {
        /// Field of [`super::Offsets`].
        field: &'static str,
        /// Row.
        row: usize,
        /// What stands there.
        value: f32,
    },
    /// An answer that is not finite, although the question was.
    #[error(
        "row {row}: the offset of `{field}` is {value}: the parameters of the field have diverged; go back to an \
         earlier checkpoint or train with lower learning rates"
    )]
    Diverged {
        /// Field of [`super::Offsets`].
        field: &'static str,
        /// Row.
        row: usize,
        /// What came out.
        value: f32,
    },
}
