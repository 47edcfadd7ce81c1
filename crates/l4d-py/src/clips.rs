//! Folders of clips, as `l4d render-splats` and `l4d solve` keep them.
//!
//! Reads what docs/splats.md says of `manifest.json`, and nothing that it does not need.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::UVec2;
use l4d_data::store::read_bounded;
use l4d_data::truth::frame_key;
use l4d_data::{self as data, DataError, Name, json};
use l4d_frames::drawn::{decode_colour, decode_depth_png};
use l4d_frames::exr::decode_depth;
use l4d_masks::Mask;
use pyo3::prelude::*;
use rayon::prelude::*;
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::camera::Camera;
use crate::error::{Failure, Result, unknown};
use crate::splats::{PictureClip, Values};

const SCHEMA: &str = "l4d/clips/1";
/// No file of a picture is larger, bytes.
const MAX_BYTES: u64 = 1 << 30;
const HINT: &str = "delete the file and run `l4d render-splats` again";

#[derive(Deserialize)]
struct Manifest {
    schema: String,
    drawn: Look,
    views: BTreeMap<Name, View>,
}

#[derive(Deserialize)]
struct Look {
    width: u32,
    height: u32,
    depth: DepthEntry,
}

#[derive(Deserialize)]
struct DepthEntry {
    kind: String,
    format: DepthFormat,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum DepthFormat {
    Exr,
    Png,
}

#[derive(Deserialize)]
struct View {
    camera: data::Camera,
    /// By file stem: a name, so that it cannot lead out of the folder.
    pictures: BTreeMap<Name, IgnoredAny>,
}

/// A folder of clips: what a model shows several cameras over time.
#[pyclass(frozen, module = "l4d")]
pub(crate) struct Clips {
    root: PathBuf,
    manifest: Manifest,
}

#[pymethods]
impl Clips {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        let manifest = read_manifest(&path.join("manifest.json"))?;
        Ok(Self { root: path, manifest })
    }

    /// Columns of the pictures, pixels.
    #[getter]
    fn width(&self) -> u32 {
        self.manifest.drawn.width
    }

    /// Rows of the pictures, pixels.
    #[getter]
    fn height(&self) -> u32 {
        self.manifest.drawn.height
    }

    /// Which depth was drawn: `"median"`, `"expected"` or `"sum"`.
    #[getter]
    fn depth_kind(&self) -> &str {
        &self.manifest.drawn.depth.kind
    }

    /// Names of the views, sorted.
    #[getter]
    fn views(&self) -> Vec<&str> {
        self.manifest.views.keys().map(Name::as_str).collect()
    }

    /// The camera of a view.
    fn camera(&self, view: &str) -> Result<Camera> {
        Ok(Camera { camera: self.find(view)?.camera.clone(), size: self.size() })
    }

    /// Canonical frames that are there of a view, ascending. Times between frames are left out.
    fn frames(&self, view: &str) -> Result<Vec<u32>> {
        let stems = self.find(view)?.pictures.keys();
        Ok(stems
            .filter_map(|stem| stem.parse().ok().filter(|&frame| frame_key(frame) == stem.as_str()))
            .collect())
    }

    /// Reads pictures of a view at canonical frames (all that are there by default). Colours were stored with 8 bits.
    /// Depth that was stored as PNG comes without alpha.
    #[pyo3(signature = (view, frames = None))]
    fn read(&self, py: Python<'_>, view: &str, frames: Option<Vec<u32>>) -> Result<PictureClip> {
        let there = self.frames(view)?;
        let frames = frames.unwrap_or_else(|| there.clone());
        if let Some(frame) = frames.iter().find(|frame| !there.contains(frame)) {
            let message = format!("{frame} was not drawn for view {view}");
            return Err(Failure::argument("frames", message, "give some of `Clips.frames(view)`"));
        }
        let values = py.detach(|| {
            let pictures = frames.par_iter().map(|&frame| self.picture(view, frame));
            pictures.collect::<Result<Vec<Values>>>()
        })?;
        PictureClip::new(py, Values::joined(values), frames, self.size())
    }

    fn __repr__(&self) -> String {
        let (root, [width, height]) = (self.root.display(), self.size());
        format!("Clips('{root}', {} views, {width}x{height})", self.manifest.views.len())
    }
}

impl Clips {
    fn size(&self) -> [u32; 2] {
        [self.width(), self.height()]
    }

    fn find(&self, view: &str) -> Result<&View> {
        self.manifest.views.get(view).ok_or_else(|| unknown("view", view, &self.views()))
    }

    fn picture(&self, view: &str, frame: u32) -> Result<Values> {
        let (width, height) = (self.width(), self.height());
        let stem = self.root.join(view).join(frame_key(frame));
        let damaged = |path: &Path, message: String| DataError::invalid(path, "picture", message, HINT);
        let path = stem.with_extension("png");
        let colour = decode_colour(&read_bounded(&path, MAX_BYTES)?, width, height)
            .map_err(|error| damaged(&path, error.to_string()))?;
        let rgb = colour.into_raw().into_iter().map(|byte| f32::from(byte) / 255.0).collect();
        match self.manifest.drawn.depth.format {
            DepthFormat::Exr => {
                let path = stem.with_extension("exr");
                let depth = decode_depth(&path, &read_bounded(&path, MAX_BYTES)?, UVec2::new(width, height))?;
                let alpha = depth.alpha.iter().map(|alpha| alpha.to_f32()).collect();
                Ok(Values { rgb, depth_m: depth.depth_m, alpha: Some(alpha) })
            }
            DepthFormat::Png => {
                let path = stem.with_extension("depth.png");
                let depth_m = decode_depth_png(&read_bounded(&path, MAX_BYTES)?, width, height)
                    .map_err(|error| damaged(&path, error.to_string()))?;
                Ok(Values { rgb, depth_m, alpha: None })
            }
        }
    }
}

fn read_manifest(path: &Path) -> Result<Manifest> {
    let manifest: Manifest = json::read(path)?;
    let refuse = |place: &str, message: String| {
        Err(DataError::invalid(path, place, message, "draw the clips again with `l4d render-splats`").into())
    };
    if manifest.schema != SCHEMA {
        return refuse("field `schema`", format!("is `{}`, but this l4d reads `{SCHEMA}`", manifest.schema));
    }
    let Look { width, height, .. } = manifest.drawn;
    if !Mask::is_sane_size(width, height) {
        return refuse("field `drawn`", format!("{width}x{height} is no size of a picture"));
    }
    for (name, view) in &manifest.views {
        if let Some(problem) = view.camera.problem() {
            return refuse(&format!("view {name}"), problem);
        }
    }
    Ok(manifest)
}
