//! The grammar of the command line, and nothing else.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use l4d_data::Profile;
use l4d_data::benchmark::SetSplit;

/// Benchmark and dataset toolkit for 4D language grounding.
#[derive(Debug, Parser)]
#[command(name = "l4d", version, about, max_term_width = 110, propagate_version = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: GlobalArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Say nothing but data, warnings and errors
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
    /// Say more on stderr (RUST_LOG refines it)
    #[arg(long, short, global = true)]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// The whole flow on one tiny scene: render, check, baselines, scores, leaderboard
    Quickstart(QuickstartArgs),
    /// What this machine has and lacks, one line each, with the remedy
    Doctor(DoctorArgs),
    /// Render scenes with Blender: RGB, depth and instance ids from many cameras
    BuildScenes(BuildScenesArgs),
    /// Check rendered scenes: file contract, digests, visibility, geometry across views
    CheckScenes(CheckScenesArgs),
    /// Draw a contact sheet of a scene: views, moments, outlines, queries
    Sheet(SheetArgs),
    /// Draw the scenes anew and keep the queries that still mean one thing: a fresh test set
    DrawVariant(DrawVariantArgs),
    /// Prove that each query has exactly one referent and real distractors
    CheckQueries(CheckQueriesArgs),
    /// Numbers, tables and figures of the set: comparison, words, sizes, visibility, motion, intervals
    Stats(StatsArgs),
    /// Write the results of baselines that bracket the scale
    Baseline(BaselineArgs),
    /// List every problem of a results folder
    CheckResults(CheckResultsArgs),
    /// Score a folder of methods: mIoU, mAcc, tube IoU, select
    Score(ScoreArgs),
    /// Rank scored methods: CSV tables and figures
    Leaderboard(LeaderboardArgs),
}

