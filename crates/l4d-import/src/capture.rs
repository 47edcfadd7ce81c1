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
mod video;
mod write;

use std::fmt;
use std::path::Path;
use std::str::FromStr;

pub use l4d_data::capture::{CAPTURE, Capture};
use l4d_data::{DataError, Name};

pub(crate) use self::plan::name_of;

/// Who recorded, or what reconstructed the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

impl Source {
    /// All sources, in the order of the documentation.
    pub const ALL: [Self; 5] =
        [Self::Neu3d, Self::InterDigital, Self::HyperNerf, Self::Colmap, Self::Nerfstudio];

    /// Name as written on the command line and in `capture.json`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Neu3d => "neu3d",
            Self::InterDigital => "interdigital",
            Self::HyperNerf => "hypernerf",
            Self::Colmap => "colmap",
            Self::Nerfstudio => "nerfstudio",
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.as_str())
    }
}

impl FromStr for Source {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = || Self::ALL.map(Self::as_str).join(", ");
        Self::ALL
            .into_iter()
            .find(|source| source.as_str() == text)
            .ok_or_else(|| format!("unknown source `{text}`: use one of {}", names()))
    }
}

/// What is read from where.
#[derive(Debug, Clone, Copy)]
pub struct Order<'a> {
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
pub fn import(order: Order<'_>, tick: &(dyn Fn() + Sync)) -> Result<Capture, DataError> {
    let plan = match order.source {
        Source::Neu3d => neu3d::plan(&order)?,
        Source::InterDigital => interdigital::plan(&order)?,
        Source::HyperNerf => hypernerf::plan(&order)?,
        Source::Colmap => colmap::plan(&order)?,
        Source::Nerfstudio => nerfstudio::plan(&order)?,
    };
    write::write(&order, plan, tick)
}
