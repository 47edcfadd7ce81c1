//! Grammar of the verbs around rendered scenes: doctor, build-scenes, check-scenes, sheet, compose.

use std::path::PathBuf;

use clap::Args;
use l4d_data::benchmark::SetSplit;
use l4d_data::{Scale, Shard};

use l4d_blender::env::PythonChoice;
use l4d_blender::part::FrameList;
use l4d_data::workspace::SharedWork;

use super::{BenchArgs, one_of};
use crate::shipped;

#[derive(Debug, Args)]
pub(crate) struct DoctorArgs {
    /// Make the Blender environment first, if it is missing
    #[arg(long)]
    pub(crate) setup: bool,
    /// Say what the tests need instead, as `tests/run` installs it
    #[arg(long)]
    pub(crate) tests: bool,
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
    #[arg(long, value_name = "DIR", default_value_os = shipped::blender_scripts())]
    pub(crate) blender_scripts: PathBuf,
    /// Folder for what can be remade (environments, logs)
    #[arg(long, value_name = "DIR", default_value = "work")]
    pub(crate) work: PathBuf,
}

impl PythonArgs {
    pub(crate) fn choice(&self) -> PythonChoice {
        PythonChoice {
            python: self.python.clone(),
            scripts: self.blender_scripts.clone(),
            work: SharedWork::new(&self.work),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct BuildScenesArgs {
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Folder that receives the scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// Only tracks, no picture (writes <bench>/scenes)
    #[arg(long)]
    pub(crate) tracks_only: bool,
    /// Blender processes at once; each uses an equal part of the cores, two at least
    #[arg(long, default_value_t = 1)]
    pub(crate) jobs: usize,
    /// Only these views (comma-separated or repeated), by their names in the scene's cameras, e.g. cam02,cam09
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) views: Vec<String>,
    /// Only these canonical frames, as far as the profile renders them, e.g. 0-24 or 0,12,48 or 0-48:4
    #[arg(long, value_name = "RANGE")]
    pub(crate) frames: Option<FrameList>,
    /// Render part i of n of the pictures that are asked for (a deterministic partition for clusters), e.g. 2/8
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    /// Samples per pixel of the colour pass, before denoising; 0 leaves pictures black and renders depth and ids alone,
    /// which is all that the truth needs; default: 4 (tiny, small), 16 (full)
    #[arg(long, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub(crate) samples: Option<u32>,
    /// Render again what other scripts, seeds or samples rendered before
    #[arg(long)]
    pub(crate) force: bool,
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
    pub(crate) scene: Option<String>,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Folder of the rendered scenes; default: data/<profile>
    #[arg(long, value_name = "DIR")]
    pub(crate) data: Option<PathBuf>,
    /// PNG to write; default: <data>/<scene>/sheet.png, for the overview <data>/overview.png
    #[arg(long, short, value_name = "PNG")]
    pub(crate) out: Option<PathBuf>,
    /// Moments, canonical frames; default: five evenly spaced, in the overview three
    #[arg(long, value_name = "FRAME", value_delimiter = ',')]
    pub(crate) frames: Vec<u32>,
    /// Views; default: the held-out view and two training views
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) views: Vec<String>,
    /// Leave out outlines, numbers and queries
    #[arg(long)]
    pub(crate) plain: bool,
    /// Replace a picture that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ComposeArgs {
    /// Folder of the new set; a set that is there grows
    #[arg(long, short, value_name = "BENCH", required_unless_present = "list")]
    pub(crate) out: Option<PathBuf>,
    /// The first seed, of a private set the first number; training seeds begin with 1000
    #[arg(long, default_value_t = 1000)]
    pub(crate) seed: u64,
    /// How many scenes, each of the next seed
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) count: u32,
    /// outdoor, room or tabletop; default: in turn
    #[arg(long, value_parser = one_of::<Scale>(Scale::ALL.map(Scale::as_str)))]
    pub(crate) scale: Option<Scale>,
    /// What the set is for: train, dev (seeds below 1000) or private (with --secret)
    #[arg(long, default_value = "train", value_parser = one_of::<SetSplit>(["train", "dev", "private"]))]
    pub(crate) split: SetSplit,
    /// File of random bytes from which the seeds of a private set come; who has it can compose the set again
    #[arg(long, value_name = "FILE")]
    pub(crate) secret: Option<PathBuf>,
    /// Compositions of the same split, or scenarios of `l4d propose-scenes`, whose nouns, verbs and scale are demanded, a
    /// scene each, of the next seed (comma-separated or repeated)
    #[arg(long, value_name = "JSON", value_delimiter = ',')]
    pub(crate) spec: Vec<PathBuf>,
    /// Where it happens; default: drawn
    #[arg(long)]
    pub(crate) place: Option<String>,
    /// What kind of things happen; default: drawn
    #[arg(long)]
    pub(crate) theme: Option<String>,
    /// Nouns that have to be there (comma-separated or repeated)
    #[arg(long = "category", value_name = "NOUN", value_delimiter = ',')]
    pub(crate) categories: Vec<String>,
    /// Verbs that have to happen (comma-separated or repeated)
    #[arg(long = "verb", value_name = "VERB", value_delimiter = ',')]
    pub(crate) verbs: Vec<String>,
    /// A benchmark whose sentences are not used
    #[arg(long, value_name = "BENCH")]
    pub(crate) avoid: Option<PathBuf>,
    /// Draws of a seed that are tried before it is given up
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) draws: u32,
    /// Compose again what was changed since it was composed
    #[arg(long)]
    pub(crate) force: bool,
    /// Print the themes with their places, nouns and verbs instead
    #[arg(long)]
    pub(crate) list: bool,
    /// Blender processes at once
    #[arg(long, default_value_t = 1)]
    pub(crate) jobs: usize,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ArrangeArgs {
    /// Folder of the pictures; arrangements that are there are kept
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// The first seed; training seeds begin with 1000
    #[arg(long, default_value_t = 100_000)]
    pub(crate) seed: u64,
    /// How many seeds; each is laid out three times
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) count: u64,
    /// Pictures of each layout
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=17))]
    pub(crate) view_count: u32,
    /// Light samples a pixel
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) samples: u32,
    /// Blender processes at once
    #[arg(long, default_value_t = 1)]
    pub(crate) jobs: usize,
    #[command(flatten)]
    pub(crate) python: PythonArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
