//! What a found file holds: masks, with as much of "which sentence, which frame" as the file itself says.
//!
//! Files are taken as hostile: sizes are checked before room is made, and what is no answer is reported with its
//! place and a hint. Videos and JPEG are refused: they are lossy, and a threshold on them moves outlines.

mod maps;
mod records;
mod trajectory;
mod validation;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use l4d_data::{DataError, Report};
use l4d_masks::Mask;
use serde::{Deserialize, Serialize};

use super::codes;
use super::inside::Inside;

/// Kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Codec {
    /// PNG of any kind: a mask, a map of ids, a palette.
    Picture,
    /// `.npy`, `.npz` or `.pt`: masks, relevancy, ids.
    Array,
    /// `.npy` of latents, three levels a frame: needs a decoder and embeddings of the sentences.
    Latents,
    /// JSON of COCO run lengths, alone or by sentence and frame, as MeViS has them.
    CocoRle,
    /// `validation.json` of HyperGaussian, with a picture a frame in `binary_masks` beside it.
    R4d,
    /// A trajectory of the VOT toolkit: a region a frame, as text or binary.
    Vot,
}

/// Ids that mean a sentence: by sentence or number of the query.
pub type Selections = BTreeMap<String, BTreeSet<u32>>;

/// How files are read.
#[derive(Debug, Clone)]
pub struct Reading {
    /// What kind of file.
    pub codec: Codec,
    /// What of a picture of numbers is inside.
    pub inside: Inside,
    /// Which array of a file with several.
    pub key: Option<String>,
    /// Which ids mean which sentence, for [`Inside::Selected`].
    pub selections: Selections,
}

/// When an answer holds, as a file says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// A frame of the scene.
    Frame(u32),
    /// So many answers into the clip.
    Position(usize),
}

/// One answer of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The sentence or its number, where the file says it.
    pub name: Option<String>,
    /// The frame, where the file says it.
    pub place: Option<Place>,
    /// The mask; none where the file says that nothing is there.
    pub mask: Option<Mask>,
}

/// Why a file holds no answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Code of the finding.
    pub code: &'static str,
    /// Field, entry or pixel.
    pub place: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: String,
}

impl Problem {
    /// A problem at a field, entry or pixel.
    pub(crate) fn new(
        code: &'static str,
        place: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self { code, place: place.into(), message: message.into(), hint: hint.into() }
    }

    /// A problem with a file that cannot be read.
    pub(crate) fn unreadable(place: impl Into<String>, message: impl Into<String>, hint: &str) -> Self {
        Self::new(codes::UNREADABLE, place, message, hint)
    }

    /// Adds the problem to a report.
    pub fn report(&self, path: &Path, report: &mut Report) {
        report.error(self.code, path, &self.place, &self.message, &self.hint);
    }
}

impl From<DataError> for Problem {
    fn from(error: DataError) -> Self {
        let (place, message) = error.place_and_message();
        Self::unreadable(place, message, error.hint())
    }
}

/// Reads the answers in a file. `size` is the columns and rows of the pictures, which a trajectory does not say.
///
/// # Errors
/// Everything that keeps the file from being what `reading` says.
pub fn read(path: &Path, reading: &Reading, size: (u32, u32)) -> Result<Vec<Piece>, Problem> {
    match reading.codec {
        Codec::Picture => maps::read_picture(path, reading),
        Codec::Array => maps::read_array(path, reading),
        Codec::CocoRle => records::read(path),
        Codec::R4d => validation::read(path, reading),
        Codec::Vot => trajectory::read(path, size),
        Codec::Latents => {
            let message = "holds latents, which are read together with their other levels";
            Err(Problem::unreadable("file", message, ""))
        }
    }
}

/// The files that [`read`] opens for a file that was found.
pub(super) fn files(codec: Codec, path: &Path) -> Vec<PathBuf> {
    let beside = if codec == Codec::R4d { validation::pictures(path) } else { Vec::new() };
    [path.to_owned()].into_iter().chain(beside).collect()
}

fn sane(width: u64, height: u64, place: &str) -> Result<(u32, u32), Problem> {
    let side = |side: u64| u32::try_from(side).unwrap_or(u32::MAX);
    let (width, height) = (side(width), side(height));
    if Mask::is_sane_size(width, height) {
        return Ok((width, height));
    }
    let message = format!("{width}x{height}: each side must have 1 to {} pixels", Mask::MAX_SIDE);
    Err(Problem::unreadable(place, message, "check that this is a file of masks"))
}
