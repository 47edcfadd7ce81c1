//! Pictures from disk: those that are trained on, and those that are only compared with, kept apart.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};
use l4d_data::Camera;
use l4d_data::layout::SceneDir;
use l4d_splat::train::{Footage, Motion, Picture, Region};
use rayon::prelude::*;

use super::shoot::{Shoot, Taken};
use crate::out::refusal;

/// Share of moments at which a place has to be seen through before it counts as moving, in reports.
const REPORT_THRESHOLD: f32 = 0.05;

/// SHA-256 by path within the scene's folder.
pub(super) type Digests = BTreeMap<String, String>;

/// What is trained on.
pub(super) struct Input {
    pub(super) footage: Footage,
    pub(super) digests: Digests,
}

/// What is only compared with.
pub(super) struct HeldOut {
    pub(super) footage: Footage,
    pub(super) digests: Digests,
    motion: Motion,
    /// Pixels that show objects, by moment; none where the pictures have no ids.
    objects: Vec<Vec<bool>>,
}

impl Input {
    pub(super) fn read(dir: &SceneDir, shoot: &Shoot, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        if shoot.training().next().is_none() {
            return Err(refusal(
                format!("{}: field `cameras`: none has split `train`", dir.root().display()),
                "build the scene again with `l4d build-scenes --overwrite`, or import it again and hold fewer views out",
            ));
        }
        let (mut footage, mut digests) = (empty(dir, shoot)?, Digests::new());
        for camera in shoot.training() {
            // Ids are dropped as soon as they are decoded, if there are any: training never sees them.
            let pictures = read_camera(shoot, camera, &mut digests, tick, |taken| taken.picture)?;
            add(&mut footage, dir, shoot, camera, pictures)?;
        }
        Ok(Self { footage, digests })
    }
}

impl HeldOut {
    pub(super) fn read(dir: &SceneDir, shoot: &Shoot, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        let (mut footage, mut digests) = (empty(dir, shoot)?, Digests::new());
        let mut objects = Vec::new();
        if let Some(camera) = shoot.held_out() {
            let of_taken = |taken: Taken| (taken.picture, taken.objects);
            let (pictures, shown) =
                read_camera(shoot, camera, &mut digests, tick, of_taken)?.into_iter().unzip();
            objects = shown;
            add(&mut footage, dir, shoot, camera, pictures)?;
        }
        let motion = Motion::of(&footage, REPORT_THRESHOLD);
        Ok(Self { footage, digests, motion, objects })
    }

    /// Where errors are looked at more closely: what moves, and the depth of objects.
    pub(super) fn region(&self, moment: usize) -> Region {
        let moving = (0..self.footage.pixel_count())
            .map(|pixel| self.motion.moves(&self.footage, 0, moment, pixel))
            .collect();
        Region { moving, depth: self.objects.get(moment).cloned().unwrap_or_default() }
    }
}

fn empty(dir: &SceneDir, shoot: &Shoot) -> Result<Footage> {
    Footage::new(shoot.size, shoot.frames.clone(), shoot.timeline)
        .with_context(|| dir.root().display().to_string())
}

fn add(
    footage: &mut Footage,
    dir: &SceneDir,
    shoot: &Shoot,
    camera: &Camera,
    pictures: Vec<Picture>,
) -> Result<()> {
    footage.add(camera, shoot.camera_size, pictures).with_context(|| dir.root().display().to_string())
}

/// A picture a moment; empty where the camera did not look.
fn read_camera<T: Send + Default>(
    shoot: &Shoot,
    camera: &Camera,
    digests: &mut Digests,
    tick: &(dyn Fn() + Sync),
    keep: impl Fn(Taken) -> T + Sync,
) -> Result<Vec<T>> {
    let read = |&frame: &u32| -> Result<(T, Option<(String, String)>)> {
        let taken = shoot.take(camera, frame)?;
        tick();
        Ok(match taken {
            Some(mut taken) => {
                let named = (std::mem::take(&mut taken.file), std::mem::take(&mut taken.sha256));
                (keep(taken), Some(named))
            }
            None => (T::default(), None),
        })
    };
    let (kept, named): (Vec<T>, Vec<_>) =
        shoot.frames.par_iter().map(read).collect::<Result<Vec<_>>>()?.into_iter().unzip();
    digests.extend(named.into_iter().flatten());
    Ok(kept)
}
