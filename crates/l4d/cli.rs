//! The grammar of the command line, and nothing else.

pub(crate) mod interop;
pub(crate) mod solver;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use l4d_data::benchmark::SetSplit;
use l4d_data::{Profile, Scale};
use l4d_endpoint::Link;
use l4d_votes::{FrameRule, Rule};

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
    /// Model servers: what one supports, and how its model writes boxes
    #[command(subcommand)]
    Endpoint(EndpointCommand),
    /// Let a vision model propose queries: proved candidates, and all others with the reasons
    ProposePrompts(ProposePromptsArgs),
    /// Let a language model propose scenes: specs that keep the rules, for people to build
    ProposeScenes(ProposeScenesArgs),
    /// Draw a round of annotation: what is asked of whom, with control items and repeats
    OpenRound(OpenRoundArgs),
    /// Vote in a round: read a prompt, find what it means, in a terminal
    VerifyPrompts(VerifyPromptsArgs),
    /// Judge a round: valid prompts, agreement, what to refine; sets the status of the queries
    Verdict(VerdictArgs),
    /// Learn a 4D model of a scene from its training cameras
    TrainSplats(TrainSplatsArgs),
    /// Draw clips of a model: colour and depth from any cameras at any times
    RenderSplats(RenderSplatsArgs),
    /// Answer queries with PanopticQuery: clips, grounding, consensus, lifting, masks of the held-out view
    Solve(solver::SolveArgs),
    /// Ask one sentence about one scene: what each stage decides, masks, pictures
    Query(solver::QueryArgs),
    /// Run the ablations of the paper: consensus, views, models, composites, scales
    Ablate(solver::AblateArgs),
    /// Write a scene in the layout of another tool
    Export(interop::ExportArgs),
    /// Read a capture that others recorded
    ImportScene(interop::ImportSceneArgs),
    /// Take in results of other methods: masks, relevancy, latents of LangSplat and its kin
    Import(interop::ImportArgs),
    /// Write the results of baselines that bracket the scale
    Baseline(BaselineArgs),
    /// List every problem of a results folder
    CheckResults(CheckResultsArgs),
    /// Score a folder of methods: mIoU, mAcc, tube IoU, select
    Score(ScoreArgs),
    /// Rank scored methods: CSV tables and figures
    Leaderboard(LeaderboardArgs),
    /// Speed against error: tables and figures
    #[command(subcommand)]
    Bench(BenchCommand),
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

/// Which model of which server is meant: a file, flags, or flags that override the file.
#[derive(Debug, Clone, Args)]
pub(crate) struct EndpointArgs {
    /// Description of the endpoint: server, model, name of the variable that holds the key (docs/endpoints.md)
    #[arg(long, value_name = "TOML")]
    pub(crate) endpoint: Option<PathBuf>,
    /// Root of the server's protocol, e.g. http://localhost:8000/v1
    #[arg(long, value_name = "URL")]
    pub(crate) base_url: Option<String>,
    /// Name of the model, as the server knows it
    #[arg(long, value_name = "NAME")]
    pub(crate) model: Option<String>,
    /// Environment variable that holds the key; the key itself is never an argument
    #[arg(long, value_name = "VARIABLE")]
    pub(crate) api_key_env: Option<String>,
    /// Kind of server: generic, vllm, llama-cpp, ollama, openai, gemini, mistral-rs, transformers, dashscope
    #[arg(long, value_name = "KIND")]
    pub(crate) server: Option<String>,
    /// live, record:<folder> or replay:<folder> (which brings its own endpoint)
    #[arg(long, value_name = "LINK", default_value = "live")]
    pub(crate) link: Link,
}

#[derive(Debug, Subcommand)]
pub(crate) enum EndpointCommand {
    /// Ask a server what it supports: models, chat, pictures, schema, seed; one line each, with the remedy
    Check(EndpointCheckArgs),
    /// Find out how a model writes boxes, by asking about pictures with squares at known places
    Calibrate(EndpointCalibrateArgs),
}

