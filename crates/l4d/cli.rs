//! The grammar of the command line, and nothing else. What all groups of verbs share is here.

pub(crate) mod annotation;
mod applies;
pub(crate) mod cluster;
pub(crate) mod given;
mod help;
pub(crate) mod interop;
pub(crate) mod judging;
pub(crate) mod models;
pub(crate) mod publishing;
pub(crate) mod scenes;
mod settings;
pub(crate) mod solver;
pub(crate) mod splats;

use std::ffi::OsString;
use std::ops::{Bound, RangeBounds};
use std::path::PathBuf;
use std::str::FromStr;

use anyhow::Result;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use clap_complete::Shell;
use l4d_data::Profile;
use serde::de::value::Error as ValueError;
use serde::de::{DeserializeOwned, IntoDeserializer};

use self::annotation::{
    CheckQueriesArgs, ImportBallotArgs, OpenRoundArgs, StatsArgs, VerdictArgs, VerifyPromptsArgs,
};
use self::cluster::ClusterCommand;
use self::given::Given;
use self::interop::{ExportArgs, ImportArgs, ImportSceneArgs};
use self::judging::{BaselineArgs, CheckResultsArgs, InitResultsArgs, LeaderboardArgs, ScoreArgs};
use self::models::{ProposePromptsArgs, ProposeScenesArgs};
use self::publishing::{DownloadArgs, HostCommand, ReleaseArgs};
use self::scenes::{
    ArrangeArgs, BuildScenesArgs, CheckScenesArgs, ComposeArgs, DoctorArgs, PythonArgs, SheetArgs,
};
use self::solver::{AblateArgs, QueryArgs, SolveArgs};
use self::splats::{BenchCommand, RenderSplatsArgs, ServeArgs, TrainSplatsArgs, ViewArgs};
use crate::shipped;

/// Benchmark and dataset toolkit for 4D language grounding.
#[derive(Debug, Parser)]
#[command(name = "l4d", version, about, max_term_width = 110, propagate_version = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: GlobalArgs,
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// Reads a command line with the folders that it names, and refuses what does not apply to what it chooses.
    ///
    /// # Errors
    /// A `clap::Error`, which may be help that was asked for, and options that do not apply.
    pub(crate) fn read(line: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> Result<(Self, Given)> {
        let mut command = settings::with_defaults(help::with_help(Self::command()))?;
        let matches = command.try_get_matches_from_mut(line)?;
        applies::check(&command, &matches)?;
        let given = Given::of(&command, &matches);
        let cli = Self::from_arg_matches(&matches).map_err(|error| error.format(&mut command))?;
        Ok((cli, given))
    }
}

