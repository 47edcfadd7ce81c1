//! The truth of the held-out camera for the evaluators of others.
//!
//! The masks are the truth that results are judged by: they belong beside an evaluator, never beside a trainer.

use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError};
use l4d_frames::drawn::RgbImage;
use l4d_frames::overlay::encode_jpeg;
use l4d_masks::mask::nearest;

use super::manifest::{Called, Manifest};
use super::{Format, Job, limit};
use crate::annotations::{QueriesWithTruth, four_d_langsplat, lerf_ovs};

pub(super) fn write(job: &Job<'_>, mut manifest: Manifest) -> Result<Manifest, DataError> {
    let Job { request, views, .. } = job;
    let (judged, camera) = camera(job)?;
    manifest.cameras.push(Called::camera(camera, camera.name.as_str()));
    match request.format {
        Format::LerfOvs => write_lerf_ovs(job, judged, camera, &mut manifest)?,
        _ => write_4d_langsplat(job, judged, camera, &mut manifest)?,
    }
    manifest.note(
        "a mask is cut into pieces without holes, each an annotation: their union is the mask to the pixel",
    );
    manifest.note(if views.shows_held_out_pictures() {
        "pictures are those of the held-out camera"
    } else {
        "pictures are grey: evaluators only draw on them"
    });
    manifest.note("these masks are the truth that results are judged by: keep them away from trainers");
    Ok(manifest)
}

/// The truth of an request, and the camera that it is of.
pub(super) fn camera<'a>(job: &Job<'a>) -> Result<(&'a QueriesWithTruth<'a>, &'a Camera), DataError> {
    let Job { request, views, .. } = job;
    let judged =
        request.judged.ok_or_else(|| limit(views, "name", "its queries and truth were not given"))?;
    let truth = judged.truth();
    let is_ours = truth.scene == views.name && truth.profile == views.profile;
    match views.camera(&truth.test_view) {
        Some(camera) if is_ours && [truth.width, truth.height] == views.size => Ok((judged, camera)),
        _ => Err(limit(views, "name", "the truth is that of another scene or profile")),
    }
}

fn write_4d_langsplat(
    job: &Job<'_>,
    judged: &QueriesWithTruth<'_>,
    camera: &Camera,
    manifest: &mut Manifest,
) -> Result<(), DataError> {
    let names = four_d_langsplat::write(job.request.out, judged)?;
    let [width, height] = four_d_langsplat::drawn_size(judged.truth());
    for (name, &frame) in names.iter().zip(&judged.truth().frames) {
        let picture = job.views.picture(camera, frame)?;
        let picture = RgbImage::from_fn(width, height, |col, row| {
            *picture.get_pixel(nearest(col, picture.width(), width), nearest(row, picture.height(), height))
        });
        let path = job.request.out.join("annotations/train").join(name);
        write_atomic(&path, &encode_jpeg(&picture))?;
        (job.tick)();
    }
    manifest.note(format!(
        "masks and pictures are {width}x{height}: its evaluator takes latents of no other size"
    ));
    manifest.note("file names count as Neu3D's do: evaluate with the data set type neu3d, test view cam00");
    manifest.note("the i-th moment is the i-th picture that `--format 4d-langsplat` gives cam00");
    manifest.note("gated sentences are prompts of their base object in video_annotations.json");
    Ok(())
}

fn write_lerf_ovs(
    job: &Job<'_>,
    judged: &QueriesWithTruth<'_>,
    camera: &Camera,
    manifest: &mut Manifest,
) -> Result<(), DataError> {
    for frame in lerf_ovs::write(job.request.out, judged)? {
        let folder = job.request.out.join(lerf_ovs::moment_folder(&judged.truth().scene, frame));
        let picture = job.views.picture(camera, frame)?;
        write_atomic(&folder.join(format!("{}.jpg", lerf_ovs::STEM)), &encode_jpeg(&picture))?;
        (job.tick)();
    }
    manifest.note("each moment is a scene with the one picture frame_00001: draw the held-out camera alone, as 00000.npy");
    Ok(())
}