#[derive(Debug, Args)]
pub(crate) struct EndpointCheckArgs {
    #[command(flatten)]
    pub(crate) endpoint: EndpointArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct EndpointCalibrateArgs {
    #[command(flatten)]
    pub(crate) endpoint: EndpointArgs,
    /// Pictures to ask about, each once for every field name that models know
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=9))]
    pub(crate) pictures: u32,
    /// Width and height of the pictures, pixels; the default tells all conventions apart
    #[arg(long, value_name = "WxH", default_value = "714x490")]
    pub(crate) size: PictureSize,
    /// Longest answer, tokens
    #[arg(long, value_name = "TOKENS", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=65536))]
    pub(crate) answer_tokens: u32,
    /// Folder for what can be remade; endpoints.json in it remembers the convention
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Width and height of a picture, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PictureSize {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl std::str::FromStr for PictureSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse().ok().filter(|side| (96..=4096).contains(side));
        let sides = text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let (width, height) =
            sides.ok_or("write <width>x<height> with sides of 96 to 4096 pixels, for example 714x490")?;
        Ok(Self { width, height })
    }
}

/// Which model is asked, what may be spent, and what becomes of its answers.
#[derive(Debug, Clone, Args)]
pub(crate) struct ServerArgs {
    #[command(flatten)]
    pub(crate) endpoint: EndpointArgs,
    /// Folder that keeps every answer, so that nothing is asked twice
    #[arg(long, value_name = "DIR", default_value = "work/answers")]
    pub(crate) cache: PathBuf,
    /// Ask again and replace kept answers
    #[arg(long)]
    pub(crate) refresh: bool,
    /// Stop before questions and answers cost more than this (needs prices in the endpoint's file)
    #[arg(long, value_name = "COST")]
    pub(crate) max_cost: Option<f64>,
    /// Stop before questions and answers have more tokens than this
    #[arg(long, value_name = "TOKENS")]
    pub(crate) max_tokens_total: Option<u64>,
}

