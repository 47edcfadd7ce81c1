//! Measurements that need solver and judge in one process: the paper's ablations (section 5), and lifts against each
//! other. The solver never sees the truth that judges its answers.

pub mod ablation;
mod csv_file;
mod judged_scene;
pub mod lift;

use std::error::Error;

use l4d_data::StageError;

type Result<T, E = StageError> = std::result::Result<T, E>;

/// An error of a library without a hint of its own.
fn plain(error: impl Error) -> StageError {
    StageError::of(&error, "check the queries with `l4d check-queries`, and the names of files")
}
