//! Why a board could not be made.

use l4d_data::DataError;

/// A refusal of this crate.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// There is nothing to show.
    #[error("there is no scored method")]
    NoMethods,
    /// Every method was scored on something else.
    #[error("no method was scored on {wanted}; there are scores on {found}")]
    NoneHere {
        /// What the board is of.
        wanted: String,
        /// What there is instead.
        found: String,
    },
    /// Two rows of one name.
    #[error("method `{0}` stands there twice")]
    Twice(String),
    /// A value that cannot be.
    #[error("method `{method}`: {field} is {value}, but must be {must}")]
    Value {
        /// Method.
        method: String,
        /// Where ("miou of category action").
        field: String,
        /// What stands there.
        value: f64,
        /// What could.
        must: &'static str,
    },
    /// polars refused.
    #[error("cannot make {file}: {message}")]
    Table {
        /// The file that was to be made.
        file: &'static str,
        /// The refusal.
        message: String,
    },
    /// plotters or the PNG encoder refused.
    #[error("cannot draw {figure}: {message}")]
    Figure {
        /// The figure that was to be drawn.
        figure: String,
        /// The refusal.
        message: String,
    },
    /// A file could not be written.
    #[error(transparent)]
    Data(#[from] DataError),
}