/// How a model is asked for proposals.
#[derive(Debug, Clone, Args)]
pub(crate) struct AskArgs {
    #[command(flatten)]
    pub(crate) server: ServerArgs,
    /// Ask once more for other answers: 1, 2, ...
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) repeat: u32,
    /// Longest single answer, tokens; default: what the number of proposals needs
    #[arg(long, value_name = "TOKENS", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) answer_tokens: Option<u32>,
    /// Only say what would be asked and what it may cost
    #[arg(long)]
    pub(crate) dry_run: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ProposePromptsArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) ask: AskArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder that receives the proposals; default: work/<profile>/proposals
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Queries wanted of each of the four categories
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub(crate) per_category: u32,
    /// Moments of the clip that the model sees
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(2..=97))]
    pub(crate) frames: u32,
    /// Training views that the model sees beside the held-out one
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=16))]
    pub(crate) training_views: u32,
    /// Pictures are enlarged until they are at least this wide, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(128..=1920))]
    pub(crate) width: u32,
    /// Scenes at once
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) jobs: u32,
    /// Ask about part i of n of the scenes (a deterministic partition for clusters), e.g. 2/8
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Replace proposals of other models or runs
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ProposeScenesArgs {
    /// Folder of the benchmark whose scenes exist already
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    #[command(flatten)]
    pub(crate) ask: AskArgs,
    /// Folder that receives the scenarios
    #[arg(long, short, value_name = "DIR", default_value = "work/scenarios")]
    pub(crate) out: PathBuf,
    /// Only these scales (comma-separated or repeated): outdoor, room, tabletop; default: all
    #[arg(long, value_name = "SCALE", value_delimiter = ',', value_parser = scale)]
    pub(crate) scales: Vec<Scale>,
    /// Scenarios of each scale
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub(crate) per_scale: u32,
    /// Replace files that hold something else
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which queries are asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum AskedArg {
    /// All of them
    All,
    /// Those that people have not voted on
    Candidate,
    /// Those that people have rejected
    Rejected,
}

#[derive(Debug, Args)]
pub(crate) struct OpenRoundArgs {
    /// Name of the round, also of its folder
    pub(crate) name: String,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder of all rounds
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Who votes (comma-separated or repeated), as many as the rule counts
    #[arg(long, value_name = "NAME", value_delimiter = ',', required = true)]
    pub(crate) annotators: Vec<String>,
    /// One line that says what the round is
    #[arg(long)]
    pub(crate) title: Option<String>,
    /// Which queries are asked about
    #[arg(long, value_enum, default_value = "candidate")]
    pub(crate) queries: AskedArg,
    /// Ask again what this earlier round did not find valid, once text or truth was edited
    #[arg(long, value_name = "ROUND", conflicts_with = "queries")]
    pub(crate) from: Option<String>,
    /// Only so many of them, drawn by lot, evenly from the categories
    #[arg(long, value_name = "COUNT")]
    pub(crate) sample: Option<usize>,
    /// Leave out what people rejected in the words that it still has, instead of refusing
    #[arg(long)]
    pub(crate) edited_only: bool,
    /// Queries of two categories as well
    #[arg(long)]
    pub(crate) composites: bool,
    /// When a prompt counts as understood: unanimous:5, majority:3/5
    #[arg(long, default_value = "unanimous:5")]
    pub(crate) rule: Rule,
    /// How well chosen frames must fit a prompt that is bound to a time: any, iou:0.5
    #[arg(long, value_name = "RULE", default_value = "any")]
    pub(crate) frames: FrameRule,
    /// How many views annotators may look at
    #[arg(long, value_name = "COUNT", default_value_t = 5)]
    pub(crate) views: usize,
    /// Control items as a share of the queries: sentences that mean nothing, and prompts that only name a category
    #[arg(long, value_name = "SHARE", default_value_t = 0.1)]
    pub(crate) gold: f64,
    /// Prompts that are asked twice, as a share of the queries
    #[arg(long, value_name = "SHARE", default_value_t = 0.05)]
    pub(crate) repeats: f64,
    /// Seed of ids, control items and orders
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// The annotators are programs: the round never counts as verification by people
    #[arg(long)]
    pub(crate) simulated: bool,
    /// Replace a round of this name in which nobody has voted
    #[arg(long)]
    pub(crate) force: bool,
}

/// How pictures are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureArg {
    /// What the terminal can do best
    Auto,
    /// Block characters, in every terminal
    Halfblocks,
    /// Sixel graphics (foot, mlterm, xterm -ti vt340, Windows Terminal)
    Sixel,
    /// The protocol of kitty and Ghostty
    Kitty,
    /// The protocol of iTerm2 and WezTerm
    Iterm2,
    /// Not at all; `o` writes them to files
    None,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyPromptsArgs {
    /// Name of the round
    #[arg(long, value_name = "NAME")]
    pub(crate) round: String,
    /// Who votes: one of the annotators that the round names
    #[arg(long = "as", value_name = "NAME")]
    pub(crate) annotator: String,
    /// Folder of all rounds
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder of the rendered scenes; default: data/<profile of the round>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// How pictures are shown
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) picture: PictureArg,
    /// Folder for what can be remade; receives the pictures that `o` opens
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct VerdictArgs {
    /// The round
    #[arg(long, value_name = "NAME")]
    pub(crate) round: String,
    /// Folder of all rounds
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    /// Folder of the rendered scenes, for the contact sheet; default: data/<profile of the round>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Only look, before all ballots are sealed: nothing is written
    #[arg(long, conflicts_with = "check")]
    pub(crate) unsealed: bool,
    /// Derive the files again and compare: nothing is written
    #[arg(long)]
    pub(crate) check: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where the first Gaussians stand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum InitArg {
    /// On the surfaces that depth shows.
    Depth,
    /// Anywhere.
    Random,
    /// On the points of a COLMAP model.
    Points(PathBuf),
}

impl std::str::FromStr for InitArg {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "depth" => Self::Depth,
            "random" => Self::Random,
            path => Self::Points(path.into()),
        })
    }
}

