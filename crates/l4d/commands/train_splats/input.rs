//! Pictures from disk: those that are trained on, and those that are only compared with, kept apart.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result};
use glam::UVec2;
use half::f16;
use l4d_data::digest::sha256_hex;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{OBJECT_IDS, Scene};
use l4d_data::{Camera, DataError, Split};
use l4d_frames::exr::{decode_seen, read_bytes};
use l4d_frames::{Display, Frame};
use l4d_splat::train::{Footage, Motion, Picture, Region};
use rayon::prelude::*;

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

/// Pictures that [`Input::read`] and [`HeldOut::read`] will read.
pub(super) fn picture_count(scene: &Scene) -> u64 {
    (scene.cameras.len() * scene.profile.frames().count()) as u64
}

impl Input {
    pub(super) fn read(dir: &SceneDir, scene: &Scene, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        let cameras: Vec<&Camera> =
            scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect();
        if cameras.is_empty() {
            return Err(refusal(
                format!("{}: field `cameras`: none has split `train`", dir.scene().display()),
                "build the scene again with `l4d build-scenes --overwrite`",
            ));
        }
        let (mut footage, mut digests) = (empty(dir, scene)?, Digests::new());
        for camera in cameras {
            // Ids are dropped as soon as they are decoded, if there are any: training never sees them.
            let pictures =
                read_camera(dir, scene, camera, &mut digests, tick, |frame| picture_of(scene, &frame))?;
            add(&mut footage, dir, scene, camera, pictures)?;
        }
        Ok(Self { footage, digests })
    }
}

impl HeldOut {
    pub(super) fn read(dir: &SceneDir, scene: &Scene, tick: &(dyn Fn() + Sync)) -> Result<Self> {
        let (mut footage, mut digests) = (empty(dir, scene)?, Digests::new());
        let mut objects = Vec::new();
        if let Some(camera) = scene.test_camera() {
            let of_frame = |frame: Frame| {
                let shows = frame.surfaces.id.iter().map(|id| OBJECT_IDS.contains(id)).collect();
                (picture_of(scene, &frame), shows)
            };
            let (pictures, shown) =
                read_camera(dir, scene, camera, &mut digests, tick, of_frame)?.into_iter().unzip();
            objects = shown;
            add(&mut footage, dir, scene, camera, pictures)?;
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

fn empty(dir: &SceneDir, scene: &Scene) -> Result<Footage> {
    Footage::new([scene.width, scene.height], scene.profile.frames().collect())
        .with_context(|| dir.scene().display().to_string())
}

fn add(
    footage: &mut Footage,
    dir: &SceneDir,
    scene: &Scene,
    camera: &Camera,
    pictures: Vec<Picture>,
) -> Result<()> {
    footage
        .add(camera, [scene.width, scene.height], pictures)
        .with_context(|| dir.scene().display().to_string())
}

fn read_camera<T: Send>(
    dir: &SceneDir,
    scene: &Scene,
    camera: &Camera,
    digests: &mut Digests,
    tick: &(dyn Fn() + Sync),
    keep: impl Fn(Frame) -> T + Sync,
) -> Result<Vec<T>> {
    let frames: Vec<u32> = scene.profile.frames().collect();
    let read = |&frame: &u32| -> Result<(T, (String, String))> {
        let path = dir.frame(&camera.name, frame);
        let size = UVec2::new(scene.width, scene.height);
        let bytes = read_bytes(&path, size).map_err(DataError::from)?;
        let decoded = decode_seen(&path, &bytes, size).map_err(DataError::from)?;
        let within = path.strip_prefix(dir.root()).unwrap_or(&path).display().to_string();
        tick();
        Ok((keep(decoded), (within, sha256_hex(&bytes))))
    };
    let (kept, named): (Vec<T>, Vec<_>) =
        frames.par_iter().map(read).collect::<Result<Vec<_>>>()?.into_iter().unzip();
    digests.extend(named);
    Ok(kept)
}

fn picture_of(scene: &Scene, frame: &Frame) -> Picture {
    let display = Display::new(scene.exposure);
    Picture {
        colour: frame.rgb.iter().map(|pixel| pixel.map(|linear| display.byte(linear))).collect(),
        depth_m: frame.surfaces.depth_m.iter().map(|&depth_m| f16::from_f32(depth_m)).collect(),
    }
}
