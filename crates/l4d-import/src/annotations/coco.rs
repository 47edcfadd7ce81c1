//! COCO instance annotations: polygons, run lengths plain and compressed.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::error::inert;
use l4d_data::{DataError, Rle, json};
use l4d_masks::Mask;
use serde::Deserialize;

use super::fill::{Rule, fill};
use super::{AnnotatedObject, AnnotatedPicture, Annotations};

const HINT: &str = "export the annotations again as COCO instances (polygons or run lengths)";

/// What a reader makes of polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reading {
    /// How a polygon becomes pixels.
    pub rule: Rule,
    /// Whether further polygons of an annotation are dropped, as 4D LangSplat's evaluator drops them.
    pub first_polygon_only: bool,
}

#[derive(Debug, Deserialize)]
struct Document {
    images: Vec<Image>,
    annotations: Vec<Annotation>,
    categories: Vec<Category>,
}

#[derive(Debug, Deserialize)]
struct Image {
    id: u64,
    file_name: String,
    width: u32,
    height: u32,
}

#[derive(Debug, Deserialize)]
struct Annotation {
    id: u64,
    image_id: u64,
    category_id: u64,
    segmentation: Segmentation,
}

#[derive(Debug, Deserialize)]
struct Category {
    id: u64,
    name: String,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Segmentation {
    Polygons(Vec<Vec<f64>>),
    Runs { size: [u32; 2], counts: Counts },
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Counts {
    Compressed(String),
    Plain(Vec<u64>),
}

/// Reads a document. Images without annotations are kept: there the things are absent.
///
/// # Errors
/// A file that cannot be read, numbers of images and categories that are missing or repeated, and masks that do not fit
/// their image.
pub fn read(path: &Path, reading: Reading) -> Result<Annotations, DataError> {
    let document: Document = json::read(path)?;
    let names: BTreeMap<u64, &str> =
        document.categories.iter().map(|category| (category.id, category.name.as_str())).collect();
    let mut pictures = Vec::with_capacity(document.images.len());
    let mut places = BTreeMap::new();
    for image in &document.images {
        if !Mask::is_sane_size(image.width, image.height) {
            let (width, height) = (image.width, image.height);
            let message = format!("is {width}x{height}, but each side has 1 to {} pixels", Mask::MAX_SIDE);
            return Err(wrong(path, format!("image {}", image.id), message));
        }
        if places.insert(image.id, pictures.len()).is_some() {
            return Err(wrong(path, format!("image {}", image.id), "the number occurs twice"));
        }
        pictures.push(AnnotatedPicture {
            file_name: image.file_name.clone(),
            width: image.width,
            height: image.height,
            objects: Vec::new(),
        });
    }
    let mut dropped = 0;
    for annotation in &document.annotations {
        let place = format!("annotation {}", annotation.id);
        let picture = places.get(&annotation.image_id).map(|&index| &mut pictures[index]);
        let picture = picture
            .ok_or_else(|| wrong(path, &place, format!("image {} is missing", annotation.image_id)))?;
        let label = names.get(&annotation.category_id);
        let label = label
            .ok_or_else(|| wrong(path, &place, format!("category {} is missing", annotation.category_id)))?;
        let mask = mask_of(annotation, picture.width, picture.height, reading, &mut dropped)
            .map_err(|message| wrong(path, &place, message))?;
        picture.objects.push(AnnotatedObject { label: (*label).to_owned(), mask });
    }
    let mut notes = Vec::new();
    if dropped > 0 {
        notes.push(format!(
            "{dropped} polygons beyond the first of their annotation are left out, as the original does"
        ));
    }
    Ok(Annotations { pictures, notes })
}

fn mask_of(
    annotation: &Annotation,
    width: u32,
    height: u32,
    reading: Reading,
    dropped: &mut usize,
) -> Result<Mask, String> {
    match &annotation.segmentation {
        Segmentation::Polygons(polygons) => {
            let taken = if reading.first_polygon_only { polygons.len().min(1) } else { polygons.len() };
            *dropped += polygons.len() - taken;
            let mut mask = Mask::empty(width, height);
            for polygon in &polygons[..taken] {
                let (corners, rest) = polygon.as_chunks::<2>();
                if !rest.is_empty() {
                    return Err("a polygon has a column without a row".to_owned());
                }
                mask.union_with(&fill(reading.rule, corners, width, height));
            }
            Ok(mask)
        }
        Segmentation::Runs { size, .. } if *size != [height, width] => {
            Err(format!("run lengths are for {}x{}, the picture is {width}x{height}", size[1], size[0]))
        }
        Segmentation::Runs { counts: Counts::Compressed(text), .. } => {
            Mask::decode(text, width, height).map_err(|error| inert(&error.to_string()))
        }
        Segmentation::Runs { counts: Counts::Plain(runs), .. } => plain_runs(runs, width, height),
    }
}

/// A mask from the lengths of its runs down the columns, outside first.
pub(crate) fn plain_runs(runs: &[u64], width: u32, height: u32) -> Result<Mask, String> {
    match Rle::from_lengths(runs.iter().copied(), width * height) {
        Some(rle) => Ok(Mask::from_rle(&rle, width, height)),
        None => Err(format!("the runs do not cover {width}x{height} pixels")),
    }
}

fn wrong(path: &Path, place: impl Into<String>, message: impl Into<String>) -> DataError {
    DataError::invalid(path, place, message, HINT)
}