/// Where the benchmark stands and what of it is meant.
#[derive(Debug, Clone, Args)]
pub(crate) struct BenchArgs {
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    /// tiny, small or full
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Only these scenes (comma-separated or repeated); default: all
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct QuickstartArgs {
    /// Folder that receives everything
    #[arg(long, value_name = "DIR", default_value = "quickstart")]
    pub(crate) out: PathBuf,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    /// Scene to render
    #[arg(long, value_name = "NAME", default_value = "tabletop_mouse_cups")]
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
}

#[derive(Debug, Args)]
pub(crate) struct DoctorArgs {
    /// Make the Blender environment first, if it is missing
    #[arg(long)]
    pub(crate) setup: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
}

/// The Python that runs Blender.
#[derive(Debug, Clone, Args)]
pub(crate) struct PythonArgs {
    /// Python 3.11 with bpy; default: an environment that l4d makes and keeps under --work
    #[arg(long, value_name = "PATH")]
    pub(crate) python: Option<PathBuf>,
    /// Folder of the Blender scripts
    #[arg(long, value_name = "DIR", default_value = "blender_scripts")]
    pub(crate) blender_scripts: PathBuf,
    /// Folder for what can be remade (environments, logs)
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct BuildScenesArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Folder that receives the scenes; default: data/<profile>, or data/<profile>-v<variant>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// 0 is the benchmark; others permute looks, roles, layout and cameras; default: that of --bench
    #[arg(long)]
    pub(crate) variant: Option<u32>,
    /// Seed of everything random in the recipes; default: that of --bench
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Only tracks, no picture (writes <bench>/scenes)
    #[arg(long)]
    pub(crate) tracks_only: bool,
    /// Blender processes at once; each uses an equal part of the cores, two at least
    #[arg(long, default_value_t = 1)]
    pub(crate) jobs: usize,
    /// Render part i of n of the pictures (a deterministic partition for clusters), e.g. 2/8
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Samples per pixel of the colour pass, before denoising; 0 leaves pictures black and renders depth and ids alone,
    /// which is all that the truth needs; default: 8 (tiny), 4 (small), 16 (full)
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub(crate) samples: Option<u32>,
    /// Render again what other scripts, seeds or samples rendered before
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Replace committed tracks and truth that differ from what was built
    #[arg(long)]
    pub(crate) update_benchmark: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckScenesArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SheetArgs {
    /// Scene to draw; default: an overview of all rendered scenes, as the held-out view sees them
    #[arg(conflicts_with = "scenes")]
    pub(crate) scene: Option<String>,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// PNG to write; default: <data>/<scene>/sheet.png, for the overview <data>/overview.png
    #[arg(long, short, value_name = "PNG")]
    pub(crate) output: Option<PathBuf>,
    /// Moments, canonical frames; default: five evenly spaced, in the overview three
    #[arg(long, value_name = "FRAME", value_delimiter = ',')]
    pub(crate) frames: Vec<u32>,
    /// Views; default: the held-out view and two training views
    #[arg(long, value_name = "VIEW", value_delimiter = ',', requires = "scene")]
    pub(crate) views: Vec<String>,
    /// Leave out outlines, numbers and queries
    #[arg(long, requires = "scene")]
    pub(crate) plain: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DrawVariantArgs {
    /// Which permutation of looks, roles, layout and cameras
    pub(crate) variant: u32,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Seed of everything random in the recipes
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Folder of the new set
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// What the new set is for: private or dev
    #[arg(long, default_value = "private", value_parser = set_split)]
    pub(crate) split: SetSplit,
    /// Folder that receives the plans; default: data/<profile>-v<variant>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Replace another set that stands in --out
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckQueriesArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct StatsArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder that receives tables and figures; default: print only
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Results that bracket the scale, made from truth and seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BaselineName {
    /// The truth itself
    Oracle,
    /// Nothing anywhere
    None,
    /// Every pixel of every frame
    All,
    /// The right object in all frames, blind to time
    TimeAgnostic,
    /// One random object of the referent's category
    RandomLookAlike,
    /// All objects of the referent's category
    LookAlikeUnion,
}

#[derive(Debug, Args)]
pub(crate) struct BaselineArgs {
    /// Which baselines; default: all of them
    #[arg(value_enum)]
    pub(crate) names: Vec<BaselineName>,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder that receives one folder a baseline
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Seed of random choices
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Replace results of the same name that differ
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckResultsArgs {
    /// A folder of methods, or one method
    #[arg(default_value = "results")]
    pub(crate) results: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a missing mask means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MissingArg {
    /// An error
    Error,
    /// An empty mask
    Zero,
    /// Not scored; the method is marked partial
    Skip,
}

#[derive(Debug, Args)]
pub(crate) struct ScoreArgs {
    /// A folder of methods, or one method
    #[arg(default_value = "results")]
    pub(crate) results: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder that receives <method>/counts.csv
    #[arg(long, value_name = "DIR", default_value = "scores")]
    pub(crate) scores: PathBuf,
    /// What a missing mask means
    #[arg(long, value_enum, default_value = "error")]
    pub(crate) missing: MissingArg,
    /// A frame is hit when its IoU is above this
    #[arg(long, value_name = "IOU", default_value_t = 0.0)]
    pub(crate) hit_iou: f64,
    /// Resize predicted masks (nearest) to the size of the truth
    #[arg(long)]
    pub(crate) resize: bool,
    /// Score only queries that people have verified
    #[arg(long)]
    pub(crate) verified_only: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct LeaderboardArgs {
    /// Folder of scored methods
    #[arg(default_value = "scores")]
    pub(crate) scores: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder that receives tables and figures
    #[arg(long, short, value_name = "DIR", default_value = "leaderboard")]
    pub(crate) output: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Part `index` of `count`, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    pub(crate) index: usize,
    pub(crate) count: usize,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            Some((index.parse().ok()?, count.parse().ok()?))
        };
        match parse() {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(format!("`{text}` is not a shard: write i/n with 1 <= i <= n, for example 2/8")),
        }
    }
}

fn set_split(text: &str) -> Result<SetSplit, String> {
    match text {
        "private" => Ok(SetSplit::Private),
        "dev" => Ok(SetSplit::Dev),
        _ => Err("must be `private` or `dev`: there is one test set, the benchmark".to_owned()),
    }
}
