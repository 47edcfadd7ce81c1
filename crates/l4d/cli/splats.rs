//! Grammar of the verbs around splats: train-splats, render-splats, view, bench splats.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use l4d_data::Profile;
use l4d_data::reader::Reader;
use l4d_solve::clips::{DepthFormat, DepthKind};
use l4d_splat::ShDegree;
use l4d_splat::source::ReaderOptions;
use l4d_splat::speed::Sweep;
use l4d_splat::training_run::Preset;

use super::solver::{BenchLiftArgs, MethodArgs, WorkArgs};
use super::{number, one_of};
use crate::shipped;

#[derive(Debug, Args)]
pub(crate) struct TrainSplatsArgs {
    /// Scene to learn
    pub(crate) scene: String,
    /// Pictures that are trained on, and where things are by default: tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    /// Folder of the benchmark: which scenes there are
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// Folder that receives the model; default: <work>/<profile>/<scene>/splats
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Learn from rendered depth too: where things are and what moves is then known, and methods that use the model are
    /// ranked in the track colour + depth. Otherwise depth is found by comparing pictures
    #[arg(long)]
    pub(crate) depth: bool,
    /// Begin at the points of COLMAP's points3D.txt or points3D.bin in place of the surfaces that depth shows
    #[arg(long, value_name = "FILE")]
    pub(crate) points: Option<PathBuf>,
    /// Make squares of N x N pixels of a capture's pictures one pixel
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) shrink: u32,
    /// Train on every N-th moment of a capture
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    /// Whose schedule and learning rates: ours, or those that 4DGaussians published for DyNeRF, which take an hour and more
    /// here; the options below change either
    #[arg(long, default_value = "l4d", value_parser = one_of::<Preset>(["l4d", "4dgaussians"]))]
    pub(crate) preset: Preset,
    /// Most Gaussians; default: 5000 (tiny), 18000 (small), 40000 (real), 60000 (full)
    #[arg(long, value_name = "N")]
    pub(crate) gaussians: Option<usize>,
    /// Degree of the spherical harmonics, 0 to 3: how much a colour may depend on direction; default: 1
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(0..=3))]
    pub(crate) sh_degree: Option<u8>,
    /// Share of moments at which a place has to be seen through, or to have another colour, before it counts as dynamic;
    /// 0: everything is dynamic, 1.1: nothing is; default: 0.05, 0.2 (real)
    #[arg(long, value_name = "SHARE", value_parser = number::<f32>(0.0..))]
    pub(crate) dynamic_threshold: Option<f32>,
    /// Iterations on what stands still; default: 400 (tiny), 1000 (others)
    #[arg(long, value_name = "N")]
    pub(crate) coarse: Option<u64>,
    /// Iterations for each step in which the clip is unfolded from one moment to its ends; default: 30 (tiny), 20 (others)
    #[arg(long, value_name = "N")]
    pub(crate) unfold: Option<u64>,
    /// Iterations on the whole clip; default: 1000 (tiny), 4000 (small, real), 12000 (full)
    #[arg(long, value_name = "N")]
    pub(crate) fine: Option<u64>,
    /// Views of one moment that an iteration looks at; default: 2
    #[arg(long, value_name = "N")]
    pub(crate) views_per_iteration: Option<usize>,
    /// What an error of depth costs beside one of colour, with --depth; default: 0.1
    #[arg(long, value_name = "WEIGHT", value_parser = number::<f32>(0.0..))]
    pub(crate) depth_weight: Option<f32>,
    /// Stop after so many looks at the training pictures (one every 500 iterations) without progress; 0: never early;
    /// default: 3
    #[arg(long, value_name = "N")]
    pub(crate) patience: Option<usize>,
    /// Seed of everything random
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Seconds between checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = number::<f64>(0.0..=1e6))]
    pub(crate) checkpoint_seconds: f64,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
    /// Replace a model that has other settings or pictures
    #[arg(long)]
    pub(crate) force: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RenderSplatsArgs {
    /// Scene whose model, cameras and size are meant; not needed with --splats and --cameras
    #[arg(required_unless_present_all = ["splats", "cameras"])]
    pub(crate) scene: Option<String>,
    /// Frames that are drawn, and where things are by default: tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// A checkpoint of train-splats, a model of 4DGaussians or 4D LangSplat (folder or chkpnt*.pth), a .pt of gsplat, or a PLY
    /// of 3DGS; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) splats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
    /// Other cameras: JSON with width, height and cameras as in scene.json
    #[arg(long, value_name = "JSON")]
    pub(crate) cameras: Option<PathBuf>,
    /// Only these views (comma-separated or repeated); default: all training views
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) views: Vec<String>,
    /// One camera in their place that moves along their arc over the clip and looks at what they look at
    #[arg(long)]
    pub(crate) orbit: bool,
    /// One camera in their place that flies from view to view over the clip, for example cam00,cam05,cam02
    #[arg(long, value_name = "VIEW", value_delimiter = ',')]
    pub(crate) path: Vec<String>,
    /// Only these frames; default: those of the profile, or those of the capture that the model was trained on
    #[arg(long, value_name = "FRAME", value_delimiter = ',')]
    pub(crate) frames: Vec<u32>,
    /// Times instead of frames, 0 (start of the clip) to 1 (its end); those of the model where nothing says when it saw frames
    #[arg(long, value_name = "TIME", value_delimiter = ',', value_parser = number::<f32>(0.0..=1.0))]
    pub(crate) times: Vec<f32>,
    /// Width and height of the pictures, pixels; default: those of the cameras, or those that the model was trained on
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<PixelSize>,
    /// Which depth is written: where half of the pixel is filled, which keeps edges (median); the mean of the depths that a
    /// pixel shows; or sum of depth x weight, as 4DGaussians, which is too near wherever a pixel is not filled
    #[arg(long, default_value = "median", value_parser = one_of::<DepthKind>(["median", "expected", "sum"]))]
    pub(crate) depth: DepthKind,
    /// How depth is stored: OpenEXR with depth in metres, alpha and spread, or 16-bit PNG in millimetres
    #[arg(long, default_value = "exr", value_parser = one_of::<DepthFormat>(["exr", "png"]))]
    pub(crate) depth_format: DepthFormat,
    /// What shows where nothing is: black, white or red,green,blue from 0 to 1; default: what the model says, or black
    #[arg(long, value_name = "COLOUR")]
    pub(crate) background: Option<Background>,
    /// Folder that receives the clips; default: <work>/<profile>/<scene>/clips, or flight for --orbit and --path
    #[arg(long, short, value_name = "DIR", required_unless_present = "scene")]
    pub(crate) out: Option<PathBuf>,
    /// Also write what the Gaussians mean, of models of 4D LangSplat: <out>/language/<view>/<moment>.npy, as its render.py
    #[arg(long)]
    pub(crate) language: bool,
    /// Also write a moving picture of all views: MP4 where ffmpeg is at hand, else an animated PNG
    #[arg(long)]
    pub(crate) preview: bool,
    #[command(flatten)]
    pub(crate) adapter: AdapterArgs,
    /// Replace clips of another model or other settings
    #[arg(long)]
    pub(crate) force: bool,
}

