//! Why a board could not be made.

use std::path::Path;

use l4d_data::{DataError, StageError};

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
    /// A table, a figure or the page could not be made.
    #[error("cannot make {file}: {message}")]
    Render {
        /// What was to be made.
        file: String,
        message: String,
    },
    /// A file could not be read or written.
    #[error(transparent)]
    Data(#[from] DataError),
}

impl From<BoardError> for StageError {
    fn from(error: BoardError) -> Self {
        let hint = match &error {
            BoardError::NoMethods => {
                "run `l4d score` first, or name the folder of scores; what `--protocol` wrote is never ranked"
            }
            BoardError::NoneHere { .. } => {
                "choose the --profile and --bench that the scores were made with, or run `l4d score` again"
            }
            BoardError::Render { .. } => "run `l4d score` again, or show fewer methods",
            BoardError::Data(error) => error.hint(),
        };
        Self::of(&error, hint)
    }
}

impl BoardError {
    pub(crate) fn render(file: &str, error: impl std::fmt::Display) -> Self {
        Self::Render { file: file.to_owned(), message: error.to_string() }
    }

    /// What the disk said while a file was written.
    pub(crate) fn write(path: &Path, error: impl Into<std::io::Error>) -> Self {
        DataError::io(path, "write", error.into()).into()
    }
}
