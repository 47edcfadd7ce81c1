//! Masks that were made elsewhere, by any program, for views and frames of queries.
//!
//! ```text
//! <root>/<scene>/<nnn>/<view>.json               all frames of a view, as in the mask files of results
//! <root>/<scene>/<nnn>/<view>/<frame:04>.png     or one picture per frame
//! ```
//!
//! Every frame of the clip needs an answer: null, or an empty mask, says that nothing is to be seen there. Files are
//! untrusted: sizes are checked before memory is allocated, and nothing but regular files is opened. How masks came
//! about is not known here, and so whether the truth had a part in it: that is for the user to say.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::digest::{RunningDigest, sha256_file};
use l4d_data::results::MaskFile;
use l4d_data::store::{list_folder, read_bounded};
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name};
use l4d_masks::{Mask, png};
use serde_json::Value;

use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};

/// No JSON file of masks is larger: 97 frames of noise at the full profile fit twice.
const MAX_JSON_BYTES: u64 = 64 << 20;
/// No PNG mask is larger: uncompressed 8-bit masks far above the full profile fit.
const MAX_PNG_BYTES: u64 = 4 << 20;

/// Masks of one scene in files.
#[derive(Debug, Clone)]
pub struct Files {
    folder: PathBuf,
    scene: Name,
    sha256: String,
}

impl Files {
    /// Lists and digests `<root>/<scene>`; where there is no such folder, every question is answered by an error.
    ///
    /// # Errors
    /// A folder or a file cannot be read.
    pub fn open(root: &Path, scene: Name) -> Result<Self, DataError> {
        let folder = root.join(scene.as_str());
        let mut digest = RunningDigest::default();
        for path in mask_files(&folder)? {
            let relative = path.strip_prefix(&folder).unwrap_or(&path).display();
            digest.add(format!("{}  {relative}\n", sha256_file(&path)?).as_bytes());
        }
        Ok(Self { folder, scene, sha256: digest.hex() })
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, DataError> {
        if question.scene != self.scene {
            let message = format!("holds masks of {}, not of {}", self.scene, question.scene);
            let hint = "open the folder of that scene";
            return Err(DataError::invalid(&self.folder, "folder", message, hint));
        }
        let Some(number) = &question.number else {
            let message = "masks are stored under the numbers of queries, and this sentence has none";
            let hint = "ask a query of the benchmark, or another grounder";
            return Err(DataError::invalid(&self.folder, "folder", message, hint));
        };
        let view = clip.camera.name.as_str();
        let folder = self.folder.join(number.as_str()).join(view);
        let file = self.folder.join(number.as_str()).join(format!("{view}.json"));
        let (masks, from) = match (file.is_file(), folder.is_dir()) {
            (true, false) => (read_json(&file, clip, question)?, file),
            (false, true) => (read_pngs(&folder, clip, question)?, folder),
            (true, true) => {
                let message = format!("is beside the folder {view}, which answers the same");
                return Err(DataError::invalid(&file, "file", message, "keep one of them"));
            }
            (false, false) => {
                let message = format!("is not there, and neither is the folder {view} of PNG masks");
                let hint = "write either, or check the folder that holds the scenes";
                return Err(DataError::invalid(&file, "file", message, hint));
            }
        };
        Ok(Grounding::of_masks(clip, masks, vec![format!("from {}", from.display())]))
    }
}

impl Grounder for Files {
    fn identity(&self) -> Value {
        serde_json::json!({ "kind": "files", "scene": self.scene, "masks_sha256": self.sha256 })
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        self.answer(clip, question)
            .unwrap_or_else(|error| Grounding::without_answer(Outcome::of_data_error(&error)))
    }
}

/// The masks of a clip's frames from one file; frames that the clip does not have are left alone.
fn read_json(path: &Path, clip: &ViewClip, question: &Question) -> Result<BTreeMap<u32, Mask>, DataError> {
    let file = MaskFile::parse(path, &read_bounded(path, MAX_JSON_BYTES)?)?;
    let [height, width] = file.size;
    if (width, height) != (clip.width, clip.height) {
        let message = format!("says {width}x{height}, but the clip is {}x{}", clip.width, clip.height);
        let hint = "write [height, width], and masks of the size of the clip";
        return Err(DataError::invalid(path, "field `size`", message, hint));
    }
    let mut masks = BTreeMap::new();
    for frame in question.frames(clip) {
        let key = frame_key(frame);
        let place = format!("frame `{key}`");
        let mask = match file.frames.get(&key) {
            None => {
                let hint = "write null where nothing is to be seen";
                return Err(DataError::invalid(path, place, "is missing", hint));
            }
            Some(None) => Mask::empty(width, height),
            Some(Some(mask)) => Mask::from_rle(mask, width, height),
        };
        masks.insert(frame, mask);
    }
    Ok(masks)
}

/// The masks of a clip's frames from one picture each; other files are left alone.
fn read_pngs(folder: &Path, clip: &ViewClip, question: &Question) -> Result<BTreeMap<u32, Mask>, DataError> {
    let mut masks = BTreeMap::new();
    for frame in question.frames(clip) {
        let path = folder.join(format!("{}.png", frame_key(frame)));
        if !path.is_file() {
            let hint = "write a picture of 0 where nothing is to be seen";
            return Err(DataError::invalid(&path, "file", "is missing", hint));
        }
        let bytes = read_bounded(&path, MAX_PNG_BYTES)?;
        let mask = png::decode(&bytes, clip.width, clip.height).map_err(|error| {
            let hint = match error {
                png::PngError::Size { .. } => "write masks of the size of the clip",
                _ => error.hint(),
            };
            DataError::invalid(&path, "picture", error.to_string(), hint)
        })?;
        masks.insert(frame, mask);
    }
    Ok(masks)
}

/// The regular files where masks may be, in the order of their names; none where there is no folder.
fn mask_files(scene: &Path) -> Result<Vec<PathBuf>, DataError> {
    let entries = |folder: &Path| -> Result<Vec<PathBuf>, DataError> {
        Ok(list_folder(folder)?.iter().map(|name| folder.join(name)).collect())
    };
    let mut files = Vec::new();
    if !scene.is_dir() {
        return Ok(files);
    }
    for query in entries(scene)?.into_iter().filter(|path| path.is_dir()) {
        for view in entries(&query)? {
            let inside = if view.is_dir() { entries(&view)? } else { vec![view] };
            files.extend(inside.into_iter().filter(|path| path.is_file()));
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests;
