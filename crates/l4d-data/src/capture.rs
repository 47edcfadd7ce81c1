//! `capture.json` and `masks.json`: scenes that others recorded, and what people drew on their pictures.
//!
//! A capture has colours and cameras; it has neither depth nor ids, and says so. Its world is that of its
//! reconstruction: neither metres nor the direction up are known unless the source states them. How captures of others
//! become these files is the business of `l4d-import`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::camera::{Camera, Split, cameras_problem};
use crate::error::DataError;
use crate::json::{self, Document};
use crate::name::Name;
use crate::rle::Rle;
use crate::store::holds;
use crate::truth::frame_key;

/// Schema tag of `capture.json`.
pub const SCHEMA: &str = "l4d/capture/1";
/// Name of the file.
pub const CAPTURE: &str = "capture.json";
/// Name of the folder with the points of the source, a COLMAP model of all views.
pub const SPARSE: &str = "sparse";
/// Schema tag of `masks.json`.
pub const MASKS_SCHEMA: &str = "l4d/capture-masks/1";
/// Name of the file.
pub const MASKS: &str = "masks.json";

/// `capture.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Capture {
    /// [`SCHEMA`].
    pub schema: String,
    pub name: Name,
    /// Who recorded it.
    pub source: String,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// All views, sorted by name. A pose for all moments, or one for each number from 0 to the last.
    pub cameras: Vec<Camera>,
    /// Numbers of the moments, ascending.
    pub frames: Vec<u32>,
    /// Where known.
    pub frames_per_second: Option<f64>,
    /// `absent`: whatever needs depth has to do without, or refuses.
    pub depth: Depth,
    /// How many points of the source are in `sparse`: 0 where it has none.
    #[serde(default)]
    pub points: usize,
    /// Whether a unit of the world is a metre.
    pub is_metric: bool,
    /// Pictures that are missing on purpose: views that did not see a moment.
    pub unseen: BTreeMap<Name, Vec<u32>>,
    /// Pictures that were damaged and are those of another moment instead.
    pub substituted: Vec<Substitution>,
    /// SHA-256 of the files that cameras were read from, by their path within the input.
    pub inputs: BTreeMap<String, String>,
    /// What was assumed or left out, a sentence each.
    pub notes: Vec<String>,
}

/// Whether there is depth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Depth {
    /// None.
    Absent,
}

/// A picture in the place of a damaged one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Substitution {
    pub view: Name,
    /// The moment whose picture is damaged.
    pub frame: u32,
    /// The moment whose picture is there instead.
    pub shows: u32,
    /// What is wrong with the original.
    pub why: String,
}

impl Capture {
    /// Reads the capture in a folder.
    ///
    /// # Errors
    /// A file that is missing or damaged.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        json::read_document(&folder.join(CAPTURE))
    }

    /// The picture of a view at a moment, relative to the folder of the capture.
    pub fn picture_path(view: &str, frame: u32) -> PathBuf {
        Path::new("frames").join(view).join(format!("{}.png", frame_key(frame)))
    }

    /// Views that are held out.
    pub fn held_out(&self) -> impl Iterator<Item = &Camera> {
        self.cameras.iter().filter(|camera| camera.split == Split::Test)
    }

    /// Whether a view saw a moment.
    pub fn saw(&self, view: &str, frame: u32) -> bool {
        self.unseen.iter().all(|(name, frames)| name.as_str() != view || !frames.contains(&frame))
    }
}

/// `masks.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaskSet {
    /// [`MASKS_SCHEMA`].
    pub schema: String,
    pub scene: Name,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// What was drawn, sorted by name.
    pub instances: Vec<MaskedInstance>,
    /// What was left out or assumed, a sentence each.
    pub notes: Vec<String>,
}

/// One thing and its pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaskedInstance {
    /// Number, from 1.
    pub id: u32,
    /// The label as a name.
    pub name: Name,
    /// The label as it was given.
    pub label: String,
    /// View -> four-digit frame -> mask; an annotated frame without it is null.
    pub masks: BTreeMap<Name, BTreeMap<String, Option<Rle>>>,
}

