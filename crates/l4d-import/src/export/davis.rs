//! Instances as DAVIS has them: a sequence a camera, JPEG pictures, palette pictures with a number an object.

use std::collections::BTreeSet;

use l4d_data::scene::Instance;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Role, Split};
use l4d_frames::ids;
use l4d_frames::overlay::encode_jpeg;
use rayon::prelude::*;

use super::manifest::{Called, Manifest};
use super::{Job, annotated, limit};

/// A palette has so many numbers beside 0; 255 is DAVIS' own for pixels that do not count.
const MOST_OBJECTS: usize = 254;

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { order, footage, .. } = job;
    let scene = footage.scene();
    let objects: Vec<&Instance> =
        scene.instances.iter().filter(|instance| instance.role == Role::Object).collect();
    if objects.len() > MOST_OBJECTS {
        return Err(limit(footage, "instances", format!("{} objects do not fit a palette", objects.len())));
    }
    for (number, object) in (1..).zip(&objects) {
        let called = format!("{number}");
        manifest.instances.push(Called { name: object.name.clone(), held_out: false, called });
    }
    let cameras = annotated::cameras(footage);
    for camera in &cameras {
        let sequence = format!("{}_{}", scene.name, camera.name);
        let late = write_sequence(job, camera, &sequence, &objects)?;
        if !late.is_empty() {
            let names = late.iter().map(|object| object.name.as_str()).collect::<Vec<_>>().join(", ");
            manifest.note(format!(
                "{sequence}: not visible at the first moment, so that DAVIS' evaluator does not count them: {names}"
            ));
        }
        manifest.cameras.push(Called::camera(camera, sequence));
    }
    for (split, list) in [(Split::Train, "train"), (Split::Test, "val")] {
        let lines: String = cameras
            .iter()
            .filter(|camera| camera.split == split)
            .map(|camera| format!("{}_{}\n", scene.name, camera.name))
            .collect();
        write_atomic(&order.out.join("ImageSets/2017").join(format!("{list}.txt")), lines.as_bytes())?;
    }
    manifest.note(
        "numbers in the palette pictures are those of objects in `instances`; landmarks are background",
    );
    manifest.note("DAVIS' evaluator leaves out the first and the last picture of a sequence");
    manifest.note("pictures are JPEG of quality 90, as DAVIS wants: use `--format plain` for exact ones");
    annotated::note(&mut manifest, footage);
    Ok(manifest)
}

/// Writes the pictures of a camera; gives the objects that appear after its first one.
fn write_sequence<'a>(
    job: &Job<'_>,
    camera: &Camera,
    sequence: &str,
    objects: &[&'a Instance],
) -> Result<Vec<&'a Instance>, DataError> {
    let moments: Vec<(usize, u32)> = job.footage.frames().iter().copied().enumerate().collect();
    let write = |&(moment, frame): &(usize, u32)| {
        let seen = job.footage.frame(camera, frame)?;
        let surfaces = &seen.surfaces;
        let number_of =
            |id: &u32| objects.iter().position(|object| object.id == *id).map_or(0, |at| at as u8 + 1);
        let numbers: Vec<u8> = surfaces.id.iter().map(number_of).collect();
        let out = job.order.out;
        let path = out.join("JPEGImages/480p").join(sequence).join(format!("{moment:05}.jpg"));
        write_atomic(&path, &encode_jpeg(&job.footage.shown(&seen)))?;
        let path = out.join("Annotations/480p").join(sequence).join(format!("{moment:05}.png"));
        write_atomic(&path, &ids::encode_palette(surfaces.width, surfaces.height, &numbers))?;
        (job.tick)();
        Ok(numbers.into_iter().collect::<BTreeSet<u8>>())
    };
    let seen: Vec<BTreeSet<u8>> = moments.par_iter().map(write).collect::<Result<_, DataError>>()?;
    let ever: BTreeSet<u8> = seen.iter().flatten().copied().filter(|&number| number > 0).collect();
    let late = ever.into_iter().filter(|number| !seen[0].contains(number));
    Ok(late.map(|number| objects[usize::from(number) - 1]).collect())
}
