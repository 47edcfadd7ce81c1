//! What each view says, asked once: groundings on disk, under the digest of everything that they depend on.
//!
//! Owns the file `grounded/<view>.json` and when it may be believed. Outcomes that are not final are not remembered:
//! the next run asks again. Refuses to know what groundings are good for.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread;

use l4d_data::digest::sha256_hex;
use l4d_data::truth::frame_key;
use l4d_data::{DataError, json};
use l4d_ground::{Choice, Grounder, Grounding, Outcome, Question, ViewClip};
use l4d_masks::{Mask, Rle};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

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
    frames: BTreeMap<String, Option<Rle>>,
    notes: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    choice: Option<Choice>,
}

/// Asks all views at once, those apart whose answer is in `folder`. `clip_digests` are those of the clips, in
/// their order; `heard` is called for each view that has answered.
///
/// # Errors
/// An answer that cannot be written. Whatever the grounder meets is an outcome.
pub(crate) fn ground_all(
    grounder: &dyn Grounder,
    question: &Question,
    clips: &[ViewClip],
    clip_digests: &[String],
    folder: &Path,
    heard: &(dyn Fn() + Sync),
) -> Result<Vec<Grounding>, DataError> {
    let identity = grounder.identity();
    let one = |(clip, digest): (&ViewClip, &String)| {
        let (asked, path) = (asked(&identity, question, digest), path_of(folder, clip));
        let grounding = match read(&path, &asked, clip) {
            Some(grounding) => grounding,
            None => {
                let grounding = fitting(grounder.ground(clip, question), clip);
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

/// What a grounder said; an error where a mask is not of the size of the clip.
fn fitting(grounding: Grounding, clip: &ViewClip) -> Grounding {
    let size = (clip.width, clip.height);
    match grounding.masks.iter().find(|(_, mask)| mask.size() != size) {
        Some((frame, mask)) => {
            let message =
                format!("frame {frame}: a mask of {:?} pixels, and the clip has {size:?}", mask.size());
            Grounding::without_answer(Outcome::Error(message))
        }
        None => grounding,
    }
}

/// What the views said, in the order of their names.
///
/// # Errors
/// A folder or a file that cannot be read.
pub fn outcomes(folder: &Path) -> Result<Vec<Outcome>, DataError> {
    let entries = std::fs::read_dir(folder).map_err(|error| DataError::io(folder, "list", error))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().map(|path| Ok(json::read::<File>(path)?.outcome)).collect()
}

/// The clips that [`ground_all`] would ask about.
pub(crate) fn unanswered<'a>(
    grounder: &dyn Grounder,
    question: &Question,
    clips: &'a [ViewClip],
    clip_digests: &[String],
    folder: &Path,
) -> Vec<&'a ViewClip> {
    let identity = grounder.identity();
    let is_asked = |(clip, digest): &(&ViewClip, &String)| {
        read(&path_of(folder, clip), &asked(&identity, question, digest), clip).is_none()
    };
    clips.iter().zip(clip_digests).filter(is_asked).map(|(clip, _)| clip).collect()
}

/// SHA-256 of everything that an answer depends on.
fn asked(identity: &Value, question: &Question, clip_digest: &str) -> String {
    sha256_hex(json::canonical(&json!([identity, question, clip_digest])).as_bytes())
}

fn path_of(folder: &Path, clip: &ViewClip) -> PathBuf {
    folder.join(format!("{}.json", clip.camera.name))
}

fn died() -> Grounding {
    Grounding::without_answer(Outcome::Error("the grounder panicked".to_owned()))
}

/// The answer in a file, if it is one to this question; whatever is wrong with the file, the view is asked again.
fn read(path: &Path, asked: &str, clip: &ViewClip) -> Option<Grounding> {
    let file: File = json::read(path).ok()?;
    let is_meant = file.schema == SCHEMA && file.asked == asked && file.outcome.is_final();
    if !is_meant || file.size != [clip.height, clip.width] {
        return None;
    }
    let mask = |frame: u32| {
        let mask = match file.frames.get(&frame_key(frame))? {
            Some(mask) if mask.misfit(clip.width, clip.height).is_some() => return None,
            Some(mask) => Mask::from_rle(mask, clip.width, clip.height),
            None => Mask::empty(clip.width, clip.height),
        };
        Some((frame, mask))
    };
    let masks = match file.outcome.is_answer() {
        true => clip.frame_numbers().map(mask).collect::<Option<_>>()?,
        false => BTreeMap::new(),
    };
    Some(Grounding { outcome: file.outcome, masks, notes: file.notes, choice: file.choice })
}

fn write(path: &Path, asked: String, clip: &ViewClip, grounding: &Grounding) -> Result<(), DataError> {
    let rle = |mask: &Mask| (!mask.is_empty()).then(|| mask.to_rle());
    let file = File {
        schema: SCHEMA.to_owned(),
        asked,
        outcome: grounding.outcome.clone(),
        size: [clip.height, clip.width],
        frames: grounding.masks.iter().map(|(&frame, mask)| (frame_key(frame), rle(mask))).collect(),
        notes: grounding.notes.clone(),
        choice: grounding.choice.clone(),
    };
    json::write(path, &file)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use l4d_data::{Name, Timeline};
    use l4d_frames::drawn::{DepthMap, RgbImage};
    use l4d_ground::{ClipFrame, Reason, Unreadable};

    use super::*;
    use crate::testing::camera;

    /// Says always the same, and counts how often it is asked.
    struct Stubborn {
        outcome: Outcome,
        asked: AtomicUsize,
    }

    impl Grounder for Stubborn {
        fn identity(&self) -> Value {
            Value::from("stubborn")
        }

        fn ground(&self, clip: &ViewClip, _: &Question) -> Grounding {
            self.asked.fetch_add(1, Ordering::Relaxed);
            if self.outcome.is_answer() {
                let frame = u32::from(self.outcome == Outcome::Found);
                let masks = BTreeMap::from([(0, Mask::from_fn(4, 3, |column, _| column < frame))]);
                return Grounding::of_masks(clip, masks, Vec::new());
            }
            Grounding::without_answer(self.outcome.clone())
        }
    }

    fn clip(view: &str) -> ViewClip {
        let frame = |frame| ClipFrame { frame, colour: RgbImage::new(4, 3), depth: DepthMap::empty(4, 3) };
        let frames = [0, 12].map(frame).to_vec();
        ViewClip { camera: camera(view, 0.0), width: 4, height: 3, timeline: Timeline::CANONICAL, frames }
    }

    /// What two runs say, one after the other, and how often they ask.
    fn ask_twice(outcome: Outcome) -> (Vec<Grounding>, usize) {
        let folder = tempfile::tempdir().unwrap();
        let grounder = Stubborn { outcome, asked: AtomicUsize::new(0) };
        let scene = Name::new("ball").unwrap();
        let question = Question { scene, number: None, text: "the ball".to_owned(), range: None };
        let (clips, digests) = ([clip("cam00"), clip("cam01")], ["a".to_owned(), "b".to_owned()]);
        let run = || ground_all(&grounder, &question, &clips, &digests, folder.path(), &|| {}).unwrap();
        let first = run();
        let second = run();
        assert_eq!(first, second);
        (second, grounder.asked.into_inner())
    }

    #[test]
    fn what_is_final_is_asked_once_and_everything_else_again() {
        let unread = Unreadable::words(Reason::Unknown, [&"zorple".to_owned()]);
        for outcome in [Outcome::Found, Outcome::Absent, Outcome::Unsupported(unread)] {
            let (groundings, asked) = ask_twice(outcome.clone());
            assert_eq!(asked, 2, "{outcome:?}");
            for grounding in groundings {
                assert_eq!(grounding.outcome, outcome);
                assert_eq!(grounding.masks.len(), if outcome.is_answer() { 2 } else { 0 });
            }
        }
        let why = || "why".to_owned();
        for outcome in
            [Outcome::Unparsed(why()), Outcome::Truncated, Outcome::Refused(why()), Outcome::Error(why())]
        {
            assert_eq!(ask_twice(outcome.clone()).1, 4, "{outcome:?}");
        }
    }

    #[test]
    fn a_mask_of_another_size_is_an_error() {
        let masks = BTreeMap::from([(0, Mask::full(2, 2))]);
        let grounding = fitting(
            Grounding { masks, ..Grounding::of_masks(&clip("cam00"), BTreeMap::new(), Vec::new()) },
            &clip("cam00"),
        );
        assert!(matches!(grounding.outcome, Outcome::Error(why) if why.contains("(2, 2)")));
    }
}
