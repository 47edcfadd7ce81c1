//! Scenes from Blender (docs/scenes.md): Python environments, job files, workers, and builds that resume.
//!
//! Blender's Python is GPL-3 and runs as a separate process; nothing else of the project links or imports it.

pub mod arrange;
pub mod build;
pub mod compose;
pub mod env;
pub mod part;
pub mod plan;
pub mod python;
mod render;
mod settle;
mod worker;

use l4d_data::StageError;

type Result<T, E = StageError> = std::result::Result<T, E>;
