//! Blender as child processes: the Python environment, the workers' protocol, and what becomes of their output.

pub(crate) mod env;
pub(crate) mod plan;
pub(crate) mod render;
pub(crate) mod settle;
pub(crate) mod worker;
