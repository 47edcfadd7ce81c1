//! Grammar of the verbs around the reference solver: solve, query, ablate, bench lift.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use l4d_data::{Profile, QuerySet, Shard};
use l4d_experiments::ablation::Grid;
use l4d_ground::panoptic::Part;
use l4d_solve::ask::ClipTime;
use l4d_solve::batch::Control;
use l4d_solve::consensus::Preset;
use l4d_solve::method::LiftChoice;

use super::models::ServerArgs;
use super::splats::{AdapterArgs, PixelSize, ReaderArgs};
use super::{BenchArgs, number, one_of};
use crate::shipped;

/// Who finds in one view what a sentence means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum GrounderArg {
    /// A small network, trained on composed scenes of the same assets (docs/network.md): no truth, nothing to download
    Panoptic,
    /// The same, of all views together: they are put into one scene before a sentence is judged
    PanopticFused,
    /// The truth of the training views, with the errors of --noise; never ranked
    Oracle,
    /// Masks that were made elsewhere, in --masks
    Files,
    /// What --grounder-file says: a vision-language model, a segmenter, or both
    Model,
}

impl GrounderArg {
    pub(crate) fn as_str(self) -> &'static str {
        match self {
            Self::Panoptic => "panoptic",
            Self::PanopticFused => "panoptic-fused",
            Self::Oracle => "oracle",
            Self::Files => "files",
            Self::Model => "model",
        }
    }
}

const PARTS: [&str; 5] = ["reading", "things", "kinds", "attributes", "events"];

/// A method of the reference solver.
#[derive(Debug, Clone, Args)]
pub(crate) struct MethodArgs {
    /// Who finds in one view what a sentence means
    #[arg(long, value_enum, default_value = "panoptic")]
    pub(crate) grounder: GrounderArg,
    /// Errors of the oracle; default: none
    #[arg(long, value_name = "TOML")]
    pub(crate) noise: Option<PathBuf>,
    /// Folder of masks made elsewhere: <scene>/<nnn>/<view>.json or <scene>/<nnn>/<view>/<frame>.png
    #[arg(long, value_name = "DIR", required_if_eq("grounder", "files"))]
    pub(crate) masks: Option<PathBuf>,
    /// Which segmenter, and how it is coupled with a vision-language model (docs/workers.md)
    #[arg(long, value_name = "TOML", required_if_eq("grounder", "model"))]
    pub(crate) grounder_file: Option<PathBuf>,
    /// Weights of your own for panoptic: a folder of perception.onnx and perception.json
    #[arg(long, value_name = "DIR")]
    pub(crate) weights: Option<PathBuf>,
    /// Parts of panoptic-fused to take from the truth, to measure what each costs (what the sentence means; which pixels
    /// are one thing, and where it is; what each is called; what each looks like; who does what); never ranked
    #[arg(long, value_delimiter = ',', value_name = "PARTS", value_parser = one_of::<Part>(PARTS))]
    pub(crate) given: Vec<Part>,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
    /// Rules and constants that belong together: what holds up where the paper is silent (robust), or as the paper writes
    /// it, with summed depth and an identity field of 2000 iterations (paper)
    #[arg(long, default_value = "robust", value_parser = one_of::<Preset>(["robust", "paper"]))]
    pub(crate) preset: Preset,
    /// Views that are looked at, at most (the paper's V)
    #[arg(long, value_name = "V", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) view_count: u32,
    /// Seed of the first view; the others are the farthest from those before
    #[arg(long, value_name = "SEED", default_value_t = 0)]
    pub(crate) view_seed: u64,
    /// Width and height of the clips, pixels; default: those of the pictures that the splats were trained on
    #[arg(long, value_name = "WxH")]
    pub(crate) clip_size: Option<PixelSize>,
    /// Clips of every N-th frame; default: of the frames that the splats were trained on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) clip_every: Option<u32>,
    /// Believe every view that found something, without consensus
    #[arg(long)]
    pub(crate) no_consensus: bool,
    /// Give no answer where the votes of the views decide nothing; default of the preset robust: lift all candidate masks
    #[arg(long)]
    pub(crate) abstain: bool,
    /// How masks become an answer; default: what the preset says. SIRT, a graph, time (closed); sums of blend weights and a
    /// threshold (vote); the identity field of the paper (field)
    #[arg(long, value_parser = one_of::<LiftChoice>(["closed", "vote", "field"]))]
    pub(crate) lift: Option<LiftChoice>,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
}

