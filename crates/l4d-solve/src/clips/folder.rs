//! The folder of clips: one file a picture, and a manifest that says of what they are.
//!
//! The manifest comes first and says how everything in the folder was drawn; a file that is there under its final
//! name is whole, so that a run that was killed goes on where it stopped.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use glam::UVec2;
use l4d_data::digest::sha256_hex;
use l4d_data::store::{list_folder, read_bounded};
use l4d_data::{Camera, DataError, Name, json};
use l4d_frames::drawn::{DepthMap, RgbImage, decode_colour, decode_depth_png, encode_colour, picture_of};
use l4d_frames::exr::{decode_depth, encode_depth};
use l4d_frames::photo::PhotoError;
use l4d_splat::raster::RasterSettings;
use l4d_splat::source::Source;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::plan::{PictureIndex, Plan};
use super::writers::Sheet;

const SCHEMA: &str = "l4d/clips/1";
/// No file of a picture is larger, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// What every picture of the folder has in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Look {
    /// What is shown.
    pub model: ModelEntry,
    /// What drew it.
    pub rasterizer: String,
    /// Graphics adapter; null for the processor.
    pub adapter: Option<Value>,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Display colour where nothing is.
    pub background: [f32; 3],
    /// Which depth, and how it is stored.
    pub depth: DepthEntry,
}

/// Which model was drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelEntry {
    /// Who wrote it.
    pub family: String,
    /// Scene that it was trained on, where it says so.
    pub scene: Option<Name>,
    /// How many there are.
    pub gaussians: usize,
    /// How many of them move.
    pub dynamic: usize,
    /// SHA-256 of the files of the model.
    pub inputs: BTreeMap<String, String>,
    /// From where on it is drawn, units of its world.
    #[serde(default = "usual_near", skip_serializing_if = "is_usual_near")]
    pub near_m: f32,
}

fn usual_near() -> f32 {
    RasterSettings::default().near_m
}

fn is_usual_near(near_m: &f32) -> bool {
    near_m.to_bits() == usual_near().to_bits()
}

impl From<&Source> for ModelEntry {
    fn from(source: &Source) -> Self {
        Self {
            family: source.family.to_string(),
            scene: source.scene.clone(),
            gaussians: source.model.gaussians.len(),
            dynamic: source.model.dynamic.len(),
            inputs: source.inputs.clone(),
            near_m: source.near_m,
        }
    }
}

/// Which depth is drawn, and how it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DepthEntry {
    /// Which number it is.
    pub kind: DepthKind,
    /// How it is stored.
    pub format: DepthFormat,
    /// Metres of a unit of the file.
    unit_m: f64,
}

/// Which depth a pixel has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DepthKind {
    /// Where transmittance crosses a half.
    Median,
    /// sum z a T / sum a T.
    Expected,
    /// sum z a T, as 4DGaussians has it: too near wherever the pixel is not filled.
    Sum,
}

/// How depth is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DepthFormat {
    /// Metres as 32-bit floats, with alpha, near and far.
    Exr,
    /// Millimetres in 16 bits, and nothing else.
    Png,
}

impl DepthEntry {
    /// Depth of this kind, stored like this.
    pub fn new(kind: DepthKind, format: DepthFormat) -> Self {
        let unit_m = match format {
            DepthFormat::Exr => 1.0,
            DepthFormat::Png => 0.001,
        };
        Self { kind, format, unit_m }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    schema: String,
    /// How all of it was drawn.
    drawn: Look,
    views: BTreeMap<Name, ViewEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ViewEntry {
    /// Its numbers belong to pictures of the drawn size.
    camera: Camera,
    /// File stem -> what was drawn.
    pictures: BTreeMap<String, FrameEntry>,
}

/// One picture: its time and the SHA-256 of its files.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FrameEntry {
    time: f32,
    colour: String,
    depth: String,
}

impl FrameEntry {
    fn of(plan: &Plan, index: PictureIndex, [colour, depth]: &[Vec<u8>; 2]) -> Self {
        Self { time: plan.of(index).1.time, colour: sha256_hex(colour), depth: sha256_hex(depth) }
    }
}

/// What becomes of clips that stand where others are to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overwrite {
    /// Other clips, and files that no manifest speaks of, are an error.
    Never,
    /// Clips of another model or look give way; the same ones are kept. Files that no manifest speaks of are an error.
    Stale,
    /// Everything is drawn again.
    Always,
}

/// A folder that keeps clips of one model, drawn one way.
#[derive(Debug)]
pub struct ClipsFolder {
    root: PathBuf,
    manifest: Manifest,
    /// Whether pictures that are there were drawn as these are to be.
    is_continued: bool,
}

