//! 4D LangSplat's annotations: Roboflow's COCO export and `video_annotations.json`.
//!
//! A category is a prompt. The evaluator fills the first polygon of an annotation and unites the annotations of a
//! category. A file name begins with a moment: from 1 in HyperNeRF, from 0 in Neu3D.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use serde_json::{Map, Value};

use super::fill::Rule;
use super::{Annotations, coco};

/// Where the documents are below a dataset.
const COCO: &str = "annotations/train/_annotations.coco.json";
/// Where the times of gated sentences are below a dataset.
const INTERVALS: &str = "annotations/video_annotations.json";

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
    if intervals.is_file() && !l4d_data::json::read::<Map<String, Value>>(&intervals)?.is_empty() {
        annotations.notes.push(
            "intervals of video_annotations.json are times of sentences, not masks: write them into the queries"
                .to_owned(),
        );
    }
    Ok((annotations, moments))
}
