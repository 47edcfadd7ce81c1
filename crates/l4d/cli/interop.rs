//! Grammar of the verbs that talk to other tools.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use l4d_data::{Name, Profile, Scale};
use l4d_import::capture::Source;
use l4d_import::capture::masks::MaskFormat;
use l4d_import::export::{DEFAULT_POINTS, Format, HeldOut};
use l4d_import::results::codec::Codec;

use super::solver::WorkArgs;
use super::{BenchArgs, one_of};
use crate::shipped;

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// What the files are: a preset (langsplat, langsplat-per-frame, langsplat-masks, langsplat-per-frame-masks,
    /// 4d-langsplat, 4d-langsplat-masks, gaussian-grouping, opengaussian, refersplat, mevis, mevis-rle, davis, r4d,
    /// votsr, generic), or a preset of your own (.toml)
    pub(crate) format: String,
    /// Folder that the preset's template starts from
    pub(crate) source: PathBuf,
    #[command(flatten)]
    pub(crate) bench: BenchArgs,
    /// Name of the method; default: that of the preset
    #[arg(long)]
    pub(crate) name: Option<Name>,
    /// Version of the method, in your own words
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) method_version: String,
    /// Folder that receives one folder a method
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// The method looked at pictures of the held-out view
    #[arg(long)]
    pub(crate) test_view: bool,
    /// The method learned from rendered depth of the training views: it is ranked in the track colour + depth
    #[arg(long)]
    pub(crate) used_depth: bool,
    #[command(flatten)]
    pub(crate) files: ImportFilesArgs,
    #[command(flatten)]
    pub(crate) encoders: ImportEncodersArgs,
    /// Logs with numbers that the method claims; those at their usual place are found
    #[arg(long, value_name = "FILE")]
    pub(crate) claims: Vec<PathBuf>,
    /// Write what could be read, though something could not
    #[arg(long)]
    pub(crate) partial: bool,
    /// Replace results that are under that name
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What takes the place of the preset's words.
#[derive(Debug, Args)]
pub(crate) struct ImportFilesArgs {
    /// Path of a file with named fields, e.g. "{scene}/{frame+1:05}/{text}.png" (docs/import/presets.md)
    #[arg(long, value_name = "PATH")]
    pub(crate) template: Option<String>,
    /// Value of a field of the template that is several things, e.g. iteration=30000
    #[arg(long = "set", value_name = "FIELD=VALUE", value_parser = choice)]
    pub(crate) choices: Vec<(String, String)>,
    /// Leave out files whose name begins so
    #[arg(long, value_name = "TEXT")]
    pub(crate) ignore: Vec<String>,
    /// What a file holds
    #[arg(long, value_parser = one_of::<Codec>(["picture", "array", "latents", "coco-rle", "r4d", "vot"]))]
    pub(crate) codec: Option<Codec>,
    /// What of a picture or array is inside: mask, nonzero, "above 127", "index 3", selected, "relative 0.4", "langsplat 0.4",
    /// "4d-langsplat 0.4"
    #[arg(long, value_name = "RULE")]
    pub(crate) inside: Option<l4d_import::results::inside::Inside>,
    /// Which array of a file with several
    #[arg(long, value_name = "NAME")]
    pub(crate) key: Option<String>,
    /// Which ids mean which sentence: {"<number or sentence>": [ids]}; default: the numbers that the export davis gives objects
    #[arg(long, value_name = "JSON")]
    pub(crate) selections: Option<PathBuf>,
    /// Which frame each rendered picture shows: a number or - a line; default: the n-th the n-th frame of the profile
    #[arg(long, value_name = "FILE")]
    pub(crate) frames: Option<PathBuf>,
    /// COCO annotations whose image ids name the folders (4d-langsplat-masks); default: those of the data set
    #[arg(long, value_name = "JSON")]
    pub(crate) images: Option<PathBuf>,
    /// Number with which the name of the first image begins: 1 in HyperNeRF, 0 in Neu3D
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) images_first: u32,
    /// Bring masks of another size to that of the profile (nearest), where the proportions are the same
    #[arg(long)]
    pub(crate) resize: bool,
}

/// What latents need.
#[derive(Debug, Args)]
pub(crate) struct ImportEncodersArgs {
    /// Sentences as CLIP sees them (docs/import/export_text_embeddings.py)
    #[arg(long, value_name = "NPZ")]
    pub(crate) texts: Option<PathBuf>,
    /// Weights of the autoencoder; {scene} and {frame} are filled in
    #[arg(long, value_name = "PTH")]
    pub(crate) decoder: Option<String>,
    /// Sentences as E5 sees them: gates queries that hold at some times only
    #[arg(long, value_name = "NPZ")]
    pub(crate) time_texts: Option<PathBuf>,
    /// Weights of the autoencoder of time
    #[arg(long, value_name = "PTH")]
    pub(crate) time_decoder: Option<String>,
}

