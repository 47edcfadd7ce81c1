//! Object masks that people drew on the pictures of a capture, as one file: `masks.json`.
//!
//! Owns which picture an annotation belongs to. Masks keep the size of the pictures: nothing is resized, since a mask
//! of another size was drawn on another picture.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::capture::{Capture, MASKS_SCHEMA};
pub use l4d_data::capture::{MASKS, MaskSet, MaskedInstance};
use l4d_data::error::inert;
use l4d_data::store::{list_folder, read_bounded};
use l4d_data::truth::frame_key;
use l4d_data::{DataError, Name, Split};
use l4d_masks::{Rle, ids};
use serde::Deserialize;

use super::plan::name_of;
use crate::annotations::coco::{self, Reading};
use crate::annotations::fill::Rule;
use crate::annotations::four_d_langsplat;
use crate::annotations::{AnnotatedObject, AnnotatedPicture, Annotations};

const HINT: &str = "call annotations as the pictures are called: <view>/<frame>, for example cam00/0120.png";
const MAX_BYTES: u64 = 64 << 20;

/// What people drew with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MaskFormat {
    /// One JSON file, COCO instances.
    Coco,
    /// A dataset folder of 4D LangSplat.
    #[serde(rename = "4d-langsplat")]
    FourDLangSplat,
    /// A PNG per picture, palette or grey; a number is an object.
    Png,
}

/// One annotated picture of the capture.
struct Placed {
    view: Name,
    frame: u32,
    picture: AnnotatedPicture,
}

/// Reads what was drawn on a capture. Things of one label are one instance.
///
/// # Errors
/// Files that cannot be read, pictures that the capture does not have or that are annotated twice, and labels that
/// become the same name.
pub fn read(capture: &Capture, path: &Path, format: MaskFormat) -> Result<MaskSet, DataError> {
    let mut notes = Vec::new();
    let placed = match format {
        MaskFormat::Png => files(capture, path)?,
        MaskFormat::Coco => {
            let reading = Reading { rule: Rule::Centres, first_polygon_only: false };
            document(capture, path, coco::read(path, reading)?, &mut notes)?
        }
        MaskFormat::FourDLangSplat => dataset(capture, path, &mut notes)?,
    };
    let mut labels: Vec<String> =
        placed.iter().flat_map(|placed| placed.picture.labels().into_iter().map(str::to_owned)).collect();
    labels.sort();
    labels.dedup();
    let mut instances = Vec::new();
    for (id, label) in (1..).zip(labels) {
        let name = name_of(path, &label)?;
        if instances.iter().any(|other: &MaskedInstance| other.name == name) {
            let message = format!("`{}` and another label would both be called {name}", inert(&label));
            let hint = "give labels that differ in letters and digits";
            return Err(DataError::invalid(path, "labels", message, hint));
        }
        instances.push(MaskedInstance { id, name, masks: masks_of(&placed, &label), label });
    }
    if instances.is_empty() {
        return Err(DataError::invalid(path, "annotations", "nothing is drawn on any picture", HINT));
    }
    notes.push(
        "an instance is everything of one label; give things that differ labels that differ".to_owned(),
    );
    let (width, height) = (capture.width, capture.height);
    Ok(MaskSet {
        schema: MASKS_SCHEMA.to_owned(),
        scene: capture.name.clone(),
        width,
        height,
        instances,
        notes,
    })
}

fn masks_of(placed: &[Placed], label: &str) -> BTreeMap<Name, BTreeMap<String, Option<Rle>>> {
    let mut masks: BTreeMap<Name, BTreeMap<String, Option<Rle>>> = BTreeMap::new();
    for Placed { view, frame, picture } in placed {
        let mask = picture.union_of(label);
        let mask = (!mask.is_empty()).then(|| mask.to_rle());
        masks.entry(view.clone()).or_default().insert(frame_key(*frame), mask);
    }
    masks
}

/// Reads the PNG files in a folder or in folders called like views.
fn files(capture: &Capture, folder: &Path) -> Result<Vec<Placed>, DataError> {
    let mut names = Vec::new();
    for entry in list_folder(folder)? {
        if folder.join(&entry).is_dir() {
            let inner = list_folder(&folder.join(&entry))?;
            names.extend(inner.into_iter().map(|name| format!("{entry}/{name}")));
        } else {
            names.push(entry);
        }
    }
    let pictures = names.iter().filter(|name| name.ends_with(".png"));
    let placed = pictures.map(|name| place(capture, &folder.join(name), name, read_png(&folder.join(name))?));
    no_doubles(folder, placed.collect::<Result<_, _>>()?)
}

