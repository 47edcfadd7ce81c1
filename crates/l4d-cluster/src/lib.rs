//! What a cluster needs to run the workflow (docs/cluster.md): its settings, the profile of the engine, and an estimate
//! of jobs, hours and room. It submits nothing, and does not know what a job does.

pub mod estimate;
pub mod limits;
pub mod settings;
pub mod sizes;

use l4d_data::StageError;

type Result<T, E = StageError> = std::result::Result<T, E>;
