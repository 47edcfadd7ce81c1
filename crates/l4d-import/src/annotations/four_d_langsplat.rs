//! 4D LangSplat's annotations: Roboflow's COCO export and `video_annotations.json`.
//!
//! A category is a prompt. A gated sentence is a prompt of its base object with the moments at which it holds; the base
//! object is a category of its own. Its evaluator fills the first polygon of an annotation and unites the annotations
//! of a category, so that a mask is several annotations without holes. A file name begins with a moment: from 1 in
//! HyperNeRF, from 0 in Neu3D.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::truth::Truth;
use l4d_masks::Mask;
use l4d_masks::mask::PixelBox;
use serde_json::{Value, json};

use super::fill::Rule;
use super::outline::{Piece, pieces};
use super::{Annotations, QueriesWithTruth, coco};

/// Where the documents are below a dataset.
const COCO: &str = "annotations/train/_annotations.coco.json";
/// Where the times of gated sentences are below a dataset.
const INTERVALS: &str = "annotations/video_annotations.json";

/// Columns and rows that its reader of Neu3D gives every picture, and so everything that it draws.
const DRAWN: [u32; 2] = [1352, 1014];

/// Base object, prompt, intervals: first and last moment, both inclusive.
type Intervals = BTreeMap<String, BTreeMap<String, Vec<[u32; 2]>>>;

/// The reading of the original evaluator.
pub const READING: coco::Reading = coco::Reading { rule: Rule::Cv2, first_polygon_only: true };

/// Reads the annotations of a dataset folder, as the original evaluator fills them, and the moment of each picture.
/// `first` is the number that the first moment has in file names.
///
/// # Errors
/// Documents that cannot be read, and file names without a number.
pub fn read(folder: &Path, first: u32) -> Result<(Annotations, Vec<u32>), DataError> {
    let path = folder.join(COCO);
    let mut annotations = coco::read(&path, READING)?;
    let moment = |name: &str| {
        let number = name.split('_').next().and_then(|number| number.parse::<u32>().ok());
        number.and_then(|number| number.checked_sub(first)).ok_or_else(|| {
            let message =
                format!("`{}` does not begin with a number from {first} and an underscore", inert(name));
            DataError::invalid(&path, "field `images`", message, "keep the file names of Roboflow's export")
        })
    };
    let moments = annotations.pictures.iter().map(|picture| moment(&picture.file_name));
    let moments = moments.collect::<Result<_, _>>()?;
    let intervals = folder.join(INTERVALS);
    if intervals.is_file() && !l4d_data::json::read::<Intervals>(&intervals)?.is_empty() {
        annotations.notes.push(
            "intervals of video_annotations.json are times of sentences, not masks: write them into the queries"
                .to_owned(),
        );
    }
    Ok((annotations, moments))
}

/// Columns and rows of annotations: its evaluator takes latents of no other size.
pub(crate) fn drawn_size(truth: &Truth) -> [u32; 2] {
    let size = [truth.width, truth.height];
    if size[0] * DRAWN[1] == size[1] * DRAWN[0] { DRAWN } else { size }
}

/// Writes both documents, Neu3D's counting; gives the names of the pictures, in the order of the truth's frames.
pub(crate) fn write(folder: &Path, judged: &QueriesWithTruth<'_>) -> Result<Vec<String>, DataError> {
    let truth = judged.truth();
    let subjects = subjects(judged);
    let moments = moments(truth);
    let [width, height] = drawn_size(truth);
    let mut annotations = Vec::new();
    for (category, (_, masks)) in subjects.iter().enumerate() {
        for (image, (_, frame)) in moments.iter().enumerate() {
            let mask = masks.get(frame).map(|mask| mask.resized_nearest(width, height));
            for piece in mask.as_ref().map(pieces).unwrap_or_default() {
                annotations.push(annotation(annotations.len(), image, category, &piece));
            }
        }
    }
    let names: Vec<String> =
        moments.iter().map(|(moment, _)| format!("{moment:04}_png.rf.l4d.jpg")).collect();
    let image = |(id, name): (usize, &String)| json!({"id": id, "license": 1, "file_name": name, "height": height, "width": width});
    let category = |(id, (name, _)): (usize, &(String, &BTreeMap<u32, Mask>))| json!({"id": id, "name": name, "supercategory": "prompt"});
    let description = format!("{} ({})", truth.scene, truth.profile);
    let document = json!({
        "info": { "year": "2026", "version": "1", "description": description },
        "licenses": [],
        "categories": subjects.iter().enumerate().map(category).collect::<Vec<_>>(),
        "images": names.iter().enumerate().map(image).collect::<Vec<_>>(),
        "annotations": annotations,
    });
    l4d_data::json::write_compact(&folder.join(COCO), &document)?;
    l4d_data::json::write(&folder.join(INTERVALS), &intervals(judged))?;
    Ok(names)
}

/// Frames that are judged, with their places in the clip: names of pictures count all moments of the held-out view.
fn moments(truth: &Truth) -> Vec<(usize, u32)> {
    truth.clip().into_iter().enumerate().filter(|(_, frame)| truth.frames.contains(frame)).collect()
}

/// Categories with their masks: sentences that hold throughout, and the base objects of gated ones.
fn subjects<'a>(judged: &'a QueriesWithTruth<'_>) -> Vec<(String, &'a BTreeMap<u32, Mask>)> {
    let mut subjects: Vec<(String, &BTreeMap<u32, Mask>)> = Vec::new();
    for prompt in judged.prompts() {
        let name = if prompt.is_gated() { prompt.base() } else { prompt.query.text.clone() };
        if !subjects.iter().any(|(other, _)| *other == name) {
            subjects.push((name, &prompt.masks));
        }
    }
    subjects
}

fn annotation(id: usize, image: usize, category: usize, piece: &Piece) -> Value {
    let PixelBox { first_col, first_row, last_col, last_row } = piece.whole;
    json!({
        "id": id,
        "image_id": image,
        "category_id": category,
        // Of the connected thing that the piece belongs to.
        "bbox": [first_col, first_row, last_col - first_col + 1, last_row - first_row + 1],
        "area": piece.area,
        "segmentation": [piece.corners.iter().flatten().collect::<Vec<_>>()],
        "iscrowd": 0,
    })
}

/// Moments, counted in the clip of the held-out view, at which gated sentences hold.
fn intervals(judged: &QueriesWithTruth<'_>) -> Intervals {
    let mut intervals = Intervals::new();
    for prompt in judged.prompts().iter().filter(|prompt| prompt.is_gated()) {
        let mut runs: Vec<[u32; 2]> = Vec::new();
        for (moment, _) in (0..).zip(judged.truth().clip()).filter(|(_, frame)| prompt.query.holds_at(*frame))
        {
            match runs.last_mut() {
                Some(run) if run[1] + 1 == moment => run[1] = moment,
                _ => runs.push([moment, moment]),
            }
        }
        intervals.entry(prompt.base()).or_default().insert(prompt.query.text.clone(), runs);
    }
    intervals
}
