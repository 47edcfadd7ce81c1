//! Grammar of the verbs that publish and fetch what was published: release, download, host.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use l4d_data::results::Track;
use l4d_data::{Profile, Split};
use l4d_release::Day;
use l4d_release::download::Part;

use super::{one_of, rendered};
use crate::shipped;

#[derive(Debug, Args)]
pub(crate) struct ReleaseArgs {
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// Day of publication, YYYY-MM-DD
    #[arg(long, value_name = "DAY", required_unless_present = "check")]
    pub(crate) date: Option<Day>,
    /// Page of the data set
    #[arg(long, value_name = "URL", required_unless_present = "check")]
    pub(crate) url: Option<String>,
    /// Who made it (repeated for several)
    #[arg(long = "creator", value_name = "NAME", default_value = "The l4d authors")]
    pub(crate) creators: Vec<String>,
    /// Include the renders of this profile: tiny, small or full
    #[arg(long, value_parser = rendered)]
    pub(crate) profile: Option<Profile>,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder of trained models: <DIR>/<profile>/<scene>/splats, those that exist
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// An earlier release: refuse a version that doesn't say what changed since
    #[arg(long, value_name = "RELEASE")]
    pub(crate) since: Option<PathBuf>,
    /// Folder of all rounds of annotation
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder that receives <name>-<version>
    #[arg(long, short, value_name = "DIR", default_value = "release")]
    pub(crate) out: PathBuf,
    /// Check a release instead: sums, missing, extra and altered files
    #[arg(long, value_name = "RELEASE")]
    pub(crate) check: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DownloadArgs {
    /// Folder or http(s) address of a release: what holds its SHA256SUMS
    #[arg(value_name = "BASE")]
    pub(crate) base: String,
    /// Scenes (comma-separated); default: all of the release
    #[arg(long, value_name = "SCENES", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
    /// Splits of the pictures: train,test; test is the held-out view
    #[arg(long, value_name = "SPLITS", value_delimiter = ',', value_parser = one_of::<Split>(["train", "test"]))]
    pub(crate) splits: Vec<Split>,
    /// Parts of the release: benchmark,colour,depth,ids,splats,tables; default: all that it has
    #[arg(long, value_name = "PARTS", value_delimiter = ',', value_parser = one_of::<Part>(Part::NAMES))]
    pub(crate) parts: Vec<Part>,
    /// Folder that receives scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder that receives trained models, and what is on its way
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// Folder that receives the benchmark
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    /// Compare what was downloaded with its digests; fetch lists alone
    #[arg(long)]
    pub(crate) verify_only: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Platforms.
#[derive(Debug, Subcommand)]
pub(crate) enum HostCommand {
    /// A competition bundle: pages, scoring program, reference data, starting kit
    Codabench(CompetitionArgs),
    /// Files for the Hugging Face Hub: tasks, a leaderboard, results for the card of each method
    Huggingface(HuggingfaceArgs),
}

#[derive(Debug, Args)]
pub(crate) struct HostArgs {
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// Whose truth counts: tiny, small or full
    #[arg(long, default_value = "small", value_parser = rendered)]
    pub(crate) profile: Profile,
    /// Folder of all rounds of annotation
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder that receives the files; default: hosting/<platform>
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompetitionArgs {
    #[command(flatten)]
    pub(crate) host: HostArgs,
    /// First day, YYYY-MM-DD
    #[arg(long, value_name = "DAY")]
    pub(crate) date: Day,
    /// Last day; default: no end
    #[arg(long, value_name = "DAY")]
    pub(crate) until: Option<Day>,
    /// Whose methods compete, since platforms rank all that they take with each other: those that did not learn from
    /// rendered depth, or those that did
    #[arg(long, default_value = "colour", value_parser = one_of::<Track>(["colour", "colour+depth"]))]
    pub(crate) track: Track,
    /// Page of the data set
    #[arg(long, value_name = "URL")]
    pub(crate) url: String,
    /// Who made it (repeated for several)
    #[arg(long = "creator", value_name = "NAME", default_value = "The l4d authors")]
    pub(crate) creators: Vec<String>,
    /// Wheel of the Python package l4d for the scoring program, or a folder with one (`maturin build`)
    #[arg(long, value_name = "WHEEL", default_value = "target/wheels")]
    pub(crate) wheel: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct HuggingfaceArgs {
    /// Folder of scored methods
    #[arg(default_value = "scores")]
    pub(crate) scores: PathBuf,
    /// Name of the data set on the Hub
    #[arg(long, value_name = "ORGANISATION/NAME")]
    pub(crate) dataset: String,
    #[command(flatten)]
    pub(crate) host: HostArgs,
}
