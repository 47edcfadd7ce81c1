//! Scenes that others recorded, as l4d takes them: `capture.json` and a picture a view and moment.
//!
//! Owns how captures lie on disk elsewhere and here. A capture has colours and cameras; it has neither depth nor ids,
//! and says so. Its world is that of its reconstruction: neither metres nor the direction up are known unless the
//! source states them.

mod colmap;
mod hypernerf;
mod interdigital;
mod lens;
pub mod masks;
mod nerfstudio;
mod neu3d;
mod plan;
pub mod publish;
mod write;

use std::path::Path;

pub use l4d_data::capture::{CAPTURE, Capture};
use l4d_data::{DataError, Name};
use strum::VariantNames as _;

pub(crate) use self::plan::name_of;

/// Who recorded, or what reconstructed the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, strum::Display, strum::EnumString, strum::VariantNames)]
#[strum(serialize_all = "lowercase", parse_err_ty = String, parse_err_fn = unknown)]
pub enum Source {
    /// Neural 3D Video: `poses_bounds.npy` and a video a camera.
    Neu3d,
    /// The 4x4 rig of InterDigital (Technicolor).
    InterDigital,
    /// Nerfies and HyperNeRF: one or two cameras that move.
    HyperNerf,
    /// COLMAP: a model and its images.
    Colmap,
    /// nerfstudio: `transforms.json`.
    Nerfstudio,
}

fn unknown(text: &str) -> String {
    format!("unknown source `{text}`: use one of {}", Source::VARIANTS.join(", "))
}

/// What is read from where.
#[derive(Debug, Clone, Copy)]
pub struct CaptureRequest<'a> {
    /// Who recorded it.
    pub source: Source,
    /// The folder that they gave away.
    pub input: &'a Path,
    /// Name of the scene here.
    pub name: &'a Name,
    /// Folder that receives the capture.
    pub out: &'a Path,
    /// Views that are held out, as they are called there; default: what the literature holds out.
    pub held_out: &'a [String],
    /// First and last moment, numbers as they are there; default: what the literature takes, or all.
    pub moments: Option<[u32; 2]>,
    /// The program that opens videos.
    pub ffmpeg: &'a Path,
}

/// Reads a capture of another tool and writes it as ours; `tick` is called for each picture.
///
/// # Errors
/// A folder that lacks what the source should have, cameras that cannot be, pictures of several sizes, and views of
/// which no picture is whole.
pub fn import(request: CaptureRequest<'_>, tick: &(dyn Fn() + Sync)) -> Result<Capture, DataError> {
    let plan = match request.source {
        Source::Neu3d => neu3d::plan(&request)?,
        Source::InterDigital => interdigital::plan(&request)?,
        Source::HyperNerf => hypernerf::plan(&request)?,
        Source::Colmap => colmap::plan(&request)?,
        Source::Nerfstudio => nerfstudio::plan(&request)?,
    };
    write::write(&request, plan, tick)
}