#[derive(Debug, Args)]
pub(crate) struct GlobalArgs {
    /// Say nothing but data, warnings and errors
    #[arg(long, short, global = true, display_order = 990)]
    pub(crate) quiet: bool,
    /// Say more on stderr (RUST_LOG refines it)
    #[arg(long, short, global = true, display_order = 991)]
    pub(crate) verbose: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// Folder that receives l4d.1, l4d-solve.1 and so on
    #[arg(long, short, value_name = "DIR", default_value = "man")]
    pub(crate) out: PathBuf,
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// The whole flow on one tiny scene: render, check, baselines, scores, leaderboard
    Quickstart(QuickstartArgs),
    /// What this machine has and lacks, one line each, with the hint
    Doctor(DoctorArgs),
    /// Render scenes with Blender: RGB, depth and instance ids from many cameras
    BuildScenes(BuildScenesArgs),
    /// Check rendered scenes: file contract, digests, visibility, geometry across views
    CheckScenes(CheckScenesArgs),
    /// Draw a contact sheet of a scene: views, moments, outlines, queries
    Sheet(SheetArgs),
    /// Compose new scenes with proved queries from seeds: training sets, private tests
    Compose(ComposeArgs),
    /// Render furnished places filled with drawn things: pictures to learn from
    Arrange(ArrangeArgs),
    /// Prove that each query has exactly one referent and real distractors
    CheckQueries(CheckQueriesArgs),
    /// Numbers, tables and figures of the set: comparison, words, sizes, visibility, motion, intervals
    Stats(StatsArgs),
    /// Let a vision model propose queries: proved candidates, and all others with the reasons
    ProposePrompts(ProposePromptsArgs),
    /// Let a language model propose scenes: specs that keep the rules, for people to build
    ProposeScenes(ProposeScenesArgs),
    /// Draw a round of annotation: what is asked of whom, with control items and repeats
    OpenRound(OpenRoundArgs),
    /// Vote in a round: read a prompt, find what it means, in a terminal
    VerifyPrompts(VerifyPromptsArgs),
    /// Take in the ballot that an annotator sealed in a browser
    ImportBallot(ImportBallotArgs),
    /// Judge a round: valid prompts, agreement, what to refine; sets the status of the queries
    Verdict(VerdictArgs),
    /// Learn a 4D model of a scene from its training cameras
    TrainSplats(TrainSplatsArgs),
    /// Draw clips of a model: colour and depth from any cameras at any times
    RenderSplats(RenderSplatsArgs),
    /// Write one page that shows a scene over time: Gaussians, cameras, boxes, events, sentences with masks
    View(ViewArgs),
    /// Show a scene in a browser and answer the sentences that are asked there
    Serve(ServeArgs),
    /// Answer queries with PanopticQuery: clips, grounding, consensus, lifting, masks of the held-out view
    Solve(SolveArgs),
    /// Ask one sentence about one scene: what each stage decides, masks, pictures
    #[command(after_help = "The last line on stdout says what came of it, `answer` of --json the same.\n\
        Exit codes: 0 there is an answer, 1 there is none, 2 failure.")]
    Query(QueryArgs),
    /// Run the ablations of the paper: consensus, views, models, composites, scales
    Ablate(AblateArgs),
    /// Write a scene in the layout of another tool
    Export(ExportArgs),
    /// Read a capture that others recorded
    ImportScene(ImportSceneArgs),
    /// Take in results of other methods: masks, relevancy, latents of LangSplat and its kin
    Import(ImportArgs),
    /// Write the results of baselines that bracket the scale
    Baseline(BaselineArgs),
    /// Begin a folder of results of your own: its method.json, and what is to be filled in
    InitResults(InitResultsArgs),
    /// List every problem of a results folder
    CheckResults(CheckResultsArgs),
    /// Score a folder of methods: mIoU, mAcc, tube IoU, select
    Score(ScoreArgs),
    /// Rank scored methods: CSV tables and figures
    Leaderboard(LeaderboardArgs),
    /// Speed against error: tables and figures
    #[command(subcommand)]
    Bench(BenchCommand),
    /// Freeze a version of the benchmark: archives, tables, checksums, metadata, data sheet
    Release(ReleaseArgs),
    /// Clusters: what the workflow needs to run on one
    #[command(subcommand)]
    Cluster(ClusterCommand),
    /// Bring a release to where the verbs look: benchmark, pictures, trained models
    Download(DownloadArgs),
    /// Write the benchmark in the form of a hosting platform
    #[command(subcommand)]
    Host(HostCommand),
    /// Print what lets a shell complete verbs and options
    Completions(CompletionsArgs),
    /// Write a manual page of each verb
    Man(ManArgs),
}

impl Command {
    /// The grammar as users see it.
    pub(crate) fn grammar() -> clap::Command {
        help::with_help(Cli::command())
    }

    /// What is asked of the benchmark by a verb that needs rendered scenes.
    pub(crate) fn needs_renderings(&self) -> Option<&BenchArgs> {
        match self {
            Self::BuildScenes(args) => Some(&args.bench),
            Self::CheckScenes(args) => Some(&args.bench),
            Self::Sheet(args) => Some(&args.bench),
            Self::Stats(args) => Some(&args.bench),
            Self::ProposePrompts(args) => Some(&args.bench),
            Self::Cluster(ClusterCommand::Init(args)) => Some(&args.bench),
            _ => None,
        }
    }

    /// What to do when the verb was stopped on its way; none for one that deals with that itself.
    pub(crate) fn how_to_go_on(&self) -> Option<&'static str> {
        match self {
            Self::VerifyPrompts(_) | Self::TrainSplats(_) | Self::Serve(_) => None,
            Self::Quickstart(_)
            | Self::BuildScenes(_)
            | Self::Compose(_)
            | Self::Arrange(_)
            | Self::ProposePrompts(_)
            | Self::ProposeScenes(_)
            | Self::RenderSplats(_)
            | Self::Solve(_)
            | Self::Ablate(_)
            | Self::Baseline(_)
            | Self::Release(_)
            | Self::Download(_) => Some("run the same command again: what is finished is kept"),
            _ => Some("run the same command again: nothing is left half-written"),
        }
    }
}

