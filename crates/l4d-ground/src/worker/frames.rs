//! The frames of a clip as files that a worker can open.

use std::path::{Path, PathBuf};

use l4d_data::DataError;
use l4d_data::digest::RunningDigest;
use l4d_data::store::write_atomic;
use l4d_data::truth::frame_key;
use l4d_frames::drawn::encode_colour;
use serde::Serialize;

use crate::clip::ViewClip;

/// A folder of pictures, in the order of the clip.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// The folder, absolute.
    pub dir: PathBuf,
    /// Names of the files; a frame of the protocol is an index into this list.
    pub files: Vec<String>,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

/// Keeps the frames of clips under the digest of their pixels, so that many questions share them.
#[derive(Debug)]
pub struct FrameStore {
    root: PathBuf,
}

impl FrameStore {
    /// A store in a folder that may be removed at any time when nothing runs.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into() }
    }

    /// The frames of a clip; those that are missing are written.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn frames(&self, clip: &ViewClip) -> Result<Frames, DataError> {
        let dir = self.root.join(&digest(clip)[..16]);
        let dir = std::path::absolute(&dir).map_err(|source| DataError::io(&dir, "resolve", source))?;
        let files: Vec<String> =
            clip.frame_numbers().map(|frame| format!("{}.png", frame_key(frame))).collect();
        for (seen, file) in clip.frames.iter().zip(&files) {
            let path: &Path = &dir.join(file);
            if !path.exists() {
                write_atomic(path, &encode_colour(&seen.colour))?;
            }
        }
        Ok(Frames { dir, files, width: clip.width, height: clip.height })
    }
}

fn digest(clip: &ViewClip) -> String {
    let mut digest = RunningDigest::default();
    for seen in &clip.frames {
        let (width, height) = seen.colour.dimensions();
        [seen.frame, width, height].iter().for_each(|number| digest.add(&number.to_le_bytes()));
        digest.add(seen.colour.as_raw());
    }
    digest.hex()
}
