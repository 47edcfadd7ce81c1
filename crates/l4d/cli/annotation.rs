//! Command-line arguments of the verbs around queries and their annotation: check-queries, stats, open-round,
//! verify-prompts, import-ballot, verdict. Runs none of them.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{BenchArgs, number};
use crate::shipped;

#[derive(Debug, Args)]
pub(crate) struct CheckQueriesArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Also compare with the set in this benchmark folder: sentences, predicates, places, and what a memory of it finds
    #[arg(long, value_name = "BENCH")]
    pub(crate) against: Option<PathBuf>,
    /// Also write id, words and categories of every query that counts, without what they mean: for who wants to stay blind
    #[arg(long, value_name = "FILE")]
    pub(crate) public: Option<PathBuf>,
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
    pub(crate) out: Option<PathBuf>,
    /// Replace files that l4d did not write
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
    /// Who votes (comma-separated or repeated), as many as the panel has
    #[arg(long, value_name = "NAME", value_delimiter = ',', required_unless_present = "pack")]
    pub(crate) annotators: Vec<String>,
    /// Write the page with which this annotator of an open round votes in a browser, without l4d and without a network
    #[arg(long, value_name = "ANNOTATOR")]
    pub(crate) pack: Option<String>,
    /// The page; default: <round>-<annotator>.html
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Folder of the rendered scenes; default: data/<profile of the round>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Which queries are asked about
    #[arg(long, value_enum, default_value = "candidate")]
    pub(crate) queries: AskedArg,
    /// Ask again what this earlier round did not find valid, once text or truth was edited
    #[arg(long, value_name = "ROUND")]
    pub(crate) from: Option<String>,
    /// Only so many of them, drawn by lot, evenly from the categories
    #[arg(long, value_name = "COUNT")]
    pub(crate) sample: Option<usize>,
    /// Leave out the prompts that people rejected and that still have the same words, instead of refusing
    #[arg(long)]
    pub(crate) edited_only: bool,
    /// Queries of two categories as well
    #[arg(long)]
    pub(crate) composites: bool,
    /// How many annotators there have to be: all of them must be right before a prompt counts as understood
    #[arg(long, value_name = "COUNT", default_value_t = 5)]
    pub(crate) panel: usize,
    /// How many views annotators may look at
    #[arg(long, value_name = "COUNT", default_value_t = 5)]
    pub(crate) view_count: usize,
    /// Control items as a share of the queries: sentences that mean nothing, and prompts that only name a category
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, value_parser = number::<f64>(0.0..=1.0))]
    pub(crate) gold: f64,
    /// Prompts that are asked twice, as a share of the queries
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = number::<f64>(0.0..=1.0))]
    pub(crate) repeats: f64,
    /// Seed of ids, control items and orders
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// The annotators are programs: the round never counts as verification by people
    #[arg(long)]
    pub(crate) simulated: bool,
    /// Replace a round of this name without votes
    #[arg(long)]
    pub(crate) force: bool,
}

/// How pictures are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureArg {
    /// What the terminal can do best: pixels of sixel, kitty or iTerm2, or characters
    Auto,
    /// Characters, in every terminal
    Halfblocks,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyPromptsArgs {
    /// Name of the round
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
pub(crate) struct ImportBallotArgs {
    /// What the page of `l4d open-round --pack` saved, sealed
    pub(crate) file: PathBuf,
    /// Folder of all rounds
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder of the rendered scenes; default: data/<profile of the round>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct VerdictArgs {
    /// Name of the round
    pub(crate) round: String,
    /// Folder of all rounds
    #[arg(long, value_name = "DIR", default_value = "annotation/rounds")]
    pub(crate) rounds: PathBuf,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// Only look, before all ballots are sealed: nothing is written
    #[arg(long)]
    pub(crate) unsealed: bool,
    /// Derive the files again and compare: nothing is written
    #[arg(long)]
    pub(crate) check: bool,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