impl ClipsFolder {
    /// Takes the folder for clips of this look: goes on with what is there, or begins.
    ///
    /// # Errors
    /// Clips of another look, or files that no manifest speaks of, unless they may be replaced.
    pub fn claim(root: PathBuf, look: Look, plan: &Plan, overwrite: Overwrite) -> Result<Self, DataError> {
        let path = root.join("manifest.json");
        let before = if path.exists() { Some(read_manifest(&path)?) } else { None };
        let mut views = BTreeMap::new();
        let mut differs = before.as_ref().and_then(|before| difference(&before.drawn, &look));
        for view in 0..plan.cameras.len() {
            let camera = plan.drawn_camera(view);
            let known = before.as_ref().and_then(|before| before.views.get(&camera.name));
            if known.is_some_and(|known| known.camera != camera) {
                differs = differs.or(Some(format!("camera {}", camera.name)));
            }
            views.insert(camera.name.clone(), ViewEntry { camera, pictures: BTreeMap::new() });
        }
        if let Some(what) = differs.as_ref().filter(|_| overwrite == Overwrite::Never) {
            return Err(DataError::invalid(
                &root,
                "clips",
                format!("were drawn with another {what}"),
                "choose another --out, or replace them with --force",
            ));
        }
        let is_stale = overwrite == Overwrite::Always || differs.is_some();
        let is_continued = before.is_some() && !is_stale;
        if is_continued {
            for (name, view) in before.into_iter().flat_map(|before| before.views) {
                // The cameras of views that both have are the same.
                views.insert(name, view);
            }
        } else {
            sweep(&root, before.into_iter().flat_map(|before| before.views.into_keys()))?;
        }
        let folder =
            Self { root, manifest: Manifest { schema: SCHEMA.to_owned(), drawn: look, views }, is_continued };
        if overwrite != Overwrite::Always {
            folder.refuse_other_files(plan)?;
        }
        json::write(&path, &folder.manifest)?;
        Ok(folder)
    }

    /// Files under our names that no manifest speaks of were made by somebody else.
    fn refuse_other_files(&self, plan: &Plan) -> Result<(), DataError> {
        let mut files = plan.pictures().flat_map(|index| self.files(plan, index));
        match files.find(|path| path.exists()).filter(|_| !self.is_continued) {
            Some(path) => Err(DataError::invalid(
                &path,
                "file",
                "no manifest says what this file is",
                "choose another --out, or replace such files with --force",
            )),
            None => Ok(()),
        }
    }

    /// How everything in it is drawn.
    pub(super) fn look(&self) -> &Look {
        &self.manifest.drawn
    }

    /// SHA-256 over everything that decides how the pictures of a view look.
    pub(crate) fn view_digest(&self, plan: &Plan, view: usize) -> String {
        let keys: Vec<&str> = plan.instants.iter().map(|instant| instant.key.as_str()).collect();
        let decides = serde_json::json!([self.manifest.drawn, plan.drawn_camera(view), keys]);
        sha256_hex(json::canonical(&decides).as_bytes())
    }

