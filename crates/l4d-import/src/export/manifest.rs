//! `l4d-export.json`: what an export was made from, how it calls things, what it leaves out, and whether it is whole.
//!
//! A folder without a manifest of ours is never written into unless it is empty. The manifest is written first, marked
//! as unfinished, and once more at the end, so that an export that was killed can be run again in place.

use std::path::PathBuf;

use l4d_data::digest::sha256_file;
use l4d_data::reader::{EXPORT_CARD, Trained};
use l4d_data::results::Track;
use l4d_data::store::{FolderLock, list_folder};
use l4d_data::{Camera, DataError, Name, Profile, Split, json};
use serde::{Deserialize, Serialize};

use super::ExportRequest;
use super::views::SceneViews;

/// Schema tag of the manifest.
const SCHEMA: &str = "l4d/export/1";

/// An export that is whole.
#[derive(Debug, Clone)]
pub struct Exported {
    /// What it says of itself.
    pub manifest: Manifest,
    /// Where that is.
    pub path: PathBuf,
}

/// What an export says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// `l4d/export/1`.
    pub schema: String,
    /// False while it is being written.
    pub complete: bool,
    pub scene: Name,
    /// Profile that it was rendered in; `real` for captures.
    pub profile: Profile,
    pub format: String,
    /// What is shown of the held-out camera: `nothing`, `pose` or `pictures`.
    pub held_out: String,
    /// Whether anything of it comes from rendered depth: files of depth, or points made from it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub depth: bool,
    /// SHA-256 of `scene.json`, which holds the digests of depth and ids, or of `capture.json`.
    pub scene_sha256: String,
    /// SHA-256 of a capture's `masks.json`, in layouts that hold masks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub masks_sha256: Option<String>,
    /// Numbers of the moments in the scene; what a layout calls the i-th moment is the i-th of them.
    pub frames: Vec<u32>,
    /// What the layout calls our cameras.
    pub cameras: Vec<Called>,
    /// What the layout calls our instances, where it shows them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instances: Vec<Called>,
    /// What its reader makes of it, where that shows in models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trained: Option<Trained>,
    /// What a reader of the layout has to know, a sentence each.
    pub notes: Vec<String>,
}

/// One thing and its name in the layout.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Called {
    pub name: Name,
    /// Whether it is the held-out camera.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub held_out: bool,
    /// Its name there.
    pub called: String,
}

impl Called {
    pub(super) fn camera(camera: &Camera, called: impl Into<String>) -> Self {
        Self { name: camera.name.clone(), held_out: camera.split == Split::Test, called: called.into() }
    }
}

impl Manifest {
    pub(super) fn new(request: &ExportRequest<'_>, views: &SceneViews) -> Result<Self, DataError> {
        // Evaluators ask about all moments, whichever were chosen for pictures.
        let truth =
            request.judged.filter(|_| request.format.needs_truth()).map(|judged| judged.truth().clip());
        let masks = views.masks_path.as_ref().filter(|_| request.format.holds_masks());
        Ok(Self {
            schema: SCHEMA.to_owned(),
            complete: false,
            scene: views.name.clone(),
            profile: views.profile,
            format: request.format.to_string(),
            held_out: request.held_out.to_string(),
            depth: shows_depth(request, views),
            scene_sha256: sha256_file(&views.path)?,
            masks_sha256: masks.map(|path| sha256_file(path)).transpose()?,
            frames: truth.unwrap_or_else(|| views.frames.clone()),
            cameras: Vec::new(),
            instances: Vec::new(),
            trained: request.format.reader().map(|reader| reader.trained(views.frames.len())),
            notes: views.notes.clone(),
        })
    }

    /// Whether another export of the same scene and format would leave files of this one behind.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        let essence = |manifest: &Self| {
            (
                manifest.held_out.clone(),
                manifest.scene_sha256.clone(),
                manifest.masks_sha256.clone(),
                manifest.frames.clone(),
            )
        };
        essence(self) != essence(other)
    }

    /// Says what follows for methods from depth that comes from the render.
    pub(super) fn note_depth(&mut self) {
        if self.depth {
            self.note(format!(
                "some of it comes from rendered depth: a method that learns from it says `depth` under `used` in \
                 method.json and is ranked in the track {}",
                Track::ColourDepth.title()
            ));
        }
    }

    pub(super) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Says what became of the held-out cameras in a layout whose test split they are.
    pub(super) fn note_test_split(&mut self, views: &SceneViews) {
        let held_out = views.held_out();
        if held_out.is_empty() {
            self.note("the test split repeats a training camera, since its reader wants one");
        }
        for camera in held_out {
            let name = &camera.name;
            self.note(match views.shows_held_out_pictures() {
                false => format!(
                    "the test split is the pose of {name} with grey pictures: draw it, but believe no error measured on it"
                ),
                true => format!("the test split holds the true pictures of {name}: never train on it"),
            });
        }
    }
}

/// Whether an export holds depth of the render, or points made from it.
fn shows_depth(request: &ExportRequest<'_>, views: &SceneViews) -> bool {
    let has_points_of_depth = request.format.holds_points() && request.points_from.is_none();
    views.has_depth() && (request.format.holds_depth() || has_points_of_depth)
}

pub(super) struct Folder {
    manifest: PathBuf,
    _lock: FolderLock,
}

impl Folder {
    /// Takes possession of the folder of a request.
    pub(super) fn claim(request: &ExportRequest<'_>, views: &SceneViews) -> Result<Self, DataError> {
        let lock = FolderLock::take(request.out)?;
        let path = request.out.join(EXPORT_CARD);
        let refuse = |message: String| {
            let hint = "choose an empty folder, or remove this one";
            Err(DataError::invalid(request.out, "folder", message, hint))
        };
        if path.is_file() {
            let earlier: Manifest = json::read(&path)?;
            if (&earlier.scene, earlier.format.as_str()) != (&views.name, request.format.to_string().as_str())
            {
                return refuse(format!("holds {} as {}", earlier.scene, earlier.format));
            }
            if earlier.differs_from(&Manifest::new(request, views)?) {
                return refuse("holds an export of other frames, other pictures or another split".to_owned());
            }
        } else if let Some(entry) = list_folder(request.out)?.first() {
            return refuse(format!("is not empty: `{}` is there", l4d_data::error::inert(entry)));
        }
        json::write(&path, &Manifest::new(request, views)?)?;
        Ok(Self { manifest: path, _lock: lock })
    }

    /// Says that the export is whole.
    pub(super) fn settle(self, mut manifest: Manifest) -> Result<Exported, DataError> {
        manifest.complete = true;
        json::write(&self.manifest, &manifest)?;
        Ok(Exported { manifest, path: self.manifest })
    }
}
