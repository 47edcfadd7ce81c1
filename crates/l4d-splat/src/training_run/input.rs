//! Pictures from disk: those that are trained on, and those that are only compared with, kept apart.

use std::collections::BTreeMap;

use l4d_data::layout::SceneDir;
use l4d_data::{At as _, Camera, StageError};
use rayon::prelude::*;

use super::pictures::{LoadedPicture, PictureSource};
use super::{Result, plain};
use crate::train::{Motion, Picture, Region, TrainingViews};

/// Share of moments at which a place has to be seen through before it counts as moving, in reports.
const REPORT_THRESHOLD: f32 = 0.05;

/// SHA-256 by path within the scene's folder.
pub(super) type Digests = BTreeMap<String, String>;

pub(super) struct Input {
    pub(super) views: TrainingViews,
    pub(super) digests: Digests,
}

/// What is only compared with.
pub(super) struct HeldOut {
    pub(super) views: TrainingViews,
    pub(super) digests: Digests,
    motion: Motion,
    /// Pixels that show objects, by moment; none where the pictures have no ids.
    objects: Vec<Vec<bool>>,
}

impl Input {
    pub(super) fn read(dir: &SceneDir, source: &PictureSource, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        if source.training().next().is_none() {
            return Err(StageError::new(
                format!("{}: field `cameras`: none has split `train`", dir.root().display()),
                "build the scene again with `l4d build-scenes --force`, or import it again and hold fewer views out",
            ));
        }
        let (mut views, mut digests) = (empty(dir, source)?, Digests::new());
        for camera in source.training() {
            // Ids that come with depth are dropped as soon as they are decoded: training never sees them.
            let load = |frame| source.load(camera, frame, source.sees_depth);
            let pictures = read_camera(source, &load, &mut digests, tick, |loaded| loaded.picture)?;
            add(&mut views, dir, source, camera, pictures)?;
        }
        Ok(Self { views, digests })
    }
}

impl HeldOut {
    pub(super) fn read(dir: &SceneDir, source: &PictureSource, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        let (mut views, mut digests) = (empty(dir, source)?, Digests::new());
        let mut objects = Vec::new();
        if let Some(camera) = source.held_out() {
            let split = |loaded: LoadedPicture| (loaded.picture, loaded.objects);
            // Depth says what moves, and is compared with, in both tracks.
            let load = |frame| source.load(camera, frame, true);
            let (pictures, shown) =
                read_camera(source, &load, &mut digests, tick, split)?.into_iter().unzip();
            objects = shown;
            add(&mut views, dir, source, camera, pictures)?;
        }
        let motion = Motion::of(&views, REPORT_THRESHOLD);
        Ok(Self { views, digests, motion, objects })
    }

    /// Where errors are evaluated at more closely: what moves, and the depth of objects.
    pub(super) fn region(&self, moment: usize) -> Region {
        let moving = (0..self.views.pixel_count())
            .map(|pixel| self.motion.moves(&self.views, 0, moment, pixel))
            .collect();
        Region { moving, depth: self.objects.get(moment).cloned().unwrap_or_default(), structure: true }
    }
}

fn empty(dir: &SceneDir, source: &PictureSource) -> Result<TrainingViews> {
    TrainingViews::new(source.size, source.frames.clone(), source.timeline)
        .map_err(plain)
        .at(dir.root().display())
}

fn add(
    views: &mut TrainingViews,
    dir: &SceneDir,
    source: &PictureSource,
    camera: &Camera,
    pictures: Vec<Picture>,
) -> Result<()> {
    let place = format!("{}: camera {}", dir.root().display(), camera.name);
    views.add(camera, source.camera_size, pictures).map_err(plain).at(place)
}

/// One picture per moment; empty where the camera did not look.
fn read_camera<T: Send + Default>(
    source: &PictureSource,
    load: &(dyn Fn(u32) -> Result<Option<LoadedPicture>> + Sync),
    digests: &mut Digests,
    tick: &(dyn Fn() + Sync),
    keep: impl Fn(LoadedPicture) -> T + Sync,
) -> Result<Vec<T>> {
    let read = |&frame: &u32| -> Result<(T, Option<(String, String)>)> {
        let loaded = load(frame)?;
        tick();
        Ok(match loaded {
            Some(mut loaded) => {
                let named = (std::mem::take(&mut loaded.file), std::mem::take(&mut loaded.sha256));
                (keep(loaded), Some(named))
            }
            None => (T::default(), None),
        })
    };
    let (kept, named): (Vec<T>, Vec<_>) =
        source.frames.par_iter().map(read).collect::<Result<Vec<_>>>()?.into_iter().unzip();
    digests.extend(named.into_iter().flatten());
    Ok(kept)
}
