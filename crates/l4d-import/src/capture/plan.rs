//! What a source says of a capture before any picture is read: cameras, lenses, and where pictures are.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use l4d_data::error::inert;
use l4d_data::{Camera, DataError, Name, Split};

use super::CaptureRequest;
use super::lens::Distortion;
use crate::points::ColouredPoint;

/// A capture to be written.
#[derive(Default)]
pub(super) struct Plan {
    /// Width and height of the pictures that the intrinsics are for; those of the pictures if none is stated.
    pub(super) stated_size: Option<[u32; 2]>,
    pub(super) views: Vec<View>,
    /// Points of the source, and which views saw them.
    pub(super) points: Vec<PlanPoint>,
    pub(super) frames_per_second: Option<f64>,
    pub(super) is_metric: bool,
    /// Files that cameras were read from.
    pub(super) inputs: Vec<PathBuf>,
    pub(super) notes: Vec<String>,
    /// Folder of extracted videos, removed in the end.
    pub(super) scratch: Option<PathBuf>,
}

/// A point of the source.
pub(super) struct PlanPoint {
    pub(super) surface: ColouredPoint,
    /// How far from its projections it was seen, pixels.
    pub(super) error_px: f64,
    pub(super) views: Vec<Name>,
}

/// One camera and its pictures.
pub(super) struct View {
    pub(super) camera: Camera,
    pub(super) distortion: Distortion,
    /// Picture at each moment that it saw.
    pub(super) pictures: BTreeMap<u32, PathBuf>,
}

impl Plan {
    pub(super) fn new(inputs: Vec<PathBuf>) -> Self {
        Self { inputs, ..Self::default() }
    }

    pub(super) fn note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Says whether distortion is removed, and holds out the views that the request names, or those of `default`.
    pub(super) fn finish(
        mut self,
        request: &CaptureRequest<'_>,
        default: &[&str],
    ) -> Result<Self, DataError> {
        if self.views.iter().any(|view| !view.distortion.is_none()) {
            self.note("lens distortion is removed: pictures are what pinholes would have seen");
        }
        let wanted: Vec<&str> = match request.held_out {
            [] => default.to_vec(),
            names => names.iter().map(String::as_str).collect(),
        };
        for name in wanted {
            let view = self.views.iter_mut().find(|view| view.camera.name.as_str() == name);
            let Some(view) = view else {
                let message = format!("has no view `{}` to hold out", inert(name));
                let hint = "name views as the capture does, with `--held-out`";
                return Err(DataError::invalid(request.input, "views", message, hint));
            };
            view.camera.split = Split::Test;
        }
        Ok(self)
    }
}

/// A training camera that does not move.
pub(super) fn camera(name: Name, [fx, fy, cx, cy]: [f64; 4], world_from_camera: [f64; 16]) -> Camera {
    Camera { name, split: Split::Train, fx, fy, cx, cy, world_from_camera: vec![world_from_camera] }
}

/// A name for a view, from whatever a source calls it.
pub(crate) fn name_of(path: &Path, text: &str) -> Result<Name, DataError> {
    let allowed = |character: char| character.is_ascii_alphanumeric() || matches!(character, '_' | '-' | '.');
    let spelled: String = text.chars().map(|c| if allowed(c) { c } else { '_' }).collect();
    Name::new(spelled.trim_start_matches(['.', '-'])).map_err(|error| {
        let hint = "rename the picture and its entry";
        DataError::invalid(path, "name of a view", inert(&error.to_string()), hint)
    })
}

/// A path that a file names, below a folder and never outside of it.
pub(super) fn inside(file: &Path, folder: &Path, relative: &str) -> Result<PathBuf, DataError> {
    let path = Path::new(relative);
    let stays = path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !stays || relative.is_empty() {
        let message = format!("`{}` leaves the folder", inert(relative));
        let hint = "write paths relative to the folder";
        return Err(DataError::invalid(file, "path of a picture", message, hint));
    }
    Ok(folder.join(path))
}

/// Whether the request wants a moment.
pub(super) fn is_wanted(request: &CaptureRequest<'_>, default: Option<[u32; 2]>, moment: u32) -> bool {
    request.moments.or(default).is_none_or(|[first, last]| (first..=last).contains(&moment))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside_and_names_become_ours() {
        let (file, folder) = (Path::new("transforms.json"), Path::new("data"));
        assert_eq!(inside(file, folder, "./images/a.png").unwrap(), Path::new("data/./images/a.png"));
        for bad in ["../a.png", "/etc/passwd", "images/../../a.png", ""] {
            assert!(inside(file, folder, bad).is_err(), "{bad}");
        }
        assert_eq!(name_of(file, "frame 01 (left)").unwrap().as_str(), "frame_01__left_");
        assert!(name_of(file, "..").is_err());
    }
}
