//! Instances as COCO annotations with run lengths: `instances_<split>.json` and pictures.

use std::collections::BTreeSet;

use l4d_data::scene::Instance;
use l4d_data::{Camera, DataError, Role, Split};
use l4d_masks::mask::{Mask, PixelBox};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

use super::manifest::{Called, Manifest};
use super::views::{PictureFile, SceneViews};
use super::{Job, annotated};

#[derive(Debug, Clone, Serialize)]
struct Category {
    id: usize,
    name: String,
    supercategory: &'static str,
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, views, .. } = job;
    let categories = categories(&views.instances);
    let cameras = annotated::cameras(views)?;
    for camera in &cameras {
        manifest.cameras.push(Called::camera(camera, format!("images/{}", camera.name)));
    }
    for instance in &views.instances {
        let called = instance.id.to_string();
        manifest.instances.push(Called { name: instance.name.clone(), held_out: false, called });
    }
    for (split, name) in [(Split::Train, "train"), (Split::Test, "test")] {
        let cameras: Vec<&Camera> = cameras.iter().copied().filter(|camera| camera.split == split).collect();
        if !cameras.is_empty() {
            let document = document(job, &cameras, &categories)?;
            l4d_data::json::write_compact(&order.out.join(format!("instances_{name}.json")), &document)?;
        }
    }
    manifest.note("segmentation is compressed run lengths, not polygons; iscrowd is 0");
    annotated::note(&mut manifest, views);
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

fn document(job: &Job<'_>, cameras: &[&Camera], categories: &[Category]) -> Result<Value, DataError> {
    let views = job.views;
    let pictures: Vec<(&Camera, u32)> =
        cameras.iter().flat_map(|camera| views.frames.iter().map(move |&frame| (*camera, frame))).collect();
    // A picture that no one looked at is no picture without things: it is left out.
    let masks: Vec<Option<Vec<(&Instance, Mask)>>> = pictures
        .par_iter()
        .map(|(camera, frame)| write_and_read(job, camera, *frame))
        .collect::<Result<_, _>>()?;
    let [width, height] = views.size;
    let annotated = pictures.into_iter().zip(masks).filter_map(|(picture, masks)| Some((picture, masks?)));
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    for (index, ((camera, frame), masks)) in annotated.enumerate() {
        images.push(json!({
            "id": index + 1, "file_name": file_name(camera, frame), "width": width, "height": height,
            "view": camera.name, "frame": frame,
        }));
        for (instance, mask) in masks {
            let Some(PixelBox { first_col, first_row, last_col, last_row }) = mask.bounding_box() else {
                continue;
            };
            annotations.push(json!({
                "id": annotations.len() + 1,
                "image_id": index + 1,
                "category_id": category_of(instance, categories),
                "segmentation": { "size": [height, width], "counts": mask.to_rle() },
                "area": mask.area(),
                "bbox": [first_col, first_row, last_col - first_col + 1, last_row - first_row + 1],
                "iscrowd": 0,
                // Not COCO's: the same thing has the same number in all pictures.
                "instance_id": instance.id,
            }));
        }
    }
    Ok(json!({
        "info": { "description": format!("{} ({})", views.name, views.profile), "version": "1" },
        "images": images,
        "annotations": annotations,
        "categories": categories,
    }))
}

/// Writes a picture and gives the masks of the instances that it shows; neither if no one looked at it.
fn write_and_read<'a>(
    job: &Job<'a>,
    camera: &Camera,
    frame: u32,
) -> Result<Option<Vec<(&'a Instance, Mask)>>, DataError> {
    let views: &'a SceneViews = job.views;
    let masks = views.masks(camera, frame)?;
    if masks.is_some() {
        let path = job.order.out.join(file_name(camera, frame));
        views.write_png(&[PictureFile { camera, frame, path, depth: None }], job.tick)?;
    }
    Ok(masks)
}

fn file_name(camera: &Camera, frame: u32) -> String {
    format!("images/{}/{frame:04}.png", camera.name)
}
