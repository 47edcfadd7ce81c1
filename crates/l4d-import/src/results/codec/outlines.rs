//! Outlines with sentences for labels: labelme, ISAT, COCO instances.
//!
//! Outlines of one label are one mask. Of ISAT, `__background__` and the order of layers are left alone, as LangSplat
//! leaves them; of COCO all polygons of an instance count, where 4D LangSplat takes the first.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::json;
use l4d_data::store::read_bounded;
use l4d_frames::{Mask, rle};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::super::polygon::{Raster, fill};
use super::{Piece, Place, Problem, sane};

/// No file of outlines is larger.
const MAX_BYTES: u64 = 128 << 20;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Labelme {
    shapes: Vec<Shape>,
    image_height: u64,
    image_width: u64,
}

#[derive(Deserialize)]
struct Shape {
    label: String,
    points: Vec<[f64; 2]>,
    #[serde(default)]
    shape_type: Option<String>,
}

pub(super) fn read_labelme(path: &Path, raster: Raster) -> Result<Vec<Piece>, Problem> {
    let file: Labelme = parse(path)?;
    let mut canvas = Canvas::new(file.image_width, file.image_height, raster)?;
    for (index, shape) in file.shapes.iter().enumerate() {
        let place = format!("shapes[{index}]");
        let corners = match (shape.shape_type.as_deref().unwrap_or("polygon"), shape.points.as_slice()) {
            ("polygon", points) => points.to_vec(),
            ("rectangle", &[[x0, y0], [x1, y1]]) => vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
            (other, _) => {
                let message = format!("is a `{}`", l4d_data::error::inert(other));
                return Err(Problem::unreadable(place, message, "draw polygons or rectangles"));
            }
        };
        canvas.add(&shape.label, None, &corners, &place)?;
    }
    Ok(canvas.pieces())
}

#[derive(Deserialize)]
struct Isat {
    info: IsatInfo,
    objects: Vec<IsatObject>,
}

#[derive(Deserialize)]
struct IsatInfo {
    width: u64,
    height: u64,
}

#[derive(Deserialize)]
struct IsatObject {
    category: String,
    segmentation: Vec<[f64; 2]>,
}

pub(super) fn read_isat(path: &Path, raster: Raster) -> Result<Vec<Piece>, Problem> {
    let file: Isat = parse(path)?;
    let mut canvas = Canvas::new(file.info.width, file.info.height, raster)?;
    for (index, object) in
        file.objects.iter().enumerate().filter(|(_, object)| object.category != "__background__")
    {
        canvas.add(&object.category, None, &object.segmentation, &format!("objects[{index}]"))?;
    }
    Ok(canvas.pieces())
}

#[derive(Deserialize)]
struct Coco {
    images: Vec<CocoImage>,
    annotations: Vec<CocoAnnotation>,
    categories: Vec<CocoCategory>,
}

#[derive(Deserialize)]
struct CocoImage {
    id: u64,
    file_name: String,
    width: u64,
    height: u64,
}

#[derive(Deserialize)]
struct CocoAnnotation {
    image_id: u64,
    category_id: u64,
    segmentation: Segmentation,
}

