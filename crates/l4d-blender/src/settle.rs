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
use l4d_data::tracks::TrackedInstance;
use l4d_data::truth::{Truth, frame_key};
use l4d_data::{Camera, DataError, Report, StageError, json, scene, sums};
use l4d_frames::exr::{decode_surfaces, read_bytes};
use l4d_frames::truth::{Observation, TruthBuilder};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::render::{Image, PlannedScene};

/// `view.json`, as a worker wrote it.
#[derive(Debug, Deserialize)]
struct ViewCard {
    #[serde(flatten)]
    camera: Camera,
}

/// What one picture contributes.
struct SettledPicture {
    image: Image,
    file_sha256: String,
    digest: FrameDigest,
    observation: Observation,
}

/// Merges the frames of a scene whose pictures are all there. Writes `scene.json` and `SHA256SUMS`; gives the truth.
///
/// # Errors
/// A file that cannot be read, decoded or written.
pub fn settle(planned: &PlannedScene) -> Result<Truth> {
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
    let tracks = &planned.plan.tracks;
    let cameras = tracks.views(settings.profile).map(|camera| {
        let path = planned.dir.view_card(&camera.name);
        json::read::<ViewCard>(&path).map(|card| card.camera)
    });
    Ok(Scene {
        schema: scene::SCHEMA.to_owned(),
        name: planned.name.clone(),
        scale: tracks.scale,
        variant: settings.variant,
        seed: settings.seed,
        profile: settings.profile,
        stride: settings.profile.stride(),
        width: settings.profile.width(),
        height: settings.profile.height(),
        exposure: tracks.exposure,
        generator: Generator { bpy: settings.bpy.clone(), scripts_sha256: settings.scripts_sha256.clone() },
        cameras: cameras.collect::<Result<_, DataError>>()?,
        instances: tracks.instances.iter().map(TrackedInstance::instance).collect(),
        events: tracks.events.clone(),
        digests: BTreeMap::new(),
    })
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
///
/// # Errors
/// What the disk refuses.
pub fn commit<T: Serialize>(path: &Path, document: &T, update: bool, report: &mut Report) -> Result<()> {
    let text = serde_json::to_string(document).map_err(|error| StageError::of(&error, None))? + "\n";
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
