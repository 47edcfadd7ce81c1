//! Outlines with sentences for labels: labelme, ISAT, COCO instances. The readers are those of [`crate::annotations`].
//!
//! Outlines of one label are one mask. Of ISAT, `__background__` and the order of layers are left alone, as LangSplat
//! leaves them; of COCO all polygons of an instance count, where 4D LangSplat takes the first.

use std::path::Path;

use super::{Piece, Place, Problem};
use crate::annotations::fill::Rule;
use crate::annotations::{AnnotatedPicture, coco, isat, labelme};

/// What ISAT calls a hole.
const HOLE: &str = "__background__";

pub(super) fn read_labelme(path: &Path) -> Result<Vec<Piece>, Problem> {
    let annotations = labelme::read(path)?;
    // Half of an answer is none.
    if let Some(note) = annotations.notes.first() {
        return Err(Problem::unreadable("shapes", note, "draw polygons, rectangles or circles"));
    }
    Ok(annotations.pictures.iter().flat_map(|picture| pieces(picture, None)).collect())
}

pub(super) fn read_isat(path: &Path) -> Result<Vec<Piece>, Problem> {
    let annotations = isat::read(path, isat::Layers::Ignore)?;
    Ok(annotations.pictures.iter().flat_map(|picture| pieces(picture, None)).collect())
}

pub(super) fn read_coco(path: &Path) -> Result<Vec<Piece>, Problem> {
    let annotations = coco::read(path, coco::Reading { rule: Rule::Cv2, first_polygon_only: false })?;
    let mut found = Vec::new();
    for picture in annotations.pictures.iter().filter(|picture| !picture.objects.is_empty()) {
        let frame = frame_in(&picture.file_name).ok_or_else(|| {
            let message =
                format!("`{}` begins with no number of a frame", l4d_data::error::inert(&picture.file_name));
            Problem::unreadable("images", message, "name images by their frames: 000123.jpg")
        })?;
        found.extend(pieces(picture, Some(Place::Frame(frame))));
    }
    Ok(found)
}

/// The number that a file name begins with, as 4D LangSplat reads it: `000123_png.rf.<hash>.jpg` is 123.
fn frame_in(name: &str) -> Option<u32> {
    let digits: String = name.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

fn pieces(picture: &AnnotatedPicture, place: Option<Place>) -> Vec<Piece> {
    let labels = picture.labels().into_iter().filter(|label| *label != HOLE);
    let piece = |label: &str| Piece {
        name: Some(label.to_owned()),
        place,
        mask: Some(picture.union_of(label)),
        soft: None,
    };
    labels.map(piece).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn read(
        value: &Value,
        reader: impl Fn(&Path) -> Result<Vec<Piece>, Problem>,
    ) -> Result<Vec<(String, Option<Place>, u64)>, Problem> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file.json");
        std::fs::write(&path, value.to_string()).unwrap();
        let shown = |piece: Piece| (piece.name.unwrap(), piece.place, piece.mask.unwrap().area());
        Ok(reader(&path)?.into_iter().map(shown).collect())
    }

    #[test]
    fn labelme_unites_shapes_of_one_label_and_refuses_half_of_an_answer() {
        let file = json!({"imageWidth": 8, "imageHeight": 6, "imagePath": "x.jpg", "shapes": [
            {"label": "cup", "points": [[0, 0], [2, 0], [2, 2], [0, 2]], "shape_type": "polygon", "flags": {}},
            {"label": "cup", "points": [[4, 4], [6, 6]], "shape_type": "rectangle"},
            {"label": "plate", "points": [[0, 0], [1, 0], [1, 1], [0, 1]]},
        ]});
        let expected = [("cup".to_owned(), None, 8), ("plate".to_owned(), None, 1)];
        assert_eq!(read(&file, read_labelme).unwrap(), expected);
        let line = json!({"imageWidth": 8, "imageHeight": 6, "imagePath": "x.jpg", "shapes": [
            {"label": "cup", "points": [[0, 0], [2, 0]], "shape_type": "line"}]});
        assert!(read(&line, read_labelme).unwrap_err().message.contains("`line`"));
    }

    #[test]
    fn isat_takes_objects_as_langsplat_does() {
        let file = json!({"info": {"description": "ISAT", "width": 8, "height": 6, "name": "frame_00041.jpg"}, "objects": [
            {"category": "cup", "group": 1, "segmentation": [[0, 0], [2, 0], [2, 1], [0, 1]], "layer": 1.0},
            {"category": "__background__", "group": 0, "segmentation": [[0, 0], [1, 0], [1, 1], [0, 1]], "layer": 2.0},
        ]});
        assert_eq!(read(&file, read_isat).unwrap(), [("cup".to_owned(), None, 6)]);
    }

    #[test]
    fn coco_takes_all_polygons_and_the_number_of_the_image() {
        let file = json!({
            "images": [{"id": 7, "file_name": "000123_png.rf.abc.jpg", "width": 8, "height": 6}],
            "categories": [{"id": 1, "name": "cup"}],
            "annotations": [{"id": 1, "image_id": 7, "category_id": 1, "bbox": [0, 0, 1, 1],
                "segmentation": [[0, 0, 1, 0, 1, 1, 0, 1], [4, 4, 5, 4, 5, 5, 4, 5]]}],
        });
        assert_eq!(read(&file, read_coco).unwrap(), [("cup".to_owned(), Some(Place::Frame(123)), 8)]);
        let mut lost = file;
        lost["images"][0]["file_name"] = json!("frame.jpg");
        assert!(read(&lost, read_coco).unwrap_err().message.contains("no number"));
    }
}