fn choice(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((field, value)) if !field.is_empty() && !value.is_empty() => {
            Ok((field.to_owned(), value.to_owned()))
        }
        _ => Err("write <field>=<value>, for example iteration=30000".to_owned()),
    }
}

/// What an export writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    /// A scene, for another trainer or evaluator.
    Scene(Format),
    /// A trained model, for another viewer.
    Splats(SplatFormat),
}

/// How a trained model is written for other viewers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SplatFormat {
    /// A PLY of 3DGS for each moment.
    Ply,
    /// OpenUSD with time samples.
    Usd,
}

impl FromStr for ExportFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "ply" => Ok(Self::Splats(SplatFormat::Ply)),
            "usd-splats" => Ok(Self::Splats(SplatFormat::Usd)),
            _ => text.parse().map(Self::Scene).map_err(|error: String| format!("{error}, ply, usd-splats")),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// Scene to export
    pub(crate) scene: String,
    /// Layout: 4dgaussians, 4dgaussians-dynerf, 4d-langsplat, langsplat, nerfstudio, colmap, coco, davis; with truth for
    /// evaluators: 4d-langsplat-annotations, lerf-ovs; the trained Gaussians for other viewers: ply, usd-splats (docs/export)
    #[arg(long)]
    pub(crate) format: ExportFormat,
    /// Folder that receives it: empty, missing, or an earlier export of the same kind
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// A checkpoint of train-splats, or a model of others as for render-splats; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) splats: Option<PathBuf>,
    /// Folder of the benchmark: truth for the formats that hold it
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// What is shown of the held-out camera: nothing; where it is, with grey where a reader insists on a picture (pose); or
    /// its pictures, in the test split
    #[arg(long, default_value = "pose", value_parser = one_of::<HeldOut>(["nothing", "pose", "pictures"]))]
    pub(crate) held_out: HeldOut,
    /// Only these frames (comma-separated or repeated); default: all that the scene has
    #[arg(long, value_name = "FRAME", value_delimiter = ',')]
    pub(crate) frames: Vec<u32>,
    /// Most points of a cloud
    #[arg(long, value_name = "N", default_value_t = DEFAULT_POINTS)]
    pub(crate) points: usize,
    /// Folder of a COLMAP model with the cameras of the scene: its points take the place of those from depth
    #[arg(long, value_name = "DIR")]
    pub(crate) points_from: Option<PathBuf>,
    /// Print the manifest as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ImportSceneArgs {
    /// Who recorded it: neu3d, interdigital, hypernerf, colmap, nerfstudio (docs/capture)
    pub(crate) source: Source,
    /// Folder that they gave away
    pub(crate) input: PathBuf,
    /// Name of the scene; default: that of the folder
    #[arg(long)]
    pub(crate) name: Option<Name>,
    /// Folder that receives the capture; default: data/captures/<name>
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Views to hold out (comma-separated or repeated); default: those of the literature
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) held_out: Vec<String>,
    /// First and last moment, as the source counts; default: those of the literature, or all
    #[arg(long, value_name = "FIRST-LAST")]
    pub(crate) moments: Option<Moments>,
    /// Object masks that people drew on the pictures
    #[arg(long, value_name = "PATH")]
    pub(crate) masks: Option<PathBuf>,
    /// What they drew with: a JSON file of COCO instances, a data set folder of 4D LangSplat, or PNG with a number an object
    #[arg(long, value_parser = one_of::<MaskFormat>(["coco", "4d-langsplat", "png"]))]
    pub(crate) masks_format: Option<MaskFormat>,
    /// Folder of a benchmark of real scenes that receives the truth of the masks on the held-out view, to be asked about
    #[arg(long, value_name = "DIR")]
    pub(crate) bench: Option<PathBuf>,
    /// Scale of the scene in tables of scores: tens of metres, a few metres, or about a metre
    #[arg(long, value_parser = one_of::<Scale>(["outdoor", "room", "tabletop"]))]
    pub(crate) scale: Option<Scale>,
    /// Only add masks to a capture that is in --out
    #[arg(long)]
    pub(crate) masks_only: bool,
    /// Replace other masks of the capture, and the truth that was made of them
    #[arg(long)]
    pub(crate) force: bool,
    /// The program that opens videos
    #[arg(long, value_name = "PATH", default_value = "ffmpeg")]
    pub(crate) ffmpeg: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// First and last moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Moments(pub(crate) [u32; 2]);

impl std::str::FromStr for Moments {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let sides =
            text.split_once('-').and_then(|(first, last)| Some([first.parse().ok()?, last.parse().ok()?]));
        sides
            .filter(|[first, last]: &[u32; 2]| first <= last)
            .map(Self)
            .ok_or_else(|| "write <first>-<last>, for example 151-200".to_owned())
    }
}
