//! A grounder that looks the answer up, with stated errors: for measuring what consensus and lifting make of errors
//! whose kind, rate and correlation between views are known.
//!
//! It sees what the renderer knew of the training views, never the held-out one. What is made of its answers is marked
//! as using the truth. How views are compared is not known here.
//!
//! - `noise`: which errors, how often;
//! - `target`: what a query means;
//! - `ids`: which pixels show what;
//! - `draws`: which view errs, from the seed.

mod draws;
mod ids;
mod noise;
mod target;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::sync::Arc;

use l4d_data::Name;
use l4d_data::digest::sha256_hex;
use l4d_data::json::canonical;
use l4d_masks::{Mask, morphology};
use serde_json::{Value, json};

use self::draws::{Draws, Meant};
pub use self::ids::{IdSource, open_ids};
pub use self::noise::{CORRELATIONS, NoiseModel, NoisePreset, Swap};
pub use self::target::{Target, UnknownReferent};
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};

/// The truth about the queries of one scene, with stated errors.
pub struct Oracle {
    scene: Name,
    ids: Arc<dyn IdSource>,
    targets: BTreeMap<Name, Target>,
    preset: NoisePreset,
}

impl Oracle {
    /// The oracle of a scene, which knows queries by their numbers.
    pub fn new(
        scene: Name,
        ids: Arc<dyn IdSource>,
        targets: BTreeMap<Name, Target>,
        preset: NoisePreset,
    ) -> Self {
        Self { scene, ids, targets, preset }
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, Outcome> {
        let refuse = |message: String| Err(Outcome::Error(message));
        let (scene, asked) = (&self.scene, &question.scene);
        if asked != scene {
            return refuse(format!(
                "the oracle knows scene {scene}, but is asked about {asked}: ask the oracle of that scene"
            ));
        }
        let Some(number) = &question.number else {
            let message =
                "the oracle knows queries of the benchmark by their number alone: ask another grounder";
            return refuse(message.to_owned());
        };
        let Some(target) = self.targets.get(number) else {
            return refuse(format!(
                "scene {scene} has no query {number}: check the benchmark's folder and the number"
            ));
        };
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
        for frame in question.frames(clip) {
            let mut mask = Mask::empty(clip.width, clip.height);
            if target.holds_at(frame) && !draws.flickers(&noise, view, frame) {
                mask = self.pixels(clip, frame, shown)?;
                mask = edged(&mask, draws.edge_px(&noise, view, frame));
            }
            masks.insert(frame, mask);
        }
        Ok(Grounding::of_masks(clip, masks, vec![note(&meant, target)]))
    }

    fn pixels(&self, clip: &ViewClip, frame: u32, ids: &[u32]) -> Result<Mask, Outcome> {
        let view = &clip.camera.name;
        let mask = self.ids.pixels_of(view, frame, ids).map_err(|error| Outcome::of_data_error(&error))?;
        let size = (clip.width, clip.height);
        if mask.size() == size {
            return Ok(mask);
        }
        let ((clip_width, clip_height), (width, height)) = (size, mask.size());
        Err(Outcome::Error(format!(
            "the clip is {clip_width}x{clip_height}, but ids of view {view} at frame {frame} are {width}x{height}: \
             draw clips at the size of the rendered frames"
        )))
    }
}

impl Grounder for Oracle {
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
        self.answer(clip, question).unwrap_or_else(Grounding::without_answer)
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