/// A scene and what a page shows of it.
#[derive(Debug, Clone, Args)]
pub(crate) struct ShownArgs {
    /// Scene to look at
    pub(crate) scene: String,
    /// Folder of the benchmark: boxes, tracks, events, sentences and the truth come from it, where it has them
    #[arg(long, value_name = "DIR", default_value_os = shipped::benchmark())]
    pub(crate) bench: PathBuf,
    /// Pictures and masks that are shown, and where things are by default: tiny, small or full; real for captures
    #[arg(long, default_value = "small")]
    pub(crate) profile: Profile,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// A checkpoint of train-splats, or a model of others as for render-splats; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) splats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
    /// Folder with one folder a method, for --methods
    #[arg(long, value_name = "DIR", default_value = "results")]
    pub(crate) results: PathBuf,
    /// Methods whose masks are shown beside the truth, at most three (comma-separated or repeated); default: none
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Leave out the pictures, depth and ids of the cameras: the page is smaller and written faster
    #[arg(long)]
    pub(crate) no_pictures: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    #[command(flatten)]
    pub(crate) shown: ShownArgs,
    /// Page to write; default: <work>/<profile>/<scene>/view.html
    #[arg(long, short, value_name = "HTML")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a page that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Clone, Args)]
pub(crate) struct ServeArgs {
    #[command(flatten)]
    pub(crate) shown: ShownArgs,
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// Port on this machine; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 4420)]
    pub(crate) port: u16,
}

/// What a model of others does not say itself.
#[derive(Debug, Clone, Args)]
pub(crate) struct ReaderArgs {
    /// Reader of 4DGaussians that a model was trained with: it decides when moments are, and panoptic draws at degree 0 over
    /// black; default: what the l4d-export.json of its data says
    #[arg(long, value_name = "READER", value_parser = one_of::<Reader>(["panoptic", "dynerf", "multipleview", "nerfies"]))]
    reader: Option<Reader>,
    /// Draw harmonics of models of others up to this degree, 0 to 3; default: what the reader draws, or all
    #[arg(long, value_name = "DEGREE", value_parser = clap::value_parser!(u8).range(0..=3))]
    sh_degree: Option<u8>,
    /// Draw nothing that is nearer to the camera than this, units of the model's world; default: 0.01 for models of gsplat,
    /// simple_trainer and splatfacto, 0.2 for all others, as in their training
    #[arg(long, value_name = "UNITS", value_parser = number::<f32>(1e-6..=1e6))]
    near: Option<f32>,
}

impl ReaderArgs {
    pub(crate) fn options(&self) -> ReaderOptions {
        let sh_degree = self.sh_degree.and_then(ShDegree::new);
        ReaderOptions { reader: self.reader, sh_degree, near_m: self.near }
    }
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
    Lift(BenchLiftArgs),
}

const SWEEPS: [&str; 3] = ["count", "resolution", "rasterizer"];

#[derive(Debug, Args)]
pub(crate) struct BenchSplatsArgs {
    /// Scene whose model is drawn and whose held-out pictures it is compared with; default: a made-up room
    pub(crate) scene: Option<String>,
    /// tiny, small or full
    #[arg(long, default_value = "small", value_parser = super::rendered)]
    pub(crate) profile: Profile,
    #[command(flatten)]
    pub(crate) work: WorkArgs,
    /// The model; default: <work>/<profile>/<scene>/splats
    #[arg(long, value_name = "PATH")]
    pub(crate) splats: Option<PathBuf>,
    /// Gaussians of the made-up room
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    pub(crate) gaussians: u32,
    /// Seed of the made-up room
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Width and height of the pictures, pixels; default: those of the scene, 256x192 for the room
    #[arg(long, value_name = "WxH")]
    pub(crate) size: Option<PixelSize>,
    /// Only these changes (comma-separated or repeated); default: all. Fewer Gaussians (count), smaller pictures (resolution),
    /// other instructions, one thread or graphics adapters (rasterizer)
    #[arg(long, value_name = "SWEEP", value_delimiter = ',', value_parser = one_of::<Sweep>(SWEEPS))]
    pub(crate) sweeps: Vec<Sweep>,
    /// Views, the held-out one among them
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=16))]
    pub(crate) view_count: u32,
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
    /// Replace files that l4d did not write
    #[arg(long)]
    pub(crate) force: bool,
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
                let channel = number::<f32>(0.0..=1.0);
                let channels: Option<Vec<f32>> =
                    text.split(',').map(|value| channel(value.trim()).ok()).collect();
                channels.and_then(|channels| channels.try_into().ok())
            }
        };
        let hint = "write black, white, or three numbers from 0 to 1, for example 0.5,0.5,0.5";
        colour.map(Self).ok_or_else(|| hint.to_owned())
    }
}
