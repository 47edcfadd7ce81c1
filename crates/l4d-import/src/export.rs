//! A scene, rendered or captured, in the layouts that other trainers read.
//!
//! Owns which layout holds what of a scene, and what has to be said where it cannot hold all of it. Pictures are
//! display colours; points come from the depth of training cameras or from a reconstruction. Of the held-out camera an
//! export shows what the request allows and nothing else: by default its pose, with a grey picture where a reader insists
//! on one.

mod annotated;
mod cloud;
mod coco;
mod colmap;
mod davis;
mod dynerf;
mod judged;
mod manifest;
mod nerfstudio;
mod panoptic;
mod views;

use std::path::Path;

use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::reader::Reader;
use l4d_data::{Camera, DataError};
use serde::Deserialize;
use strum::VariantNames as _;

pub use self::manifest::{Called, Exported, Manifest};

use crate::annotations::QueriesWithTruth;

use self::manifest::Folder;
use self::views::SceneViews;

/// Most points of a cloud by default: what 4DGaussians itself reduces Neu3D's clouds to.
pub const DEFAULT_POINTS: usize = 40_000;
/// Pixels by which a principal point may miss the centre.
const CENTRE_TOLERANCE_PX: f64 = 1e-6;

/// A layout of another tool.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, strum::Display, strum::EnumString, strum::EnumIter, strum::VariantNames,
)]
#[strum(serialize_all = "lowercase", parse_err_ty = String, parse_err_fn = unknown)]
pub enum Format {
    /// 4DGaussians, its reader `PanopticSports`: keeps size, principal point and split.
    #[strum(serialize = "4dgaussians")]
    FourDGaussians,
    /// 4DGaussians, its reader `dynerf`.
    #[strum(serialize = "4dgaussians-dynerf")]
    Dynerf,
    /// 4D LangSplat: as `dynerf`, with exactly 300 frames.
    #[strum(serialize = "4d-langsplat")]
    FourDLangSplat,
    /// LangSplat: a COLMAP model a frame.
    LangSplat,
    /// A `transforms.json` a frame.
    Nerfstudio,
    /// A COLMAP model a frame.
    Colmap,
    /// Instances as COCO annotations.
    Coco,
    /// Instances as palette pictures.
    Davis,
    /// The truth of the held-out camera for 4D LangSplat's evaluator.
    #[strum(serialize = "4d-langsplat-annotations")]
    FourDLangSplatAnnotations,
    /// The truth of the held-out camera for LangSplat's evaluator.
    #[strum(serialize = "lerf-ovs")]
    LerfOvs,
}

fn unknown(text: &str) -> String {
    format!("unknown format `{text}`: use one of {}", Format::VARIANTS.join(", "))
}

impl Format {
    /// Whether it holds points of surfaces.
    fn holds_points(self) -> bool {
        !self.holds_masks() && !self.needs_truth()
    }

    /// Whether it holds depth, where the scene has some.
    fn holds_depth(self) -> bool {
        self == Self::Nerfstudio
    }

    /// Whether it holds truth, so that a request has to bring some.
    pub fn needs_truth(self) -> bool {
        matches!(self, Self::FourDLangSplatAnnotations | Self::LerfOvs)
    }

    /// Which reader of 4DGaussians it is made for.
    fn reader(self) -> Option<Reader> {
        match self {
            Self::FourDGaussians => Some(Reader::Panoptic),
            Self::Dynerf | Self::FourDLangSplat => Some(Reader::Dynerf),
            _ => None,
        }
    }

    /// Whether it shows which pixels are whose.
    fn holds_masks(self) -> bool {
        matches!(self, Self::Coco | Self::Davis)
    }
}

/// What an export may show of the held-out camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::Display, Deserialize)]
#[strum(serialize_all = "lowercase")]
#[serde(rename_all = "lowercase")]
pub enum HeldOut {
    /// Nothing, not even where it is.
    Nothing,
    /// Where it is, so that a trained model can be drawn from there; grey where a reader insists on a picture.
    Pose,
    /// Its pictures too, in the test split: the export measures errors by itself, and must not be trained on whole.
    Pictures,
}

