//! Scenes that others recorded: pictures and cameras, masks where people drew them, points where the source had some.

use std::collections::BTreeMap;

use l4d_data::capture::{CAPTURE, Capture, MASKS, MaskSet, MaskedInstance};
use l4d_data::layout::CaptureDir;
use l4d_data::scene::{Instance, Role};
use l4d_data::store::read_bounded;
use l4d_data::truth::frame_key;
use l4d_data::{Camera, DataError, Profile};
use l4d_frames::drawn::RgbImage;
use l4d_frames::photo;
use l4d_masks::Mask;

use super::{Material, SceneViews};
use crate::export::HeldOut;
use crate::export::cloud::Reconstruction;

/// No picture of a capture is larger, bytes.
const MAX_BYTES: u64 = 256 << 20;
const HINT: &str = "run `l4d import-scene` again";

pub(super) struct Recording {
    dir: CaptureDir,
    pub(super) capture: Capture,
    masks: Option<MaskSet>,
}

impl Recording {
    pub(super) fn open(dir: &CaptureDir, shows: HeldOut) -> Result<SceneViews, DataError> {
        let capture = Capture::read(dir.root())?;
        let masks_path = Some(dir.root().join(MASKS)).filter(|path| path.is_file());
        let masks = masks_path.as_ref().map(|_| MaskSet::read(dir.root())).transpose()?;
        let size = [capture.width, capture.height];
        if let (Some(path), Some(masks)) = (&masks_path, &masks)
            && (&masks.scene, [masks.width, masks.height]) != (&capture.name, size)
        {
            let message = format!("{} of {}x{} is another scene", masks.scene, masks.width, masks.height);
            let hint = "draw on this capture's pictures";
            return Err(DataError::invalid(path, "field `scene`", message, hint));
        }
        let instance = |drawn: &MaskedInstance| Instance {
            id: drawn.id,
            name: drawn.name.clone(),
            role: Role::Object,
            category: drawn.category(),
            attributes: BTreeMap::new(),
            front: None,
        };
        Ok(SceneViews {
            name: capture.name.clone(),
            profile: Profile::Real,
            path: dir.root().join(CAPTURE),
            masks_path,
            size,
            instances: masks.iter().flat_map(|set| &set.instances).map(instance).collect(),
            frames: capture.frames.clone(),
            notes: Vec::new(),
            cameras: capture.cameras.clone(),
            material: Material::Captured(Box::new(Self { dir: dir.clone(), capture, masks })),
            shows,
            reconstruction: None,
        })
    }

    /// The picture as it lies on disk: a PNG of display colours.
    pub(super) fn bytes(&self, camera: &Camera, frame: u32) -> Result<Vec<u8>, DataError> {
        let path = self.dir.picture(&camera.name, frame);
        let bytes = read_bounded(&path, MAX_BYTES)?;
        let wrong = |message: String| DataError::invalid(&path, "picture", message, HINT);
        let (width, height) = photo::size(&bytes).map_err(|error| wrong(error.to_string()))?;
        if (width, height) != (self.capture.width, self.capture.height) {
            let expected = format!("{}x{}", self.capture.width, self.capture.height);
            return Err(wrong(format!("is {width}x{height}, but the capture is {expected}")));
        }
        Ok(bytes)
    }

    pub(super) fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, DataError> {
        let bytes = self.bytes(camera, frame)?;
        photo::decode(&bytes).map_err(|error| {
            let path = self.dir.picture(&camera.name, frame);
            DataError::invalid(&path, "picture", error.to_string(), HINT)
        })
    }

    pub(super) fn is_annotated(&self, camera: &Camera, frame: u32) -> bool {
        let key = frame_key(frame);
        let was_looked_at = |drawn: &MaskedInstance| {
            drawn.masks.get(&camera.name).is_some_and(|frames| frames.contains_key(&key))
        };
        self.masks.iter().flat_map(|set| &set.instances).any(was_looked_at)
    }

    /// What people drew of the instances on a picture; none if no one looked at it.
    pub(super) fn masks<'i>(
        &self,
        instances: &'i [Instance],
        camera: &Camera,
        frame: u32,
    ) -> Result<Option<Vec<(&'i Instance, Mask)>>, DataError> {
        let Some(set) = self.masks.as_ref().filter(|_| self.is_annotated(camera, frame)) else {
            return Ok(None);
        };
        let mut masks = Vec::new();
        for (drawn, instance) in set.instances.iter().zip(instances) {
            let Some(mask) = drawn.mask(&camera.name, frame) else { continue };
            masks.push((instance, Mask::from_rle(mask, set.width, set.height)));
        }
        Ok(Some(masks))
    }

    /// The points of the source, where it had some.
    pub(super) fn reconstruction(&self) -> Result<Option<Reconstruction>, DataError> {
        if self.capture.points == 0 {
            return Ok(None);
        }
        let cameras = &self.capture.cameras;
        Reconstruction::given(&self.dir.sparse(), cameras, &self.capture.frames).map(Some)
    }

    /// What has to be known of a capture, a sentence each.
    pub(super) fn notes(&self, frames: &[u32]) -> Vec<String> {
        let mut notes = vec!["a capture: there is no depth".to_owned()];
        if !self.capture.is_metric {
            notes.push("units and directions of the world are those of the reconstruction".to_owned());
        }
        for gone in self.capture.substituted.iter().filter(|gone| frames.contains(&gone.frame)) {
            notes.push(format!(
                "{} at {} is damaged in the source: the picture at {} takes its place",
                gone.view, gone.frame, gone.shows
            ));
        }
        notes
    }
}
