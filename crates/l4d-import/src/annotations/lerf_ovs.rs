//! Labels of LERF-OVS, as LangSplat's evaluator reads them: a folder per scene, a file in ISAT's form per picture.
//!
//! That evaluator takes the number in a file name, less one, for the place of a picture among those that were drawn.
//! LangSplat knows no time, so each moment is a scene of its own with one picture, `frame_00001`.

use std::path::{Path, PathBuf};

use l4d_data::DataError;
use l4d_masks::mask::PixelBox;

use serde_json::{Value, json};

use super::QueriesWithTruth;
use super::outline::pieces;

/// Stem of the one picture of a moment.
pub(crate) const STEM: &str = "frame_00001";

/// Folder of a moment below the labels.
pub(crate) fn moment_folder(scene: &str, frame: u32) -> PathBuf {
    PathBuf::from("label").join(format!("{scene}_{frame:04}"))
}

/// Writes the labels of all moments at which something is asked for; gives their canonical frames.
pub(crate) fn write(folder: &Path, judged: &QueriesWithTruth<'_>) -> Result<Vec<u32>, DataError> {
    let truth = judged.truth();
    let mut written = Vec::new();
    for &frame in &truth.frames {
        let objects = objects(judged, frame);
        if objects.is_empty() {
            continue;
        }
        let (width, height) = (truth.width, truth.height);
        let document = json!({
            "info": {
                "description": "ISAT", "folder": "", "name": format!("{STEM}.jpg"),
                "width": width, "height": height, "depth": 3, "note": "",
            },
            "objects": objects,
        });
        let path = folder.join(moment_folder(&truth.scene, frame)).join(format!("{STEM}.json"));
        l4d_data::json::write(&path, &document)?;
        written.push(frame);
    }
    Ok(written)
}

fn objects(judged: &QueriesWithTruth<'_>, frame: u32) -> Vec<Value> {
    let mut objects = Vec::new();
    for (group, prompt) in (1_u64..).zip(judged.prompts()) {
        let Some(mask) = prompt.masks.get(&frame).filter(|_| prompt.query.holds_at(frame)) else { continue };
        for piece in pieces(mask) {
            let PixelBox { first_col, first_row, last_col, last_row } = piece.whole;
            let bbox = [first_col, first_row, last_col, last_row].map(f64::from);
            objects.push(json!({
                "category": prompt.query.text,
                "group": group,
                "segmentation": piece.corners.iter().map(|corner| corner.map(f64::from)).collect::<Vec<_>>(),
                "area": piece.area as f64,
                "layer": 1.0,
                "bbox": bbox,
                "iscrowd": false,
                "note": "",
            }));
        }
    }
    objects
}