impl MaskSet {
    /// Reads the masks in the folder of a capture.
    ///
    /// # Errors
    /// A file that is missing or damaged.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        json::read_document(&folder.join(MASKS))
    }

    /// Whether the folder of the capture has these masks already.
    ///
    /// # Errors
    /// Other masks that are there, unless `force`.
    pub fn is_in(&self, folder: &Path, force: bool) -> Result<bool, DataError> {
        let path = folder.join(MASKS);
        let hint = "give another --out, or replace them with --force";
        holds(&path, &json::compact(&path, self)?, force, hint)
    }

    /// Writes the file into the folder of the capture, unless it is there.
    ///
    /// # Errors
    /// Other masks that are there, unless `force`, and what the disk refuses.
    pub fn write(&self, folder: &Path, force: bool) -> Result<PathBuf, DataError> {
        let path = folder.join(MASKS);
        if !self.is_in(folder, force)? {
            json::write_compact(&path, self)?;
        }
        Ok(path)
    }
}

impl MaskedInstance {
    /// What it is one of: the words of the label before a colon, else the label less a number at its end. `cup: red`
    /// and `cup 2` are cups.
    pub fn category(&self) -> String {
        let noun = match self.label.split_once(':') {
            Some((noun, _)) => noun,
            None => self.label.trim_end_matches(|last: char| last.is_ascii_digit()),
        };
        let noun = noun.trim().trim_end_matches(['_', '-', '#']).trim();
        if noun.is_empty() { self.label.clone() } else { noun.to_lowercase().replace(' ', "_") }
    }

    /// The mask of a picture; none where no one looked or the thing is not there.
    pub fn mask(&self, view: &str, frame: u32) -> Option<&Rle> {
        self.masks.get(view)?.get(&frame_key(frame))?.as_ref()
    }
}

impl Document for Capture {
    const SCHEMA: &'static str = SCHEMA;
    const HINT: &'static str = "import the scene again";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        if self.frames.is_empty() || !self.frames.is_sorted_by(|a, b| a < b) {
            return Some(("field `frames`".to_owned(), "must be ascending numbers".to_owned()));
        }
        let last = self.frames.last().map_or(0, |last| *last as usize);
        cameras_problem(&self.cameras).or_else(|| {
            let poses = |camera: &Camera| camera.world_from_camera.len();
            let camera = self.cameras.iter().find(|camera| poses(camera) > 1 && poses(camera) <= last)?;
            let message = format!("has {} poses, but the last frame is {last}", poses(camera));
            Some((format!("camera {}", camera.name), message))
        })
    }
}

impl Document for MaskSet {
    const SCHEMA: &'static str = MASKS_SCHEMA;
    const HINT: &'static str = "import the masks again";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        self.instances.iter().find_map(|instance| {
            let masks = instance.masks.iter().flat_map(|(view, frames)| {
                frames.iter().map(move |(frame, mask)| (view, frame, mask.as_ref()))
            });
            let misfit = |(view, frame, mask): (&Name, &String, Option<&Rle>)| {
                let error = mask?.misfit(self.width, self.height)?;
                Some((format!("instance {}, view {view}, frame {frame}", instance.name), error.to_string()))
            };
            masks.into_iter().find_map(misfit)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_say_what_look_alikes_are() {
        let category = |label: &str| {
            let name = Name::new("x").unwrap();
            MaskedInstance { id: 1, name, label: label.to_owned(), masks: BTreeMap::new() }.category()
        };
        let expected = [
            ("cup: red", "cup"),
            ("Cup 2", "cup"),
            ("glass of water", "glass_of_water"),
            ("object_12", "object"),
            ("dog#3", "dog"),
            ("7", "7"),
        ];
        for (label, noun) in expected {
            assert_eq!(category(label), noun, "{label}");
        }
    }
}