    /// Where its manifest stands.
    pub fn manifest_path(&self) -> PathBuf {
        self.root.join("manifest.json")
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// `<view>/<instant>.png`, and `<view>/<instant>.exr` or `<view>/<instant>.depth.png`.
    fn files(&self, plan: &Plan, index: PictureIndex) -> [PathBuf; 2] {
        let (camera, instant) = plan.of(index);
        let depth = match self.manifest.drawn.depth.format {
            DepthFormat::Exr => "exr",
            DepthFormat::Png => "depth.png",
        };
        let folder = self.root.join(camera.name.as_str());
        ["png", depth].map(|ending| folder.join(format!("{}.{ending}", instant.key)))
    }

    /// The pictures that are whole already.
    pub(super) fn finished(&self, plan: &Plan) -> BTreeMap<PictureIndex, FrameEntry> {
        if !self.is_continued {
            return BTreeMap::new();
        }
        let pictures: Vec<PictureIndex> = plan.pictures().collect();
        let entry = |&index: &PictureIndex| {
            let files = self.read_files(plan, index).ok()?;
            self.decode(plan, index, &files).ok()?;
            Some((index, FrameEntry::of(plan, index, &files)))
        };
        pictures.par_iter().filter_map(entry).collect()
    }

    fn read_files(&self, plan: &Plan, index: PictureIndex) -> Result<[Vec<u8>; 2], DataError> {
        let [colour, depth] = self.files(plan, index);
        Ok([read_bounded(&colour, MAX_BYTES)?, read_bounded(&depth, MAX_BYTES)?])
    }

    fn decode(
        &self,
        plan: &Plan,
        index: PictureIndex,
        files: &[Vec<u8>; 2],
    ) -> Result<(RgbImage, DepthMap), DataError> {
        let [colour_path, depth_path] = self.files(plan, index);
        let ([colour, depth], [width, height]) = (files, plan.size);
        let colour = decode_colour(colour, width, height).map_err(|error| unreadable(&colour_path, error))?;
        let depth = match self.manifest.drawn.depth.format {
            DepthFormat::Exr => decode_depth(&depth_path, depth, UVec2::new(width, height))?,
            DepthFormat::Png => {
                let depth_m =
                    decode_depth_png(depth, width, height).map_err(|error| unreadable(&depth_path, error))?;
                DepthMap { depth_m, ..DepthMap::empty(width, height) }
            }
        };
        Ok((colour, depth))
    }

    /// The files of a picture: depth first, so that a picture whose colour is there is whole.
    pub(super) fn sheet(
        &self,
        plan: &Plan,
        index: PictureIndex,
        colour: &[[f32; 3]],
        depth: &DepthMap,
    ) -> Result<Sheet, DataError> {
        let [colour_path, depth_path] = self.files(plan, index);
        let colour = encode_colour(&picture_of(depth.width, depth.height, colour));
        let depth = match self.manifest.drawn.depth.format {
            DepthFormat::Exr => encode_depth(&depth_path, depth)?,
            DepthFormat::Png => depth.png(),
        };
        let files = [colour, depth];
        let entry = FrameEntry::of(plan, index, &files);
        let [colour, depth] = files;
        Ok(Sheet { index, entry, files: [(depth_path, depth), (colour_path, colour)] })
    }

    /// Reads a picture back. Depth that was stored as PNG comes without alpha, near and far.
    pub(super) fn read(&self, plan: &Plan, index: PictureIndex) -> Result<(RgbImage, DepthMap), DataError> {
        self.decode(plan, index, &self.read_files(plan, index)?)
    }

    /// Writes the manifest with the digests of all pictures.
    pub(super) fn settle(
        &self,
        plan: &Plan,
        entries: BTreeMap<PictureIndex, FrameEntry>,
    ) -> Result<(), DataError> {
        let mut manifest = self.manifest.clone();
        for (index, entry) in entries {
            let (camera, instant) = plan.of(index);
            if let Some(view) = manifest.views.get_mut(&camera.name) {
                view.pictures.insert(instant.key.clone(), entry);
            }
        }
        json::write(&self.manifest_path(), &manifest)
    }
}

fn read_manifest(path: &Path) -> Result<Manifest, DataError> {
    let manifest: Manifest = json::read(path)?;
    if manifest.schema == SCHEMA {
        return Ok(manifest);
    }
    let message = format!("is `{}`, but this l4d writes `{SCHEMA}`", manifest.schema);
    Err(DataError::invalid(path, "field `schema`", message, "choose another --out, or delete the folder"))
}

/// What of two looks differs, for people.
fn difference(before: &Look, now: &Look) -> Option<String> {
    let pairs = [
        ("model", before.model != now.model),
        ("rasterizer", (&before.rasterizer, &before.adapter) != (&now.rasterizer, &now.adapter)),
        ("size", (before.width, before.height) != (now.width, now.height)),
        ("background", before.background != now.background),
        ("depth", before.depth != now.depth),
    ];
    pairs.into_iter().find(|(_, differs)| *differs).map(|(what, _)| what.to_owned())
}

/// Removes the pictures of earlier clips: under a new manifest they would count as finished.
fn sweep(root: &Path, views: impl Iterator<Item = Name>) -> Result<(), DataError> {
    for view in views {
        let folder = root.join(view.as_str());
        if !folder.is_dir() {
            continue;
        }
        for name in list_folder(&folder)?.iter().filter(|name| is_picture(name)) {
            let path = folder.join(name);
            fs::remove_file(&path).map_err(|source| DataError::io(&path, "remove", source))?;
        }
    }
    Ok(())
}

/// `0048.png`, `0048.exr`, `t0.500000.depth.png`
fn is_picture(name: &str) -> bool {
    let stem = [".depth.png", ".png", ".exr"].iter().find_map(|ending| name.strip_suffix(ending));
    stem.is_some_and(|stem| {
        let number = stem.strip_prefix('t').unwrap_or(stem);
        !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
    })
}

fn unreadable(path: &Path, error: PhotoError) -> DataError {
    let hint = "delete the file and run the command again";
    DataError::invalid(path, "picture", error.to_string(), hint)
}