impl std::fmt::Display for InitArg {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Depth => f.write_str("depth"),
            Self::Random => f.write_str("random"),
            Self::Points(path) => path.display().fmt(f),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct TrainSplatsArgs {
    /// Scene to learn
    pub(crate) scene: String,
    /// Pictures that are trained on, and where things stand by default: tiny, small or full
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Folder of the benchmark: it says which draw of the scenes is meant
    #[arg(long, value_name = "DIR", default_value = "benchmark")]
    pub(crate) bench: PathBuf,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder for what can be remade
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// Folder that receives the model; default: <work>/<profile>/<scene>/splats
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Where the first Gaussians stand: depth, random, or the path of COLMAP's points3D.txt or points3D.bin
    #[arg(long, value_name = "INIT", default_value = "depth")]
    pub(crate) init: InitArg,
    /// Most Gaussians; default: 5000 (tiny), 18000 (small), 60000 (full)
    #[arg(long, value_name = "N")]
    pub(crate) gaussians: Option<usize>,
    /// Degree of the spherical harmonics, 0 to 3: how much a colour may depend on direction; default: 1
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(0..=3))]
    pub(crate) sh_degree: Option<u8>,
    /// Share of moments at which a place has to be seen through, or to have another colour, before it counts as dynamic;
    /// 0: everything is dynamic, 1.1: nothing is; default: 0.05
    #[arg(long, value_name = "SHARE")]
    pub(crate) dynamic_threshold: Option<f32>,
    /// Iterations on what stands still; default: 400 (tiny), 1000 (others)
    #[arg(long, value_name = "N")]
    pub(crate) coarse: Option<u64>,
    /// Iterations for each step in which the clip is unfolded from one moment to its ends; default: 30 (tiny), 20 (others)
    #[arg(long, value_name = "N")]
    pub(crate) unfold: Option<u64>,
    /// Iterations on the whole clip; default: 1000 (tiny), 4000 (small), 12000 (full)
    #[arg(long, value_name = "N")]
    pub(crate) fine: Option<u64>,
    /// Views of one moment that an iteration looks at; default: 2
    #[arg(long, value_name = "N")]
    pub(crate) views_per_iteration: Option<usize>,
    /// What an error of depth costs beside one of colour; default: 0.1
    #[arg(long, value_name = "WEIGHT")]
    pub(crate) depth_weight: Option<f32>,
    /// Share of 1 - SSIM in the loss of colour, the rest is L1; default: 0
    #[arg(long, value_name = "WEIGHT")]
    pub(crate) dssim_weight: Option<f32>,
    /// Stop after so many looks at the training pictures (one every 500 iterations) without progress; 0: never early;
    /// default: 3
    #[arg(long, value_name = "N")]
    pub(crate) patience: Option<usize>,
    /// Seed of everything random
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Seconds between checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    pub(crate) checkpoint_seconds: f64,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
    /// Replace a model that has other settings or pictures
    #[arg(long)]
    pub(crate) overwrite: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which depth is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DepthArg {
    /// Where half of the pixel is filled: keeps edges
    Median,
    /// Mean of the depths that a pixel shows
    Expected,
    /// Sum of depth x weight, as 4DGaussians: too near wherever a pixel is not filled
    Sum,
}

/// How depth is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DepthFormatArg {
    /// OpenEXR: depth in metres, alpha, spread
    Exr,
    /// 16-bit PNG in millimetres
    Png,
}

#[derive(Debug, Args)]
pub(crate) struct RenderSplatsArgs {
    /// Scene whose model, cameras and size are meant; not needed with --model and --cameras
    #[arg(required_unless_present_all = ["model", "cameras"])]
    pub(crate) scene: Option<String>,
    /// Frames that are drawn, and where things stand by default: tiny, small or full
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder for what can be remade
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// A checkpoint of train-splats, a model folder of 4DGaussians, or a PLY of 3DGS; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) model: Option<PathBuf>,
    /// Other cameras: JSON with width, height and cameras as in scene.json
    #[arg(long, value_name = "JSON")]
    pub(crate) cameras: Option<PathBuf>,
    /// Only these views (comma-separated or repeated); default: all training views
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) views: Vec<String>,
    /// Only these canonical frames, 0 to 96; default: those of the profile
    #[arg(long, value_name = "FRAME", value_delimiter = ',', conflicts_with = "times")]
    pub(crate) frames: Vec<u32>,
    /// Times instead of frames, 0 (start of the clip) to 1 (its end)
    #[arg(long, value_name = "TIME", value_delimiter = ',')]
    pub(crate) times: Vec<f32>,
    /// Width and height of the pictures, pixels; default: those of the cameras
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<PixelSize>,
    /// Which depth is written
    #[arg(long, value_enum, default_value = "median")]
    pub(crate) depth: DepthArg,
    /// How depth is stored
    #[arg(long, value_enum, default_value = "exr")]
    pub(crate) depth_format: DepthFormatArg,
    /// What shows where nothing is: black, white or red,green,blue from 0 to 1; default: what the model says, or black
    #[arg(long, value_name = "COLOUR")]
    pub(crate) background: Option<Background>,
    /// Folder that receives the clips; default: <work>/<profile>/<scene>/clips
    #[arg(long, short, value_name = "DIR", required_unless_present = "scene")]
    pub(crate) out: Option<PathBuf>,
    /// Also write a moving picture of all views: MP4 where ffmpeg is at hand, else an animated PNG
    #[arg(long)]
    pub(crate) preview: bool,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
    /// Replace clips of another model or other settings
    #[arg(long)]
    pub(crate) overwrite: bool,
}

/// What draws.
#[derive(Debug, Clone, Args)]
pub(crate) struct AdapterArgs {
    /// cpu, auto (graphics hardware where there is some), or a graphics adapter by number or name (`l4d doctor` lists them)
    #[arg(long, value_name = "ADAPTER", default_value = "cpu")]
    pub(crate) adapter: String,
}