/// Where a scene comes from.
#[derive(Debug, Clone, Copy)]
pub enum Origin<'a> {
    /// Rendered here: colours, depth and ids.
    Rendered(&'a SceneDir),
    /// Recorded by others: colours, masks where people drew them, points where the source had some.
    Captured(&'a CaptureDir),
}

/// What is exported to where.
#[derive(Debug, Clone, Copy)]
pub struct ExportRequest<'a> {
    pub origin: Origin<'a>,
    pub format: Format,
    /// Folder that receives it: empty, missing, or from an earlier export of the same scene and format.
    pub out: &'a Path,
    /// Numbers of moments; all that the scene has if empty.
    pub frames: &'a [u32],
    /// What of the held-out camera is shown.
    pub held_out: HeldOut,
    /// Most points of a cloud.
    pub points: usize,
    /// Folder of a COLMAP model in the world of the scene, whose points take the place of all others.
    pub points_from: Option<&'a Path>,
    /// Queries and truth, for the formats that hold them.
    pub judged: Option<&'a QueriesWithTruth<'a>>,
}

impl<'a> ExportRequest<'a> {
    /// All moments of a scene, the pose of the held-out camera, and as many points as usual.
    pub fn new(origin: Origin<'a>, format: Format, out: &'a Path) -> Self {
        let (held_out, points) = (HeldOut::Pose, DEFAULT_POINTS);
        Self { origin, format, out, frames: &[], held_out, points, points_from: None, judged: None }
    }
}

/// Exports a scene; `tick` is called for each picture that was written.
///
/// # Errors
/// A scene that is torn, a folder that holds something else, and a format that cannot hold the scene.
pub fn export(request: ExportRequest<'_>, tick: &(dyn Fn() + Sync)) -> Result<Exported, DataError> {
    let views = SceneViews::open(&request)?;
    let write = match request.format {
        Format::FourDGaussians => panoptic::write,
        Format::Dynerf | Format::FourDLangSplat => dynerf::write,
        Format::LangSplat | Format::Colmap => colmap::write,
        Format::Nerfstudio => nerfstudio::write,
        Format::Coco => coco::write,
        Format::Davis => davis::write,
        Format::FourDLangSplatAnnotations | Format::LerfOvs => judged::write,
    };
    let job = Job { request, views: &views, tick };
    check(&job)?;
    let folder = Folder::claim(&request, &views)?;
    let mut manifest = write(&job, Manifest::new(&request, &views)?)?;
    manifest.note_depth();
    folder.settle(manifest)
}

/// Refuses a scene that the layout cannot hold, before anything is written.
fn check(job: &Job<'_>) -> Result<(), DataError> {
    match job.request.format {
        Format::Dynerf | Format::FourDLangSplat => dynerf::check(job),
        Format::LangSplat => colmap::check_centres(job),
        Format::Coco | Format::Davis => annotated::cameras(job.views).map(drop),
        Format::FourDLangSplatAnnotations | Format::LerfOvs => judged::camera(job).map(drop),
        Format::FourDGaussians | Format::Nerfstudio | Format::Colmap => Ok(()),
    }
}

/// How many pictures an export of so many frames writes: the length of a progress bar.
///
/// # Errors
/// A scene that is torn.
pub fn picture_count(request: &ExportRequest<'_>) -> Result<u64, DataError> {
    let views = SceneViews::open(request)?;
    Ok((views.shown().len() * views.frames.len()) as u64)
}

/// All that a layout needs.
struct Job<'a> {
    request: ExportRequest<'a>,
    views: &'a SceneViews,
    tick: &'a (dyn Fn() + Sync),
}

/// Whether a principal point is the centre of the picture: many readers drop it.
fn is_centred(views: &SceneViews, camera: &Camera) -> bool {
    let [width, height] = views.size.map(f64::from);
    (camera.cx - width / 2.0).abs() <= CENTRE_TOLERANCE_PX
        && (camera.cy - height / 2.0).abs() <= CENTRE_TOLERANCE_PX
}

/// A layout whose reader drops principal points.
fn off_centre(views: &SceneViews, camera: &Camera) -> DataError {
    let message = format!("the principal point of {} is not the centre, and readers drop it", camera.name);
    limit(views, "cx", message)
}

/// A layout that cannot hold a scene.
fn limit(views: &SceneViews, field: &str, message: impl Into<String>) -> DataError {
    let hint = "use `--format 4dgaussians` or `--format colmap`, which hold any camera";
    views.wrong(&format!("field `{field}`"), message.into(), hint)
}
