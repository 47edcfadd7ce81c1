//! Grammar of the verbs around clusters.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use l4d_cluster::settings::Engine;

use super::scenes::PythonArgs;
use super::{BenchArgs, one_of};

/// What is done about clusters.
#[derive(Debug, Subcommand)]
pub(crate) enum ClusterCommand {
    /// Write what the workflow needs to run here: settings, the engine's profile, an estimate
    Init(ClusterInitArgs),
}

#[derive(Debug, Args)]
pub(crate) struct ClusterInitArgs {
    /// Folder that receives the files, on a file system that all nodes see
    pub(crate) dir: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder that receives results
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Folder that receives scores
    #[arg(long, value_name = "DIR", default_value = "scores")]
    pub(crate) scores: PathBuf,
    /// Folder that receives tables and the page
    #[arg(long, value_name = "DIR", default_value = "leaderboard")]
    pub(crate) leaderboard: PathBuf,
    /// Folder of the workflow
    #[arg(long, value_name = "DIR", default_value = "workflow")]
    pub(crate) workflow: PathBuf,
    /// Who runs jobs: slurm, local or kubernetes
    #[arg(long, default_value = "slurm", value_parser = one_of::<Engine>(Engine::NAMES))]
    pub(crate) engine: Engine,
    /// Partition of Slurm; default: the cluster's own
    #[arg(long, value_name = "NAME")]
    pub(crate) partition: Option<String>,
    /// Account of Slurm; default: none is named
    #[arg(long, value_name = "NAME")]
    pub(crate) account: Option<String>,
    /// Jobs in the queue or running at once, at most as many as the cluster lets you submit; default: 100, local: 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) jobs: Option<u64>,
    /// Minutes that a job works at most, as far as scenes can be divided; it asks for three times that and ten minutes
    #[arg(long, value_name = "MINUTES", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) runtime: u32,
    /// Make the environment of the workflow in DIR/env
    #[arg(long)]
    pub(crate) install: bool,
    /// Replace files that were changed
    #[arg(long)]
    pub(crate) force: bool,
}
