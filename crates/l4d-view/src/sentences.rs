//! Sentences with the masks of the held-out view: what is meant, and what methods answered.

use std::collections::BTreeMap;

use l4d_data::layout::ResultsDir;
use l4d_data::results::MaskFile;
use l4d_data::store::read_bounded;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Category, DataError, Interval, Name, Query, Rle, StageError, Temporal};
use l4d_masks::{Mask, png, target};
use serde::Serialize;

use crate::Request;

/// A file of masks is not larger, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Four-digit frame -> mask, null = the answer is that there is nothing. Without a key there is no answer.
pub(crate) type Masks = BTreeMap<String, Option<Rle>>;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Sentence {
    /// Its number in the scene.
    pub(crate) number: String,
    pub(crate) text: String,
    pub(crate) categories: Vec<Category>,
    pub(crate) temporal: Temporal,
    /// Instances that are meant.
    pub(crate) referents: Vec<Name>,
    /// When it holds.
    pub(crate) frames: Vec<Interval>,
    /// What is meant, in the held-out view; none where there is no truth.
    pub(crate) truth: Option<Masks>,
    /// What each method answered; none where it did not answer this sentence.
    pub(crate) answers: Vec<Option<Masks>>,
}

/// All sentences of a request.
pub(crate) fn of(request: &Request<'_>) -> Result<Vec<Sentence>, StageError> {
    request.queries.iter().map(|query| sentence(request, query)).collect()
}

fn sentence(request: &Request<'_>, query: &Query) -> Result<Sentence, StageError> {
    let meant = |truth: &Truth| {
        let mask = |&frame: &u32| {
            let mask = target::target(truth, query, frame);
            (frame_key(frame), mask.map(|mask| mask.to_rle()))
        };
        truth.frames.iter().map(mask).collect()
    };
    let answers = request.methods.iter().map(|(_, folder)| answer(folder, query, request.truth));
    Ok(Sentence {
        number: query.id.number.to_string(),
        text: query.text.clone(),
        categories: query.categories.clone(),
        temporal: query.temporal,
        referents: query.referents.clone(),
        frames: query.frames.clone(),
        truth: request.truth.map(meant),
        answers: answers.chain(request.asks.iter().map(|_| Ok(None))).collect::<Result<_, _>>()?,
    })
}

/// The masks of a method for a sentence, whichever of the two forms they have.
fn answer(folder: &ResultsDir, query: &Query, truth: Option<&Truth>) -> Result<Option<Masks>, StageError> {
    let Some(truth) = truth else { return Ok(None) };
    let (path, pictures) = (folder.mask_file(&query.id), folder.mask_folder(&query.id));
    if path.is_file() {
        let MaskFile { size, frames } = MaskFile::parse(&path, &read_bounded(&path, MOST_BYTES)?)?;
        if size != [truth.height, truth.width] {
            let message = format!(
                "says {} x {}, but the truth is {} x {}",
                size[1], size[0], truth.width, truth.height
            );
            let hint = "name a method of this profile";
            return Err(DataError::invalid(&path, "field `size`", message, hint).into());
        }
        return Ok(Some(frames));
    }
    if !pictures.is_dir() {
        return Ok(None);
    }
    let mut masks = Masks::new();
    for &frame in &truth.frames {
        let key = frame_key(frame);
        let path = pictures.join(format!("{key}.png"));
        if path.is_file() {
            let decoded = png::decode(&read_bounded(&path, MOST_BYTES)?, truth.width, truth.height);
            let wrong =
                |error: png::PngError| DataError::invalid(&path, "picture", error.to_string(), error.hint());
            let mask: Mask = decoded.map_err(wrong)?;
            masks.insert(key, (!mask.is_empty()).then(|| mask.to_rle()));
        }
    }
    Ok(Some(masks))
}
