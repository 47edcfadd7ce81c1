//! Frames on disk to a picture and the ids of what it shows.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use l4d_data::capture::MaskSet;
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name};
use l4d_frames::Display;
use l4d_frames::closeup::RgbImage;
use l4d_frames::exr::read_frame;
use l4d_frames::photo;
use l4d_masks::Mask;

use crate::picture::Ids;
use crate::scene::SceneInfo;

/// No picture of a capture is larger.
const MAX_PICTURE_BYTES: u64 = 256 << 20;
const IMPORT_AGAIN: &str = "run `l4d import-scene` again";

/// A frame as it is shown.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) picture: RgbImage,
    pub(crate) ids: Arc<Ids>,
}

/// Scene, view, canonical frame.
pub(crate) type FrameKey = (Name, Name, u32);

/// Reads frames; what several frames of a scene share is kept.
pub(crate) struct Decoder {
    data: PathBuf,
    displays: BTreeMap<Name, Display>,
    drawn: BTreeMap<Name, Arc<MaskSet>>,
}

impl Decoder {
    /// `data` holds the scenes.
    pub(crate) fn new(data: &Path) -> Self {
        Self { data: data.to_owned(), displays: BTreeMap::new(), drawn: BTreeMap::new() }
    }

    pub(crate) fn data(&self) -> &Path {
        &self.data
    }

    /// Decodes a frame of the scene that `card` describes.
    ///
    /// # Errors
    /// The frame cannot be read, or has another size.
    pub(crate) fn decode(&mut self, card: &SceneInfo, key: &FrameKey) -> Result<Shown, DataError> {
        if card.is_capture { self.taken(card, key) } else { self.rendered(card, key) }
    }

    fn rendered(&mut self, card: &SceneInfo, (scene, view, frame): &FrameKey) -> Result<Shown, DataError> {
        let decoded = read_frame(&SceneDir::new(&self.data, scene).frame(view, *frame), card.size)?;
        let display = self.displays.entry(scene.clone()).or_insert_with(|| Display::new(card.exposure));
        let ids = Arc::new(Ids { size: card.size, ids: decoded.surfaces.id.clone() });
        Ok(Shown { picture: display.picture(&decoded), ids })
    }

    /// A picture of a capture; objects are where people drew them, and nowhere else.
    fn taken(&mut self, card: &SceneInfo, (scene, view, frame): &FrameKey) -> Result<Shown, DataError> {
        let dir = CaptureDir::new(&self.data, scene);
        let picture = photograph(&dir.picture(view, *frame), card.size)?;
        let drawn = match self.drawn.get(scene) {
            Some(drawn) => Arc::clone(drawn),
            None => {
                let drawn = Arc::new(MaskSet::read(dir.root())?);
                self.drawn.insert(scene.clone(), Arc::clone(&drawn));
                drawn
            }
        };
        let mut ids = vec![0; card.size.element_product() as usize];
        for instance in &drawn.instances {
            let Some(mask) = instance.mask(view, *frame) else { continue };
            let mask = Mask::from_rle(mask, card.size.x, card.size.y);
            mask.pixels().for_each(|(col, row)| ids[(row * card.size.x + col) as usize] = instance.id);
        }
        Ok(Shown { picture, ids: Arc::new(Ids { size: card.size, ids }) })
    }
}

fn photograph(path: &Path, size: UVec2) -> Result<RgbImage, DataError> {
    let wrong = |message: String| DataError::invalid(path, "picture", message, IMPORT_AGAIN);
    let picture =
        photo::decode(&read_bounded(path, MAX_PICTURE_BYTES)?).map_err(|error| wrong(error.to_string()))?;
    match picture.dimensions() == (size.x, size.y) {
        true => Ok(picture),
        false => Err(wrong(format!("is not {}x{}", size.x, size.y))),
    }
}