/// Where the benchmark is and what of it is meant.
#[derive(Debug, Clone, Args)]
pub(crate) struct BenchArgs {
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Only these scenes (comma-separated or repeated); default: all
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) scenes: Vec<String>,
}

impl BenchArgs {
    /// How scenes get where a verb looks for them.
    pub(crate) fn build_hint(&self) -> String {
        format!("run `l4d build-scenes --profile {}` first, or choose another --data", self.profile)
    }
}

/// Parses one of some names as what a library calls so in its files.
pub(crate) fn one_of<T>(names: impl Into<PossibleValuesParser>) -> impl TypedValueParser<Value = T>
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    names.into().try_map(|name| T::deserialize(IntoDeserializer::<ValueError>::into_deserializer(name)))
}

/// Parses a finite number of a range: what every argument takes that is a fraction.
pub(crate) fn number<T>(range: impl RangeBounds<f64> + Clone) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + Into<f64> + Copy,
{
    move |text| {
        let fits = |number: f64| number.is_finite() && range.contains(&number);
        let number = text.parse().ok().filter(|&number: &T| fits(number.into()));
        number.ok_or_else(|| {
            let from = match range.start_bound() {
                Bound::Included(least) | Bound::Excluded(least) => format!(" from {least}"),
                Bound::Unbounded => String::new(),
            };
            let to = match range.end_bound() {
                Bound::Included(most) => format!(" to {most}"),
                Bound::Excluded(most) => format!(" to below {most}"),
                Bound::Unbounded => " on".to_owned(),
            };
            format!("write a number{from}{to}")
        })
    }
}

/// A profile of renderings: what verbs take that have no use for captures.
pub(crate) fn rendered(text: &str) -> Result<Profile, String> {
    let profile: Profile = text.parse()?;
    match profile.is_rendered() {
        true => Ok(profile),
        false => Err("real scenes are not rendered: use tiny, small or full".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct QuickstartArgs {
    /// Folder that receives everything: empty, missing, or of an earlier quickstart
    #[arg(long, value_name = "DIR", default_value = "quickstart")]
    pub(crate) out: PathBuf,
    /// Folder of the benchmark
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// Scene to render
    #[arg(long, value_name = "NAME", default_value = "room_playroom")]
    pub(crate) scene: String,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
}

#[cfg(test)]
mod tests {
    use clap::builder::ValueParser;
    use clap::error::ErrorKind;

    use super::*;

    /// Every verb: the words that call it, and its grammar.
    fn verbs(words: &[String], command: &clap::Command, found: &mut Vec<(Vec<String>, clap::Command)>) {
        for verb in command.get_subcommands() {
            verbs(&[words, &[verb.get_name().to_owned()]].concat(), verb, found);
        }
        found.push((words.to_vec(), command.clone()));
    }

    #[test]
    fn no_verb_that_is_stopped_asks_for_force() {
        let line = ["l4d", "import", "generic", "source"];
        let advice = Cli::try_parse_from(line).unwrap().command.how_to_go_on().unwrap();
        assert!(advice.starts_with("run the same command again: "), "{advice}");
    }

    #[test]
    fn no_argument_takes_a_fraction_that_is_no_number_of_its_range() {
        let of_fractions = [
            ValueParser::from(clap::value_parser!(f32)).type_id(),
            ValueParser::from(clap::value_parser!(f64)).type_id(),
            ValueParser::from(clap::value_parser!(splats::Background)).type_id(),
        ];
        let mut all = Vec::new();
        verbs(&["l4d".to_owned()], &Cli::command(), &mut all);
        let mut checked = 0;
        for (words, verb) in all {
            for argument in verb.get_arguments() {
                if !of_fractions.contains(&argument.get_value_parser().type_id()) {
                    continue;
                }
                let flag = argument.get_long().expect("a fraction has a name");
                for wrong in ["NaN", "inf", "-inf", "1e999", "-1", "1,NaN,1", "0.5,0.5,-inf", ""] {
                    let line = words.iter().cloned().chain([format!("--{flag}={wrong}")]);
                    let error = Cli::command().try_get_matches_from(line).unwrap_err();
                    let kinds = [ErrorKind::ValueValidation, ErrorKind::InvalidValue];
                    assert!(kinds.contains(&error.kind()), "{words:?} --{flag}={wrong}: {error}");
                    assert!(error.to_string().contains("write "), "{error}");
                }
                checked += 1;
            }
        }
        assert!(checked >= 11, "{checked} arguments are fractions");
    }
}
