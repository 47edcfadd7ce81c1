//! What becomes of rendered frames: `scene.json`, `SHA256SUMS`, and the tracks and truth of the benchmark.
//!
//! Everything here is a deterministic function of the decoded frames, so that a build that was killed and run again
//! settles into the same bytes.

use std::collections::BTreeMap;
use std::path::Path;

use glam::UVec2;
use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::scene::{FrameDigest, Generator, Scene};
use l4d_data::store::write_atomic;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{DataError, Report, StageError, json, sums};
use l4d_frames::exr::{decode_surfaces, read_bytes};
use l4d_frames::truth::{Observation, TruthBuilder};
use rayon::prelude::*;
use serde::Serialize;

use crate::Result;
use crate::render::{Image, PlannedScene};

/// What one picture contributes.
struct SettledPicture {
    image: Image,
    file_sha256: String,
    digest: FrameDigest,
    observation: Observation,
}

/// Merges the frames of a scene whose pictures are all there. Writes `scene.json` and `SHA256SUMS`; gives the truth.
pub(crate) fn settle(planned: &PlannedScene) -> Result<Truth> {
    let mut scene = describe(planned)?;
    let mut builder = TruthBuilder::new(&scene).ok_or_else(|| {
        StageError::new("the plan has no held-out view", "give one camera of the recipe the split `test`")
    })?;
    let pictures: Vec<SettledPicture> = planned
        .images()
        .into_par_iter()
        .map(|image| look(planned, &builder, image))
        .collect::<Result<_>>()?;
    let mut sums = BTreeMap::new();
    for picture in pictures {
        let Image { frame, view } = picture.image;
        sums.insert(format!("frames/{view}/{}.exr", frame_key(frame)), picture.file_sha256);
        builder.insert(&view, frame, picture.observation);
        scene.digests.entry(view).or_default().insert(frame_key(frame), picture.digest);
    }
    json::write(&planned.dir.scene(), &scene)?;
    for file in ["scene.json", "scene.usdc", "tracks.json"] {
        sums.insert(file.to_owned(), sha256_file(&planned.dir.root().join(file))?);
    }
    write_atomic(&planned.dir.checksums(), sums::to_text(&sums).as_bytes())?;
    Ok(builder.finish())
}

fn describe(planned: &PlannedScene) -> Result<Scene> {
    let settings = &planned.settings;
    let generator = Generator { bpy: settings.bpy.clone(), scripts_sha256: settings.scripts_sha256.clone() };
    let mut scene = planned.plan.tracks.scene(settings.profile, generator);
    // As the workers placed them.
    for camera in &mut scene.cameras {
        *camera = planned.dir.read_view_card(&camera.name)?.camera;
    }
    Ok(scene)
}

fn look(planned: &PlannedScene, builder: &TruthBuilder, image: Image) -> Result<SettledPicture> {
    let size = UVec2::new(planned.settings.profile.width(), planned.settings.profile.height());
    let path = planned.dir.frame(&image.view, image.frame);
    let bytes = read_bytes(&path, size).map_err(DataError::from)?;
    let surfaces = decode_surfaces(&path, &bytes, size).map_err(DataError::from)?;
    let observation = Observation::of(&surfaces, builder.wants_masks(&image.view));
    Ok(SettledPicture { image, file_sha256: sha256_hex(&bytes), digest: surfaces.digest(), observation })
}

/// Puts a document into the benchmark folder unless another one is there.
///
/// The committed benchmark is what published scores refer to, so a difference is a finding, not an overwrite.
pub(crate) fn commit<T: Serialize>(
    path: &Path,
    document: &T,
    update: bool,
    report: &mut Report,
) -> Result<()> {
    let text = serde_json::to_string(document)? + "\n";
    match std::fs::read(path) {
        Ok(standing) if standing == text.as_bytes() => Ok(()),
        Ok(_) if !update => {
            report.error(
                "L4D120",
                path,
                "file",
                "differs from what was just built",
                "if the scene was changed on purpose, run again with --update-benchmark and raise the version in panoptic-l4d.toml",
            );
            Ok(())
        }
        _ => Ok(write_atomic(path, text.as_bytes())?),
    }
}

/// The same for truth. One that another machine may have given stays as it is: results name its digest.
pub(crate) fn commit_truth(path: &Path, truth: &Truth, update: bool, report: &mut Report) -> Result<()> {
    if !update && Truth::read(path).is_ok_and(|standing| standing.agrees_with(truth)) {
        return Ok(());
    }
    commit(path, truth, update, report)
}

#[cfg(test)]
mod tests {
    use l4d_data::rle::Rle;
    use l4d_testing::Dataset;

    use super::*;

    #[test]
    fn truth_of_another_machine_stays_as_it_was_published() {
        let dataset = Dataset::new();
        let path = dataset.bench().truth(dataset.scene.profile, &dataset.scene.name);
        let published = std::fs::read(&path).unwrap();
        let build = |change: &dyn Fn(&mut Truth)| {
            let mut truth = Truth::read(&path).unwrap();
            change(&mut truth);
            let mut report = Report::default();
            commit_truth(&path, &truth, false, &mut report).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), published);
            report.len()
        };
        let count = |truth: &mut Truth, view: &str, pixels: u32| {
            truth.visible.get_mut(view).unwrap().get_mut("ball_red").unwrap()[2] += pixels;
        };
        for view in ["cam03", "cam02"] {
            assert_eq!(build(&|truth| count(truth, view, 4)), 0, "{view}");
            assert_eq!(build(&|truth| count(truth, view, 5)), 1, "{view}");
        }
        let cut = |truth: &mut Truth, pixels: u32| {
            let mask = truth.instances[0].masks.get_mut("0048").unwrap();
            let [first, rest @ ..] = mask.runs() else { panic!("a mask without a pixel") };
            let mut less = Rle::empty(mask.pixels());
            less.push(first[0] + pixels, first[1]);
            rest.iter().for_each(|run| less.push(run[0], run[1]));
            *mask = less;
        };
        assert_eq!(build(&|truth| cut(truth, 4)), 0);
        assert_eq!(build(&|truth| cut(truth, 5)), 1);
        assert_eq!(build(&|truth| drop(truth.instances[0].masks.remove("0048"))), 1);
    }
}
