//! Arrangements: furnished places filled with drawn things, rendered by several workers at once.
//!
//! A seed's pictures depend on the seed alone. What is there is kept: a run that was killed goes on.

use std::path::Path;

use l4d_data::parallel::in_parallel;
use l4d_data::workspace::SharedWork;
use l4d_data::{At as _, Progress};

use crate::Result;
use crate::env::BlenderEnv;
use crate::worker::{self, WorkerEnd, WorkerEvent};

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct ArrangeOptions<'o> {
    /// The first seed.
    pub first: u64,
    /// How many seeds.
    pub count: u64,
    /// Pictures of each layout.
    pub views: u32,
    /// Light samples a pixel.
    pub samples: u32,
    /// Receives a folder for each layout.
    pub out: &'o Path,
    pub work: &'o SharedWork,
    /// Workers at once.
    pub jobs: usize,
}

/// How many seeds were rendered, and how many were there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Arranged {
    /// By this run.
    pub made: u64,
    pub kept: u64,
}

/// Renders the arrangements of some seeds.
///
/// # Errors
/// A folder that cannot be written, or a worker that dies.
pub fn arrange(env: &BlenderEnv, options: &ArrangeOptions<'_>, progress: &dyn Progress) -> Result<Arranged> {
    let jobs = options.jobs.clamp(1, options.count.max(1) as usize);
    progress.start("arranging", options.count);
    let shards: Vec<u64> = (0..jobs as u64).collect();
    let done = in_parallel(&shards, jobs, |shard| arrange_shard(env, options, *shard, jobs as u64, progress));
    progress.finish();
    let total =
        |sum: Arranged, one: &Arranged| Arranged { made: sum.made + one.made, kept: sum.kept + one.kept };
    Ok(done?.iter().fold(Arranged::default(), total))
}

/// Every n-th seed, by one worker.
fn arrange_shard(
    env: &BlenderEnv,
    options: &ArrangeOptions<'_>,
    shard: u64,
    shards: u64,
    progress: &dyn Progress,
) -> Result<Arranged> {
    let mut command = env.command();
    command.args(["arrange", "--first", &(options.first + shard).to_string()]);
    command.args(["--count", &options.count.saturating_sub(shard).to_string()]);
    command.args(["--every", &shards.to_string(), "--views", &options.views.to_string()]);
    command.args(["--samples", &options.samples.to_string()]).arg("--out").arg(options.out);
    let mut arranged = Arranged::default();
    let log = options.work.log("arrange", &format!("worker-{shard}"));
    let end = worker::run(command, &log, &mut |event| {
        if let WorkerEvent::Arranged { seed, made } = event {
            arranged.made += u64::from(*made);
            arranged.kept += u64::from(!*made);
            progress.item(seed);
            progress.advance(1);
        }
        true
    })?;
    match end {
        WorkerEnd::Done | WorkerEnd::Stopped => Ok(arranged),
        WorkerEnd::Refused(error) | WorkerEnd::Died(error) => {
            Err(error).at(format_args!("cannot render the arrangements"))
        }
    }
}
