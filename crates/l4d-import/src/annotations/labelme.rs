//! labelme: a JSON file a picture, with shapes.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_frames::Mask;
use serde::Deserialize;

use super::fill::{Rule, fill};
use super::{AnnotatedObject, AnnotatedPicture, Annotations, check_size, read_json};

/// Corners of a polygon that stands for a circle.
const CIRCLE_CORNERS: usize = 128;

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    image_path: String,
    image_width: u32,
    image_height: u32,
    shapes: Vec<Shape>,
}

#[derive(Debug, Deserialize)]
struct Shape {
    label: String,
    points: Vec<[f64; 2]>,
    #[serde(default)]
    group_id: Option<u64>,
    /// Old files have none: a polygon.
    #[serde(default)]
    shape_type: Option<String>,
}

/// Reads a file. Pixels belong if their centre lies inside.
pub fn read(path: &Path) -> Result<Annotations, DataError> {
    let document: Document = read_json(path)?;
    let (width, height) = (document.image_width, document.image_height);
    check_size(path, "fields `imageWidth`, `imageHeight`", width, height)?;
    let mut annotations = Annotations::default();
    let mut objects = Vec::new();
    for (index, shape) in document.shapes.into_iter().enumerate() {
        match mask_of(&shape, width, height) {
            Ok(mask) => objects.push(AnnotatedObject { label: shape.label, group: shape.group_id, mask }),
            Err(kind) => annotations.notes.push(format!(
                "{}: shape {index} (`{}`) is a `{}`, which has no pixels that could be told, and is left out",
                path.display(),
                inert(&shape.label),
                inert(&kind)
            )),
        }
    }
    annotations.pictures.push(AnnotatedPicture { file_name: document.image_path, width, height, objects });
    Ok(annotations)
}

/// The pixels of a shape, or what kind of shape has none.
fn mask_of(shape: &Shape, width: u32, height: u32) -> Result<Mask, String> {
    let kind = shape.shape_type.as_deref().unwrap_or("polygon");
    let corners = match (kind, shape.points.as_slice()) {
        ("polygon", points) if points.len() > 2 => points.to_vec(),
        ("rectangle", &[[x0, y0], [x1, y1]]) => vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
        ("circle", &[centre, rim]) => circle(centre, rim),
        _ => return Err(kind.to_owned()),
    };
    Ok(fill(Rule::Centres, &corners, width, height))
}

fn circle(centre: [f64; 2], rim: [f64; 2]) -> Vec<[f64; 2]> {
    let radius = (rim[0] - centre[0]).hypot(rim[1] - centre[1]);
    let corner = |index: usize| {
        let (sine, cosine) = (index as f64 / CIRCLE_CORNERS as f64 * std::f64::consts::TAU).sin_cos();
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    };
    (0..CIRCLE_CORNERS).map(corner).collect()
}
