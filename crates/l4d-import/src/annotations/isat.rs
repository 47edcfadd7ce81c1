//! ISAT, the format of the labels of LERF-OVS: a JSON file a picture, polygons with a group and a layer.

use std::path::Path;

use l4d_data::DataError;
use l4d_frames::Mask;
use serde::{Deserialize, Serialize};

use super::fill::{Rule, fill};
use super::{AnnotatedObject, AnnotatedPicture, Annotations, check_size, read_json};

/// Objects of this category are holes in what lies below.
const HOLE: &str = "__background__";

/// Whether what lies on top hides what lies below.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layers {
    /// As people drew it: higher layers cover lower ones, and holes are holes.
    Cover,
    /// As LangSplat's evaluator reads it: every polygon counts whole, holes are objects of their own.
    Ignore,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Document {
    pub(super) info: Info,
    pub(super) objects: Vec<Object>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Info {
    #[serde(default)]
    pub(super) description: String,
    #[serde(default)]
    pub(super) folder: String,
    pub(super) name: String,
    pub(super) width: u32,
    pub(super) height: u32,
    #[serde(default)]
    pub(super) depth: u32,
    #[serde(default)]
    pub(super) note: String,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Object {
    pub(super) category: String,
    #[serde(default)]
    pub(super) group: Option<u64>,
    pub(super) segmentation: Vec<[f64; 2]>,
    #[serde(default)]
    pub(super) area: f64,
    #[serde(default)]
    pub(super) layer: f64,
    /// First and last column and row: x1, y1, x2, y2.
    #[serde(default)]
    pub(super) bbox: [f64; 4],
    #[serde(default)]
    pub(super) iscrowd: bool,
    #[serde(default)]
    pub(super) note: String,
}

/// Reads a file; polygons become pixels as `cv2.fillPoly` has it, in ISAT and in LangSplat's evaluator alike.
pub fn read(path: &Path, layers: Layers) -> Result<Annotations, DataError> {
    let document: Document = read_json(path)?;
    let Info { width, height, name, .. } = document.info;
    check_size(path, "field `info`", width, height)?;
    let mut drawn: Vec<(Object, Mask)> = document
        .objects
        .into_iter()
        .map(|object| {
            let mask = fill(Rule::Cv2, &object.segmentation, width, height);
            (object, mask)
        })
        .collect();
    if layers == Layers::Cover {
        let order: Vec<(f64, Mask)> =
            drawn.iter().map(|(object, mask)| (object.layer, mask.clone())).collect();
        for (object, mask) in &mut drawn {
            for (_, above) in order.iter().filter(|(layer, _)| *layer > object.layer) {
                *mask = Mask::from_fn(width, height, |column, row| {
                    mask.get(column, row) && !above.get(column, row)
                });
            }
        }
        drawn.retain(|(object, _)| object.category != HOLE);
    }
    let objects = drawn
        .into_iter()
        .map(|(object, mask)| AnnotatedObject { label: object.category, group: object.group, mask })
        .collect();
    let picture = AnnotatedPicture { file_name: name, width, height, objects };
    Ok(Annotations { pictures: vec![picture], notes: Vec::new() })
}
