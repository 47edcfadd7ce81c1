//! What each view says, asked once: groundings on disk, under the digest of everything that they depend on.
//!
//! Owns the file `grounded/<view>.json` and when it may be believed. Outcomes that are no answers are not remembered:
//! the next run asks again. Refuses to know what groundings are good for.

use std::collections::BTreeMap;
use std::path::Path;
use std::thread;

use l4d_data::digest::sha256_hex;
use l4d_data::truth::frame_key;
use l4d_data::{DataError, json};
use l4d_frames::{Mask, rle};
use l4d_ground::{Grounder, Grounding, Outcome, Question, ViewClip};
use serde::{Deserialize, Serialize};

const SCHEMA: &str = "l4d/grounded/1";

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    schema: String,
    /// SHA-256 of grounder, question and clip.
    asked: String,
    outcome: Outcome,
    /// Height and width, pixels.
    size: [u32; 2],
    /// Four-digit frame -> compressed COCO counts; null = not seen.
    frames: BTreeMap<String, Option<String>>,
    notes: Vec<String>,
}

/// Asks all views at once, those apart whose answer stands in `folder`. `clip_digests` are those of the clips, in
/// their order; `heard` is told of each view that has answered.
///
/// # Errors
/// An answer that cannot be written. Whatever the grounder meets is an outcome.
pub fn ground_all(
    grounder: &dyn Grounder,
    question: &Question,
    clips: &[ViewClip],
    clip_digests: &[String],
    folder: &Path,
    heard: &(dyn Fn() + Sync),
) -> Result<Vec<Grounding>, DataError> {
    let identity = grounder.identity();
    let one = |(clip, digest): (&ViewClip, &String)| {
        let asked = sha256_hex(json::canonical(&serde_json::json!([identity, question, digest])).as_bytes());
        let path = folder.join(format!("{}.json", clip.camera.name));
        let grounding = match read(&path, &asked, clip) {
            Some(grounding) => grounding,
            None => {
                let grounding = grounder.ground(clip, question);
                write(&path, asked, clip, &grounding)?;
                grounding
            }
        };
        heard();
        Ok(grounding)
    };
    // Threads of their own: a grounder may wait for a server, and all views can wait at once.
    thread::scope(|scope| {
        let asked: Vec<_> =
            clips.iter().zip(clip_digests).map(|pair| scope.spawn(move || one(pair))).collect();
        asked.into_iter().map(|thread| thread.join().unwrap_or_else(|_| Ok(died()))).collect()
    })
}

fn died() -> Grounding {
    Grounding::without_answer(Outcome::Error("the grounder panicked".to_owned()))
}

/// The answer in a file, if it is one to this question; whatever is wrong with the file, the view is asked again.
fn read(path: &Path, asked: &str, clip: &ViewClip) -> Option<Grounding> {
    let file: File = json::read(path).ok()?;
    let is_meant = file.schema == SCHEMA && file.asked == asked && file.outcome.is_answer();
    if !is_meant || file.size != [clip.height, clip.width] {
        return None;
    }
    let mask = |frame: u32| {
        let counts = file.frames.get(&frame_key(frame))?;
        let mask = match counts {
            Some(counts) => rle::decode(counts, clip.width, clip.height).ok()?,
            None => Mask::empty(clip.width, clip.height),
        };
        Some((frame, mask))
    };
    let masks = clip.frame_numbers().map(mask).collect::<Option<_>>()?;
    Some(Grounding { outcome: file.outcome, masks, notes: file.notes })
}

fn write(path: &Path, asked: String, clip: &ViewClip, grounding: &Grounding) -> Result<(), DataError> {
    let counts = |mask: &Mask| (!mask.is_empty()).then(|| rle::encode(mask));
    let file = File {
        schema: SCHEMA.to_owned(),
        asked,
        outcome: grounding.outcome.clone(),
        size: [clip.height, clip.width],
        frames: grounding.masks.iter().map(|(&frame, mask)| (frame_key(frame), counts(mask))).collect(),
        notes: grounding.notes.clone(),
    };
    json::write(path, &file)
}