#[derive(Deserialize)]
struct CocoCategory {
    id: u64,
    name: String,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Segmentation {
    Polygons(Vec<Vec<f64>>),
    Runs { counts: String, size: [u32; 2] },
}

pub(super) fn read_coco(path: &Path, raster: Raster) -> Result<Vec<Piece>, Problem> {
    const REMEDY: &str = "export the annotations again, as COCO instances";
    let file: Coco = parse(path)?;
    let images: BTreeMap<u64, &CocoImage> = file.images.iter().map(|image| (image.id, image)).collect();
    let names: BTreeMap<u64, &str> =
        file.categories.iter().map(|category| (category.id, category.name.as_str())).collect();
    let mut canvases: BTreeMap<u64, (u32, Canvas)> = BTreeMap::new();
    for (index, annotation) in file.annotations.iter().enumerate() {
        let place = format!("annotations[{index}]");
        let fault = |message: &str| Problem::unreadable(&place, message, REMEDY);
        let name =
            names.get(&annotation.category_id).ok_or_else(|| fault("is of a category that is not listed"))?;
        let image =
            images.get(&annotation.image_id).ok_or_else(|| fault("is of an image that is not listed"))?;
        let frame = frame_in(&image.file_name)
            .ok_or_else(|| fault("is of an image whose name holds no frame number"))?;
        if !canvases.contains_key(&image.id) {
            canvases.insert(image.id, (frame, Canvas::new(image.width, image.height, raster)?));
        }
        let Some((_, canvas)) = canvases.get_mut(&image.id) else { continue };
        match &annotation.segmentation {
            Segmentation::Polygons(polygons) => {
                for polygon in polygons {
                    let (corners, _) = polygon.as_chunks::<2>();
                    canvas.add(name, Some(frame), corners, &place)?;
                }
            }
            Segmentation::Runs { counts, size: [height, width] } => {
                if (*width, *height) != (canvas.width, canvas.height) {
                    return Err(fault("has another size than its image"));
                }
                let mask = rle::decode(counts, *width, *height).map_err(|error| fault(&error.to_string()))?;
                canvas.unite(name, Some(frame), mask);
            }
        }
    }
    Ok(canvases.into_values().flat_map(|(_, canvas)| canvas.pieces()).collect())
}

/// The number that a file name begins with, as 4D LangSplat reads it: `000123_png.rf.<hash>.jpg` is 123.
pub(super) fn frame_in(name: &str) -> Option<u32> {
    let digits: String = name.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

fn parse<T: DeserializeOwned>(path: &Path) -> Result<T, Problem> {
    Ok(json::parse(path, None, &read_bounded(path, MAX_BYTES)?)?)
}

/// Outlines of one picture, united by label.
struct Canvas {
    width: u32,
    height: u32,
    raster: Raster,
    masks: BTreeMap<(Option<u32>, String), Mask>,
}

impl Canvas {
    fn new(width: u64, height: u64, raster: Raster) -> Result<Self, Problem> {
        let (width, height) = sane(width, height, "size of the image")?;
        Ok(Self { width, height, raster, masks: BTreeMap::new() })
    }

    fn add(
        &mut self,
        label: &str,
        frame: Option<u32>,
        corners: &[[f64; 2]],
        place: &str,
    ) -> Result<(), Problem> {
        let mask = fill(corners, self.width, self.height, self.raster).ok_or_else(|| {
            Problem::unreadable(
                place,
                "has an outline that cannot be drawn",
                "draw it again with fewer corners",
            )
        })?;
        self.unite(label, frame, mask);
        Ok(())
    }

    fn unite(&mut self, label: &str, frame: Option<u32>, mask: Mask) {
        self.masks
            .entry((frame, label.to_owned()))
            .and_modify(|union| union.union_with(&mask))
            .or_insert(mask);
    }

    fn pieces(self) -> Vec<Piece> {
        let piece = |((frame, label), mask): ((Option<u32>, String), Mask)| Piece {
            name: Some(label),
            place: frame.map(Place::Frame),
            mask: Some(mask),
        };
        self.masks.into_iter().map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn read(
        value: &Value,
        reader: impl Fn(&Path, Raster) -> Result<Vec<Piece>, Problem>,
    ) -> Result<Vec<(String, Option<Place>, u64)>, Problem> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file.json");
        std::fs::write(&path, value.to_string()).unwrap();
        let pieces = reader(&path, Raster::Centres)?;
        let shown = |piece: Piece| (piece.name.unwrap(), piece.place, piece.mask.unwrap().area());
        Ok(pieces.into_iter().map(shown).collect())
    }

    #[test]
    fn labelme_unites_shapes_of_one_label() {
        let file = json!({"imageWidth": 8, "imageHeight": 6, "imageData": null, "version": "5", "shapes": [
            {"label": "cup", "points": [[0, 0], [2, 0], [2, 2], [0, 2]], "shape_type": "polygon", "flags": {}},
            {"label": "cup", "points": [[4, 4], [6, 6]], "shape_type": "rectangle"},
            {"label": "plate", "points": [[0, 0], [1, 0], [1, 1], [0, 1]]},
        ]});
        let expected = [("cup".to_owned(), None, 8), ("plate".to_owned(), None, 1)];
        assert_eq!(read(&file, read_labelme).unwrap(), expected);
        let circle = json!({"imageWidth": 8, "imageHeight": 6, "shapes": [
            {"label": "cup", "points": [[0, 0], [2, 0]], "shape_type": "circle"}]});
        assert!(read(&circle, read_labelme).unwrap_err().message.contains("`circle`"));
    }

    #[test]
    fn isat_takes_objects_as_langsplat_does() {
        let file = json!({"info": {"description": "ISAT", "width": 8, "height": 6, "name": "frame_00041.jpg"}, "objects": [
            {"category": "cup", "group": 1, "segmentation": [[0, 0], [3, 0], [3, 2], [0, 2]], "layer": 1.0},
            {"category": "__background__", "group": 0, "segmentation": [[0, 0], [1, 0], [1, 1], [0, 1]], "layer": 2.0},
        ]});
        assert_eq!(read(&file, read_isat).unwrap(), [("cup".to_owned(), None, 6)]);
    }

    #[test]
    fn coco_takes_all_polygons_and_the_number_of_the_image() {
        let file = json!({
            "images": [{"id": 7, "file_name": "000123_png.rf.abc.jpg", "width": 8, "height": 6}],
            "categories": [{"id": 1, "name": "cup"}],
            "annotations": [{"image_id": 7, "category_id": 1, "bbox": [0, 0, 1, 1],
                "segmentation": [[0, 0, 2, 0, 2, 2, 0, 2], [4, 4, 6, 4, 6, 6, 4, 6]]}],
        });
        assert_eq!(read(&file, read_coco).unwrap(), [("cup".to_owned(), Some(Place::Frame(123)), 8)]);
        let mut lost = file;
        lost["annotations"][0]["image_id"] = json!(9);
        assert!(read(&lost, read_coco).unwrap_err().message.contains("not listed"));
    }

    #[test]
    fn absurd_sizes_are_refused_before_anything_is_drawn() {
        let file = json!({"imageWidth": 4_000_000_000_u64, "imageHeight": 6, "shapes": []});
        assert!(read(&file, read_labelme).unwrap_err().message.contains("each side"));
    }
}