/// Where scenes and models are.
#[derive(Debug, Clone, Args)]
pub(crate) struct WorkArgs {
    /// Folder of the scenes, of which only the cameras are read; default: data/<profile>, or data/captures
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder for what can be remade: models, clips, what led to answers
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct SolveArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Which sentences: those that count, those of two categories, those that nothing satisfies
    #[arg(long, default_value = "queries", value_parser = one_of::<QuerySet>(["queries", "composites", "absents", "with-absents"]))]
    pub(crate) set: QuerySet,
    /// Take away what answers should rest on: grey pictures, or the sentence of another query of the scene; never ranked
    #[arg(long, value_parser = one_of::<Control>(["blank-pictures", "shuffled-sentences"]))]
    pub(crate) control: Option<Control>,
    /// Only these queries, e.g. room_living_cats/003 (comma-separated or repeated)
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub(crate) queries: Vec<String>,
    /// Name of the method; default: panopticquery-<grounder>, what differs from the preset robust, and --set if not queries
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Folder that receives one folder a method
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Folder that receives how each answer came about, <scene>/<nnn>; default: <work>/<profile>/<scene>/answers/<method>/<nnn>
    #[arg(long, value_name = "DIR")]
    pub(crate) answers: Option<PathBuf>,
    /// Queries at once
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) jobs: u32,
    /// Answer part i of n of the queries (a deterministic partition for clusters), e.g. 2/8
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// The models or masks learned from rendered depth: results are ranked in the track colour + depth. Models of
    /// train-splats say so themselves, and those that were trained on an export
    #[arg(long)]
    pub(crate) used_depth: bool,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
    /// Answer again what was answered by another version or with other settings under this name
    #[arg(long)]
    pub(crate) force: bool,
    /// Say what a model server would be asked and what that may cost, and send nothing
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct QueryArgs {
    /// Scene to look at
    pub(crate) scene: String,
    /// The sentence, in English
    #[arg(required_unless_present = "words")]
    pub(crate) text: Option<String>,
    /// List what a sentence may say instead: things, properties, verbs, and an example of each relation
    #[arg(long, conflicts_with = "text")]
    pub(crate) words: bool,
    /// First frame (24) or time (1.5s) that is asked about; default: that of the clip
    #[arg(long, value_name = "MOMENT")]
    pub(crate) from: Option<ClipTime>,
    /// Last frame or time that is asked about; default: that of the clip
    #[arg(long, value_name = "MOMENT")]
    pub(crate) to: Option<ClipTime>,
    /// tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Folder of the benchmark, for --grounder oracle and files, which know queries by their sentence alone
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// A checkpoint of train-splats, or a model of others as for render-splats; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) splats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
    /// Views from which masks are drawn (comma-separated or repeated); default: the held-out one
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) views: Vec<String>,
    /// Other cameras: JSON with width, height and cameras as in scene.json
    #[arg(long, value_name = "JSON")]
    pub(crate) cameras: Option<PathBuf>,
    /// Times at which masks are drawn, 0 (start of the clip) to 1 (its end); default: the frames of the clips
    #[arg(long, value_name = "TIME", value_delimiter = ',', value_parser = number::<f32>(0.0..=1.0))]
    pub(crate) times: Vec<f32>,
    /// Width and height of the masks, pixels; default: those of the clips, or of --cameras
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<PixelSize>,
    /// Also say what every view said of every other one, frame by frame
    #[arg(long)]
    pub(crate) explain: bool,
    /// Folder that receives masks and pictures; default: <work>/<profile>/<scene>/answers/asked/<digest of the question>
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
pub(crate) struct AblateArgs {
    /// Which table: with and without consensus, with the oracle once for each correlation of its errors (mvsc); numbers of
    /// views; models and couplings, a row for each of --grounder-files (vlm); queries of two categories; scales
    #[arg(value_parser = one_of::<Grid>(["mvsc", "views", "vlm", "composites", "scales"]))]
    pub(crate) grid: Grid,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Correlations between the errors of views, 0 to 1 (grid mvsc with the oracle); default there: 0,0.3,0.6,0.9
    #[arg(long, value_name = "RHO", value_delimiter = ',', value_parser = number::<f64>(0.0..=1.0))]
    pub(crate) correlations: Vec<f64>,
    /// Search the share of swapped views at which the row without consensus has the paper's mIoU, for each correlation and
    /// category (grid mvsc with the oracle); other errors are those of --noise
    #[arg(long)]
    pub(crate) calibrate: bool,
    /// Numbers of views (grid views), in place of --view-count
    #[arg(long, value_name = "V", value_delimiter = ',', default_values_t = [1, 4, 6, 8, 10, 12], value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) view_counts: Vec<u32>,
    /// Files as for --grounder-file, a row each, called as the file (grid vlm)
    #[arg(long, value_name = "TOML", value_delimiter = ',')]
    pub(crate) grounder_files: Vec<PathBuf>,
    /// Folder that receives tables, results, scores and answers; default: <work>/<profile>/ablations/<grid>
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Seed of the intervals
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Queries at once
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) jobs: u32,
    /// Answer again what was answered with other settings
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct BenchLiftArgs {
    /// Scenes whose answers are lifted
    #[arg(required = true)]
    pub(crate) scenes: Vec<String>,
    /// tiny, small or full
    #[arg(long, default_value = "small", value_parser = super::rendered)]
    pub(crate) profile: Profile,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Errors of the oracle that says what training views show; default: none
    #[arg(long, value_name = "TOML")]
    pub(crate) noise: Option<PathBuf>,
    /// Views that are looked at, at most
    #[arg(long, value_name = "V", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) view_count: u32,
    /// Queries of each scene, evenly from its list
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) queries: u32,
    /// Few ways and short learning: says whether it works, and little else
    #[arg(long)]
    pub(crate) quick: bool,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
    /// Folder that receives table and figure; default: <work>/bench/lift
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