#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Drawing a model: how much faster it gets by what, and what that costs
    Splats(BenchSplatsArgs),
    /// Lifting masks into a scene: seconds, mIoU and flicker of every lift
    Lift(solver::BenchLiftArgs),
}

/// What a benchmark of drawing changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum SweepArg {
    /// Fewer Gaussians: those that show most
    Count,
    /// Lower degrees of the spherical harmonics
    Degree,
    /// Thresholds of alpha and transmittance
    Cutoffs,
    /// What hardly moves stands still
    Static,
    /// Smaller pictures, enlarged
    Resolution,
    /// Parameters stored in 16-bit floats
    F16,
    /// Other instructions, one thread, graphics adapters
    Rasterizer,
    /// Several of these at once
    Together,
}

#[derive(Debug, Args)]
pub(crate) struct BenchSplatsArgs {
    /// Scene whose model is drawn and whose held-out pictures it is compared with; default: a made-up room
    pub(crate) scene: Option<String>,
    /// tiny, small or full
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Folder for what can be remade
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
    /// The model; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH", requires = "scene")]
    pub(crate) model: Option<PathBuf>,
    /// Gaussians of the made-up room
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    pub(crate) gaussians: u32,
    /// Seed of the made-up room
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Width and height of the pictures, pixels; default: those of the scene, 256x192 for the room
    #[arg(long, value_name = "WxH", conflicts_with = "scene")]
    pub(crate) size: Option<PixelSize>,
    /// Only these sweeps (comma-separated or repeated); default: all
    #[arg(long, value_enum, value_name = "SWEEP", value_delimiter = ',')]
    pub(crate) sweeps: Vec<SweepArg>,
    /// Views, the held-out one among them
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=16))]
    pub(crate) views: u32,
    /// Times, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=97))]
    pub(crate) times: u32,
    /// Timed passes over all pictures, after one that is not timed
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repeats: u32,
    /// Graphics adapters to measure beside the processor, by number or name
    #[arg(long, value_name = "ADAPTER", value_delimiter = ',')]
    pub(crate) adapters: Vec<String>,
    /// Folder that receives table and figure; default: <work>/bench/splats
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Width and height of drawn pictures, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PixelSize(pub(crate) [u32; 2]);

impl std::str::FromStr for PixelSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse().ok().filter(|side| (1..=8192).contains(side));
        let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
        sides
            .map(Self)
            .ok_or_else(|| "write <width>x<height>, each 1 to 8192, for example 256x192".to_owned())
    }
}

/// A display colour, red, green and blue from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Background(pub(crate) [f32; 3]);

impl std::str::FromStr for Background {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let colour = match text {
            "black" => Some([0.0; 3]),
            "white" => Some([1.0; 3]),
            text => {
                let channels: Option<Vec<f32>> =
                    text.split(',').map(|value| value.trim().parse().ok()).collect();
                channels.and_then(|channels| channels.try_into().ok())
            }
        };
        let is_shown = |colour: &[f32; 3]| colour.iter().all(|value| (0.0..=1.0).contains(value));
        let hint = "write black, white, or three numbers from 0 to 1, for example 0.5,0.5,0.5";
        colour.filter(is_shown).map(Self).ok_or_else(|| hint.to_owned())
    }
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
    /// Which sentences are judged
    #[arg(long, value_enum, default_value = "queries")]
    pub(crate) set: JudgedSetArg,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Which sentences are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum JudgedSetArg {
    /// The queries that count: the headline
    Queries,
    /// Queries of two categories
    Composites,
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
    /// Which sentences are judged
    #[arg(long, value_enum, default_value = "queries")]
    pub(crate) set: JudgedSetArg,
    /// Folder that receives <method>/counts.csv; default: scores, or scores-composites
    #[arg(long, value_name = "DIR")]
    pub(crate) scores: Option<PathBuf>,
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

fn scale(text: &str) -> Result<Scale, String> {
    let found = Scale::ALL.into_iter().find(|scale| scale.as_str() == text);
    found.ok_or_else(|| format!("`{text}` is no scale: use outdoor, room or tabletop"))
}

fn set_split(text: &str) -> Result<SetSplit, String> {
    match text {
        "private" => Ok(SetSplit::Private),
        "dev" => Ok(SetSplit::Dev),
        _ => Err("must be `private` or `dev`: there is one test set, the benchmark".to_owned()),
    }
}
