//! Instances as COCO annotations with run lengths: `instances_<split>.json` and pictures.

use std::collections::BTreeSet;

use l4d_data::scene::Instance;
use l4d_data::{Camera, DataError, Role, Split, json};
use l4d_masks::Rle;
use l4d_masks::mask::Mask;
use rayon::prelude::*;
use serde::Serialize;

use super::footage::{Footage, Shot};
use super::manifest::{Called, Manifest};
use super::{Job, annotated};

#[derive(Debug, Serialize)]
struct Document {
    info: Info,
    images: Vec<Image>,
    annotations: Vec<Annotation>,
    categories: Vec<Category>,
}

#[derive(Debug, Serialize)]
struct Info {
    description: String,
    version: &'static str,
}

#[derive(Debug, Serialize)]
struct Image {
    id: usize,
    file_name: String,
    width: u32,
    height: u32,
    view: String,
    frame: u32,
}

#[derive(Debug, Serialize)]
struct Annotation {
    id: usize,
    image_id: usize,
    category_id: usize,
    segmentation: Segmentation,
    area: u64,
    /// x, y, width, height, pixels.
    bbox: [u32; 4],
    iscrowd: u8,
    /// Not COCO's: the same thing has the same number in all pictures.
    instance_id: u32,
}

#[derive(Debug, Serialize)]
struct Segmentation {
    /// Height, width.
    size: [u32; 2],
    counts: Rle,
}

#[derive(Debug, Clone, Serialize)]
struct Category {
    id: usize,
    name: String,
    supercategory: &'static str,
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, .. } = job;
    let categories = categories(footage.instances());
    let cameras = annotated::cameras(footage)?;
    for camera in &cameras {
        manifest.cameras.push(Called::camera(camera, format!("images/{}", camera.name)));
    }
    for instance in footage.instances() {
        let called = instance.id.to_string();
        manifest.instances.push(Called { name: instance.name.clone(), held_out: false, called });
    }
    for (split, name) in [(Split::Train, "train"), (Split::Test, "test")] {
        let cameras: Vec<&Camera> = cameras.iter().copied().filter(|camera| camera.split == split).collect();
        if !cameras.is_empty() {
            let document = document(job, &cameras, &categories)?;
            json::write_compact(&order.out.join(format!("instances_{name}.json")), &document)?;
        }
    }
    manifest.note("segmentation is compressed run lengths, not polygons; iscrowd is 0");
    annotated::note(&mut manifest, footage);
    Ok(manifest)
}

/// Common nouns, objects before landmarks.
fn categories(instances: &[Instance]) -> Vec<Category> {
    let nouns: BTreeSet<(Role, &str)> =
        instances.iter().map(|instance| (instance.role, instance.category.as_str())).collect();
    let category = |(index, (role, noun)): (usize, (Role, &str))| Category {
        id: index + 1,
        name: noun.to_owned(),
        supercategory: if role == Role::Object { "object" } else { "landmark" },
    };
    nouns.into_iter().enumerate().map(category).collect()
}

fn category_of(instance: &Instance, categories: &[Category]) -> usize {
    let supercategory = if instance.role == Role::Object { "object" } else { "landmark" };
    let matches =
        |category: &&Category| category.name == instance.category && category.supercategory == supercategory;
    categories.iter().find(matches).map_or(0, |category| category.id)
}

fn document(job: &Job<'_>, cameras: &[&Camera], categories: &[Category]) -> Result<Document, DataError> {
    let footage = job.footage;
    let shots: Vec<(&Camera, u32)> = cameras
        .iter()
        .flat_map(|camera| footage.frames().iter().map(move |&frame| (*camera, frame)))
        .collect();
    // A picture that nobody looked at is no picture without things: it is left out.
    let masks: Vec<Option<Vec<(&Instance, Mask)>>> = shots
        .par_iter()
        .map(|(camera, frame)| write_and_read(job, camera, *frame))
        .collect::<Result<_, _>>()?;
    let [width, height] = footage.size();
    let annotated = shots.into_iter().zip(masks).filter_map(|(shot, masks)| Some((shot, masks?)));
    let mut document = Document {
        info: Info { description: format!("{} ({})", footage.name(), footage.profile()), version: "1" },
        images: Vec::new(),
        annotations: Vec::new(),
        categories: categories.to_vec(),
    };
    for (index, ((camera, frame), masks)) in annotated.enumerate() {
        document.images.push(Image {
            id: index + 1,
            file_name: file_name(camera, frame),
            width,
            height,
            view: camera.name.to_string(),
            frame,
        });
        for (instance, mask) in masks {
            let Some(bounds) = mask.bounding_box() else { continue };
            let (columns, rows) =
                (bounds.last_col - bounds.first_col + 1, bounds.last_row - bounds.first_row + 1);
            document.annotations.push(Annotation {
                id: document.annotations.len() + 1,
                image_id: index + 1,
                category_id: category_of(instance, categories),
                segmentation: Segmentation { size: [height, width], counts: mask.to_rle() },
                area: mask.area(),
                bbox: [bounds.first_col, bounds.first_row, columns, rows],
                iscrowd: 0,
                instance_id: instance.id,
            });
        }
    }
    Ok(document)
}

/// Writes a picture and gives the masks of the instances that it shows; neither if nobody looked at it.
fn write_and_read<'a>(
    job: &Job<'a>,
    camera: &Camera,
    frame: u32,
) -> Result<Option<Vec<(&'a Instance, Mask)>>, DataError> {
    let footage: &'a Footage = job.footage;
    let masks = footage.masks(camera, frame)?;
    if masks.is_some() {
        let path = job.order.out.join(file_name(camera, frame));
        footage.write_png(&[Shot { camera, frame, path, depth: None }], job.tick)?;
    }
    Ok(masks)
}

fn file_name(camera: &Camera, frame: u32) -> String {
    format!("images/{}/{frame:04}.png", camera.name)
}