fn document(
    capture: &Capture,
    path: &Path,
    annotations: Annotations,
    notes: &mut Vec<String>,
) -> Result<Vec<Placed>, DataError> {
    notes.extend(annotations.notes);
    let placed = annotations.pictures.into_iter().map(|picture| {
        let name = picture.file_name.clone();
        place(capture, path, &name, picture)
    });
    no_doubles(path, placed.collect::<Result<_, _>>()?)
}

/// Annotations of the held-out view, by the numbers of their pictures.
fn dataset(capture: &Capture, folder: &Path, notes: &mut Vec<String>) -> Result<Vec<Placed>, DataError> {
    let first = u32::from(capture.source == "hypernerf");
    let (annotations, moments) = four_d_langsplat::read(folder, first)?;
    notes.extend(annotations.notes);
    let view = only_view(capture, folder, "the data set")?;
    let placed = annotations.pictures.into_iter().zip(moments);
    let placed = placed.map(|(picture, frame)| checked(capture, folder, view.clone(), frame, picture));
    no_doubles(folder, placed.collect::<Result<_, _>>()?)
}

fn read_png(file: &Path) -> Result<AnnotatedPicture, DataError> {
    let picture = ids::decode(&read_bounded(file, MAX_BYTES)?)
        .map_err(|error| DataError::invalid(file, "PNG", error.to_string(), error.hint()))?;
    let object = |id: u32| AnnotatedObject { label: format!("object_{id}"), mask: picture.mask(id) };
    Ok(AnnotatedPicture {
        file_name: String::new(),
        width: picture.width,
        height: picture.height,
        objects: picture.present().into_iter().map(object).collect(),
    })
}

/// Finds view and frame in `<view>/<frame>.<suffix>` or `<view>_<frame>.<suffix>`; without a view it is the one that is
/// held out.
fn place(capture: &Capture, file: &Path, name: &str, picture: AnnotatedPicture) -> Result<Placed, DataError> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let digits = stem.bytes().rev().take_while(u8::is_ascii_digit).count();
    let (before, number) = stem.split_at(stem.len() - digits);
    let frame = number.parse().ok().ok_or_else(|| {
        let message = format!("`{}` does not end in the number of a frame", inert(name));
        DataError::invalid(file, "name", message, HINT)
    })?;
    let called = before.trim_end_matches(['/', '_', '-']).rsplit('/').next().unwrap_or_default();
    let view = match capture.cameras.iter().find(|camera| camera.name.as_str() == called) {
        Some(camera) => camera.name.clone(),
        None => only_view(capture, file, name)?,
    };
    checked(capture, file, view, frame, picture)
}

fn only_view(capture: &Capture, file: &Path, name: &str) -> Result<Name, DataError> {
    let held_out: Vec<_> = capture.cameras.iter().filter(|camera| camera.split == Split::Test).collect();
    match (held_out.as_slice(), capture.cameras.as_slice()) {
        ([camera], _) => Ok(camera.name.clone()),
        ([], [camera]) => Ok(camera.name.clone()),
        _ => {
            let message = format!("`{}` names no view, and more than one could be meant", inert(name));
            Err(DataError::invalid(file, "name", message, HINT))
        }
    }
}

fn checked(
    capture: &Capture,
    file: &Path,
    view: Name,
    frame: u32,
    picture: AnnotatedPicture,
) -> Result<Placed, DataError> {
    if !capture.frames.contains(&frame) {
        let message = format!("frame {frame} is not in the capture");
        return Err(DataError::invalid(file, "name", message, "count frames as the capture does"));
    }
    if (picture.width, picture.height) != (capture.width, capture.height) {
        let message = format!(
            "was drawn on {}x{}, but pictures of the capture are {}x{}",
            picture.width, picture.height, capture.width, capture.height
        );
        let hint = "annotate the pictures in `frames/` of the capture: its size and lens are theirs";
        return Err(DataError::invalid(file, "size", message, hint));
    }
    Ok(Placed { view, frame, picture })
}

fn no_doubles(path: &Path, placed: Vec<Placed>) -> Result<Vec<Placed>, DataError> {
    let mut seen = std::collections::BTreeSet::new();
    match placed.iter().find(|placed| !seen.insert((placed.view.clone(), placed.frame))) {
        None => Ok(placed),
        Some(twice) => {
            let message = format!("{} at frame {} is annotated twice", twice.view, twice.frame);
            Err(DataError::invalid(path, "pictures", message, "keep one annotation a picture"))
        }
    }
}
