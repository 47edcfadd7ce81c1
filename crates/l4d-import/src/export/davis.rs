//! Instances as DAVIS has them: a sequence a camera, JPEG pictures, palette pictures with a number an object.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::scene::Instance;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Role, Split};
use l4d_frames::overlay::encode_jpeg;
use l4d_masks::{Mask, ids};
use rayon::prelude::*;

use super::manifest::{Called, Manifest};
use super::{Job, annotated, limit};

/// A palette has so many numbers beside 0; 255 is DAVIS' own for pixels that do not count.
const MOST_OBJECTS: usize = 254;

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, .. } = job;
    let objects: Vec<&Instance> =
        views.instances.iter().filter(|instance| instance.role == Role::Object).collect();
    if objects.len() > MOST_OBJECTS {
        return Err(limit(views, "instances", format!("{} objects do not fit a palette", objects.len())));
    }
    for (number, object) in (1..).zip(&objects) {
        let called = format!("{number}");
        manifest.instances.push(Called { name: object.name.clone(), held_out: false, called });
    }
    let cameras = annotated::cameras(views)?;
    for camera in &cameras {
        let sequence = format!("{}_{}", views.name, camera.name);
        for note in write_sequence(job, camera, &sequence, &objects)? {
            manifest.note(format!("{sequence}: {note}"));
        }
        manifest.cameras.push(Called::camera(camera, sequence));
    }
    for (split, list) in [(Split::Train, "train"), (Split::Test, "val")] {
        let lines: String = cameras
            .iter()
            .filter(|camera| camera.split == split)
            .map(|camera| format!("{}_{}\n", views.name, camera.name))
            .collect();
        write_atomic(&request.out.join("ImageSets/2017").join(format!("{list}.txt")), lines.as_bytes())?;
    }
    manifest.note(
        "numbers in the palette pictures are those of objects in `instances`; landmarks are background",
    );
    manifest.note("DAVIS' evaluator leaves out the first and the last picture of a sequence");
    manifest.note("pictures are JPEG of quality 90, as DAVIS wants");
    annotated::note(&mut manifest, views);
    Ok(manifest)
}

/// A picture and its numbers.
struct Numbered {
    seen: BTreeSet<u8>,
    is_overlapping: bool,
}

/// Writes the pictures of a camera that saw something, and what was drawn on them; gives what DAVIS cannot say of it.
fn write_sequence(
    job: &Job<'_>,
    camera: &Camera,
    sequence: &str,
    objects: &[&Instance],
) -> Result<Vec<String>, DataError> {
    let moments = job.views.frames.iter().copied().enumerate();
    let moments: Vec<(usize, u32)> = moments.filter(|(_, frame)| job.views.saw(camera, *frame)).collect();
    let write = |&(moment, frame): &(usize, u32)| {
        let path = job.request.out.join("JPEGImages/480p").join(sequence).join(format!("{moment:05}.jpg"));
        write_atomic(&path, &encode_jpeg(&job.views.picture(camera, frame)?))?;
        let masks = job.views.masks(camera, frame)?;
        let path = job.request.out.join("Annotations/480p").join(sequence).join(format!("{moment:05}.png"));
        let numbered = masks.map(|masks| write_numbers(job, &path, &masks, objects)).transpose()?;
        (job.tick)();
        Ok(numbered)
    };
    let pictures: Vec<Option<Numbered>> = moments.par_iter().map(write).collect::<Result<_, DataError>>()?;
    let annotated: Vec<&Numbered> = pictures.iter().flatten().collect();
    let first = annotated.first().map(|picture| picture.seen.clone()).unwrap_or_default();
    let ever: BTreeSet<u8> = annotated.iter().flat_map(|picture| picture.seen.iter().copied()).collect();
    let late = ever.difference(&first).map(|number| objects[usize::from(*number) - 1].name.as_str());
    let late = late.collect::<Vec<_>>().join(", ");
    let unannotated = pictures.len() - annotated.len();
    let overlapping = annotated.iter().filter(|picture| picture.is_overlapping).count();
    let mut notes = Vec::new();
    if !late.is_empty() {
        notes.push(format!(
            "not visible at the first moment, so that DAVIS' evaluator does not count them: {late}"
        ));
    }
    if unannotated > 0 {
        notes.push(format!("{unannotated} pictures without an annotation, since no one drew on them"));
    }
    if overlapping > 0 {
        notes.push(format!(
            "in {overlapping} pictures objects share pixels, which the one with the lowest number keeps"
        ));
    }
    Ok(notes)
}

/// Writes a palette picture with the numbers of objects, from 1.
fn write_numbers(
    job: &Job<'_>,
    path: &Path,
    masks: &[(&Instance, Mask)],
    objects: &[&Instance],
) -> Result<Numbered, DataError> {
    let [width, height] = job.views.size;
    let mut numbers = vec![0; width as usize * height as usize];
    let mut numbered = Numbered { seen: BTreeSet::new(), is_overlapping: false };
    for (number, object) in (1..).zip(objects) {
        let Some((_, mask)) = masks.iter().find(|(instance, _)| instance.id == object.id) else { continue };
        for (column, row) in mask.pixels() {
            let pixel = &mut numbers[row as usize * width as usize + column as usize];
            numbered.is_overlapping |= *pixel != 0;
            if *pixel == 0 {
                *pixel = number;
                numbered.seen.insert(number);
            }
        }
    }
    write_atomic(path, &ids::encode_palette(width, height, &numbers))?;
    Ok(numbered)
}
