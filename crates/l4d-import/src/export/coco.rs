//! Instances as COCO annotations with run lengths: `instances_<split>.json` and pictures.

use std::collections::BTreeSet;

use l4d_data::scene::Instance;
use l4d_data::{Camera, DataError, Role, Split};
use l4d_masks::mask::{Mask, PixelBox};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::manifest::{Called, Manifest};
use super::views::{PictureFile, SceneViews};
use super::{Job, annotated};

/// A common noun, of objects or of landmarks.
type Noun<'a> = (Role, &'a str);

fn noun_of(instance: &Instance) -> Noun<'_> {
    (instance.role, &instance.category)
}

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, .. } = job;
    // Objects before landmarks.
    let nouns: BTreeSet<Noun<'_>> = views.instances.iter().map(noun_of).collect();
    let nouns: Vec<Noun<'_>> = nouns.into_iter().collect();
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
            let document = document(job, &cameras, &nouns)?;
            l4d_data::json::write_compact(&request.out.join(format!("instances_{name}.json")), &document)?;
        }
    }
    manifest.note("segmentation is compressed run lengths, not polygons; iscrowd is 0");
    annotated::note(&mut manifest, views);
    Ok(manifest)
}

fn document(job: &Job<'_>, cameras: &[&Camera], nouns: &[Noun<'_>]) -> Result<Value, DataError> {
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
            let category = nouns.iter().position(|noun| *noun == noun_of(instance));
            annotations.push(json!({
                "id": annotations.len() + 1,
                "image_id": index + 1,
                "category_id": category.map_or(0, |index| index + 1),
                "segmentation": { "size": [height, width], "counts": mask.to_rle() },
                "area": mask.area(),
                "bbox": [first_col, first_row, last_col - first_col + 1, last_row - first_row + 1],
                "iscrowd": 0,
                // Not COCO's: the same thing has the same number in all pictures.
                "instance_id": instance.id,
            }));
        }
    }
    let category = |(index, (role, noun)): (usize, &Noun<'_>)| {
        let supercategory = if *role == Role::Object { "object" } else { "landmark" };
        json!({ "id": index + 1, "name": noun, "supercategory": supercategory })
    };
    Ok(json!({
        "info": { "description": format!("{} ({})", views.name, views.profile), "version": "1" },
        "images": images,
        "annotations": annotations,
        "categories": nouns.iter().enumerate().map(category).collect::<Vec<_>>(),
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
        let path = job.request.out.join(file_name(camera, frame));
        views.write_png(&[PictureFile { camera, frame, path, depth: None }], job.tick)?;
    }
    Ok(masks)
}

fn file_name(camera: &Camera, frame: u32) -> String {
    format!("images/{}/{frame:04}.png", camera.name)
}
