//! Grammar of the verbs that judge: baseline, check-results, score, leaderboard.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use l4d_data::Profile;
use l4d_score::results::{MEGABYTE, MOST_BYTES, PROTOCOL};
use l4d_score::{Baseline, Missing, Protocol, QuerySet};

use super::{BenchArgs, number, one_of};
use crate::shipped;

const BASELINES: [&str; 6] =
    ["oracle", "none", "all", "time-agnostic", "random-look-alike", "look-alike-union"];
const SETS: [&str; 2] = ["queries", "composites"];

#[derive(Debug, Args)]
pub(crate) struct BaselineArgs {
    /// Which baselines; default: all of them. The truth itself (oracle), nothing anywhere, every pixel of every frame, the
    /// right object in all frames (time-agnostic), one random object or all objects of the referent's category
    #[arg(value_parser = one_of::<Baseline>(BASELINES))]
    pub(crate) names: Vec<Baseline>,
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
pub(crate) struct InitResultsArgs {
    /// Name of the method, and of its folder
    pub(crate) name: String,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Folder that receives one folder a method
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Version of the method
    #[arg(long, value_name = "VERSION", default_value = "1")]
    pub(crate) method_version: String,
    /// Paper or code
    #[arg(long, value_name = "URL", default_value = "")]
    pub(crate) link: String,
    /// The method learned from rendered depth of the training views: ranked in the track colour + depth
    #[arg(long)]
    pub(crate) used_depth: bool,
    /// The method looked at the truth: shown, never ranked
    #[arg(long)]
    pub(crate) used_truth: bool,
    /// The method looked at pictures of the held-out view: shown, never ranked
    #[arg(long)]
    pub(crate) used_test_view: bool,
    /// Wall seconds that the method took for all queries
    #[arg(long, value_name = "SECONDS", value_parser = number::<f64>(0.0..))]
    pub(crate) seconds: Option<f64>,
    /// Replace a method.json that says something else
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
    /// Which sentences are judged
    #[arg(long, default_value = "queries", value_parser = one_of::<QuerySet>(SETS))]
    pub(crate) set: QuerySet,
    /// Most bytes of masks that a method may have, in MB; one with more is not read
    #[arg(long, value_name = "MB", default_value_t = MOST_BYTES / MEGABYTE)]
    pub(crate) max_megabytes: u64,
    /// List each finding, also those that many files have in common
    #[arg(long)]
    pub(crate) all: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Whose evaluation judges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ProtocolArg {
    /// Ours: the headline
    L4d,
    /// Another one
    Other(Protocol),
}

fn protocols() -> impl TypedValueParser<Value = ProtocolArg> {
    let others = Protocol::ALL.map(Protocol::as_str);
    PossibleValuesParser::new(std::iter::once(PROTOCOL).chain(others)).map(|name| {
        let other = Protocol::ALL.into_iter().find(|protocol| protocol.as_str() == name);
        other.map_or(ProtocolArg::L4d, ProtocolArg::Other)
    })
}

#[derive(Debug, Args)]
pub(crate) struct ScoreArgs {
    /// A folder of methods, or one method
    #[arg(default_value = "results")]
    pub(crate) results: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Which sentences are judged
    #[arg(long, default_value = "queries", value_parser = one_of::<QuerySet>(SETS))]
    pub(crate) set: QuerySet,
    /// Whose evaluation judges: ours, or the sums of another one done again, which is never ranked (docs/protocols.md)
    #[arg(long, value_name = "NAME", default_value = PROTOCOL, value_parser = protocols())]
    pub(crate) protocol: ProtocolArg,
    /// Folder that receives <method>/counts.csv; default: scores, or scores-composites; with another protocol its name
    /// is appended
    #[arg(long, value_name = "DIR")]
    pub(crate) scores: Option<PathBuf>,
    /// What a missing mask means: an error, an empty mask (zero), or that the frame is not scored and the method partial (skip)
    #[arg(long, default_value = "error", value_parser = one_of::<Missing>(["error", "zero", "skip"]))]
    pub(crate) missing: Missing,
    /// A frame is hit when its IoU is above this
    #[arg(long, value_name = "IOU", default_value_t = 0.0, value_parser = number::<f64>(0.0..1.0))]
    pub(crate) hit_iou: f64,
    /// Resize predicted masks (nearest) to the size of the truth
    #[arg(long)]
    pub(crate) resize: bool,
    /// Most bytes of masks that a method may have, in MB; one with more is not read
    #[arg(long, value_name = "MB", default_value_t = MOST_BYTES / MEGABYTE)]
    pub(crate) max_megabytes: u64,
    /// Score only queries that people have verified
    #[arg(long)]
    pub(crate) verified_only: bool,
    /// Print means with intervals by category, scale, time, size, occlusion and scene; as JSON by query, too
    #[arg(long)]
    pub(crate) groups: bool,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Seed of the draws behind intervals
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct LeaderboardArgs {
    /// Folder of scored methods; default: scores, or scores-composites
    pub(crate) scores: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Which sentences were judged
    #[arg(long, default_value = "queries", value_parser = one_of::<QuerySet>(SETS))]
    pub(crate) set: QuerySet,
    /// Folder that receives tables and figures; default: leaderboard, or leaderboard-composites
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Seed of the draws behind intervals
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Write index.html too: the board as one page with masks and pictures, which needs no network
    #[arg(long)]
    pub(crate) html: bool,
    /// Of a private set: also write what names its answers (board.json, taken.csv, the page), for you alone
    #[arg(long)]
    pub(crate) with_answers: bool,
    /// Folder of the results whose masks the page shows
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Folder of rendered scenes whose held-out pictures lie under the masks of the page; default: none
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
