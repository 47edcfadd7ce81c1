//! A grounder that looks the answer up, and errs as it is told: for measuring what consensus and lifting make of
//! errors whose kind, rate and correlation between views are known.
//!
//! It sees what the renderer knew of the training views, never the held-out one. Whatever is made of its answers is
//! marked as using the truth. The module owns the errors; it refuses to know how views are compared.
//!
//! - [`noise`]: which errors, how often;
//! - [`target`]: what a query means;
//! - [`ids`]: which pixels show what;
//! - `draws`: which view errs, from the seed.

mod draws;
pub mod ids;
pub mod noise;
pub mod target;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use l4d_data::digest::sha256_hex;
use l4d_data::json::canonical;
use l4d_data::{DataError, Name};
use l4d_frames::{Mask, morphology};
use serde_json::{Value, json};

use self::draws::{Draws, Meant};
pub use self::ids::{DrawnIds, IdSource, RenderedIds, TrainingIds};
pub use self::noise::{Blobs, CORRELATIONS, NoiseError, NoiseModel, NoisePreset, Span, Swap};
pub use self::target::{Target, TargetError};
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};

/// The truth about the queries of one scene, with stated errors.
#[derive(Debug)]
pub struct Oracle<S> {
    scene: Name,
    ids: S,
    targets: BTreeMap<Name, Target>,
    preset: NoisePreset,
}

/// Why the oracle has nothing to say.
#[derive(Debug, thiserror::Error)]
enum Silence {
    #[error("the oracle knows scene {known}, but is asked about {asked}: ask the oracle of that scene")]
    OtherScene { known: Name, asked: Name },
    #[error("the oracle knows queries of the benchmark by their number alone: ask another grounder")]
    NoNumber,
    #[error("scene {scene} has no query {number}: check the benchmark's folder and the number")]
    UnknownQuery { scene: Name, number: Name },
    #[error("the clip is {}x{}, but ids of view {view} at frame {frame} are {}x{}: draw clips at the size of the rendered frames", clip.0, clip.1, ids.0, ids.1)]
    Size { view: Name, frame: u32, clip: (u32, u32), ids: (u32, u32) },
    #[error(transparent)]
    Picture(#[from] DataError),
}

impl<S: IdSource> Oracle<S> {
    /// The oracle of a scene, which knows queries by their numbers.
    pub fn new(
        scene: Name,
        ids: S,
        targets: BTreeMap<Name, Target>,
        preset: NoisePreset,
    ) -> Result<Self, NoiseError> {
        preset.check()?;
        Ok(Self { scene, ids, targets, preset })
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, Silence> {
        if question.scene != self.scene {
            return Err(Silence::OtherScene { known: self.scene.clone(), asked: question.scene.clone() });
        }
        let number = question.number.as_ref().ok_or(Silence::NoNumber)?;
        let unknown = || Silence::UnknownQuery { scene: self.scene.clone(), number: number.clone() };
        let target = self.targets.get(number).ok_or_else(unknown)?;
        let noise = self.preset.of_categories(&target.categories);
        let draws = Draws { seed: self.preset.seed, scene: &self.scene, number };
        let view = &clip.camera.name;
        if draws.is_dropped(&noise, view) {
            let notes = vec!["dropped: says absent, whatever it shows".to_owned()];
            return Ok(Grounding::of_masks(clip, BTreeMap::new(), notes));
        }
        let meant = draws.meant(&noise.swap, target, view);
        let shown = match &meant {
            Meant::Referents | Meant::NothingElse => &target.referents,
            Meant::LookAlikes(ids) => ids,
        };
        let mut masks = BTreeMap::new();
        for frame in clip.frame_numbers().filter(|&frame| question.asks_about(frame)) {
            let mut mask = Mask::empty(clip.width, clip.height);
            if target.holds_at(frame) && !draws.flickers(&noise, view, frame) {
                mask = self.pixels(clip, frame, shown)?;
                mask = edged(&mask, draws.edge_px(&noise, view, frame));
            }
            if let Some(blob) = draws.blob(&noise.blobs, mask.size(), view, frame) {
                mask.union_with(&blob);
            }
            masks.insert(frame, mask);
        }
        Ok(Grounding::of_masks(clip, masks, vec![note(&meant, target)]))
    }

    fn pixels(&self, clip: &ViewClip, frame: u32, ids: &[u32]) -> Result<Mask, Silence> {
        let view = &clip.camera.name;
        let mask = self.ids.pixels_of(view, frame, ids)?;
        let size = (clip.width, clip.height);
        if mask.size() != size {
            return Err(Silence::Size { view: view.clone(), frame, clip: size, ids: mask.size() });
        }
        Ok(mask)
    }
}

impl<S: IdSource> Grounder for Oracle<S> {
    fn identity(&self) -> Value {
        json!({
            "kind": "oracle",
            "scene": self.scene,
            "ids": self.ids.identity(),
            "targets_sha256": sha256_hex(canonical(&json!(self.targets)).as_bytes()),
            "preset": self.preset,
        })
    }

    fn uses_truth(&self) -> bool {
        true
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        self.answer(clip, question).unwrap_or_else(|silence| {
            Grounding::without_answer(match silence {
                Silence::Picture(error) => Outcome::of_data_error(&error),
                other => Outcome::Error(other.to_string()),
            })
        })
    }
}

/// The mask with its outline moved by so many pixels.
fn edged(mask: &Mask, edge_px: i32) -> Mask {
    match edge_px {
        0 => mask.clone(),
        1.. => morphology::dilated(mask, edge_px.unsigned_abs()),
        _ => morphology::eroded(mask, edge_px.unsigned_abs()),
    }
}

fn note(meant: &Meant, target: &Target) -> String {
    match meant {
        Meant::Referents => format!("shows the referents {:?}", target.referents),
        Meant::LookAlikes(ids) => format!("swapped: shows {ids:?} in place of {:?}", target.referents),
        Meant::NothingElse => {
            format!("shows the referents {:?}: to be swapped, but nothing is like them", target.referents)
        }
    }
}
