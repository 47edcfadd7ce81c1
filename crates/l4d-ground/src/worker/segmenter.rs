//! A worker in the terms of clips: canonical frames instead of indices.

use std::collections::BTreeMap;

use l4d_data::Interval;
use l4d_masks::Mask;
use serde_json::{Value, json};

use super::Worker;
use super::error::WorkerError;
use super::frames::FrameStore;
use super::protocol::Hello;
use crate::clip::ViewClip;

/// A worker with the place where it finds frames.
#[derive(Debug)]
pub struct Segmenter {
    worker: Worker,
    store: FrameStore,
    threshold: f64,
}

/// What to look for in a clip.
#[derive(Debug, Clone, PartialEq)]
pub enum ClipPrompt {
    /// A box in a frame.
    Box {
        /// Which of the objects, from 1.
        object: u32,
        /// Canonical frame.
        frame: u32,
        /// Left, upper, right, lower edge, pixels of the clip.
        box_px: [f64; 4],
    },
    /// A place on an object in a frame.
    Point {
        /// Which of the objects, from 1.
        object: u32,
        /// Canonical frame.
        frame: u32,
        /// Column and row, pixels of the clip.
        point_px: [f64; 2],
    },
    /// Words.
    Text(String),
}

/// What was found in a clip.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Segmented {
    /// The objects, by descending score, then by the worker's own number.
    pub objects: Vec<Object>,
    /// Steps that the worker had to leave out.
    pub skipped: Vec<String>,
}

/// An object that was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Object {
    /// Canonical frame -> its mask, at the size of the clip.
    pub masks: BTreeMap<u32, Mask>,
    /// How sure the worker is, 0 to 1.
    pub score: Option<f64>,
}

impl Segmenter {
    /// Objects with a score below `threshold` (0 to 1) are left out; 0 leaves it to the worker.
    pub fn new(worker: Worker, store: FrameStore, threshold: f64) -> Self {
        Self { worker, store, threshold }
    }

    /// What the worker says of itself.
    pub fn hello(&self) -> &Hello {
        self.worker.hello()
    }

    /// Everything that its masks depend on beside clip and prompts.
    pub fn identity(&self) -> Value {
        json!({ "worker": self.hello(), "threshold": self.threshold })
    }

    /// Whether it takes prompts of a kind (`box`, `point`, `text`).
    ///
    /// # Errors
    /// It does not.
    pub fn takes(&self, kind: &str) -> Result<(), WorkerError> {
        let hello = self.hello();
        if hello.prompts.iter().any(|taken| taken == kind) {
            return Ok(());
        }
        let message = format!("it takes {}, not {kind}", hello.prompts.join(", "));
        Err(WorkerError::Unfit { worker: hello.name.clone(), message })
    }

    /// Looks for objects in a clip, or in the part of it that is asked about.
    ///
    /// # Errors
    /// Frames cannot be written, or the worker fails or refuses.
    pub fn segment(
        &self,
        clip: &ViewClip,
        prompts: &[ClipPrompt],
        range: Option<Interval>,
    ) -> Result<Segmented, WorkerError> {
        let numbers: Vec<u32> = clip.frame_numbers().collect();
        let asked = |frame: &u32| range.is_none_or(|range| range.contains(*frame));
        let (Some(first), Some(last)) = (numbers.iter().position(asked), numbers.iter().rposition(asked))
        else {
            return Ok(Segmented::default());
        };
        let frames = self.store.frames(clip)?;
        let index = |frame: u32| numbers.binary_search(&frame).ok().filter(|_| asked(&frame));
        let prompts: Vec<Value> = prompts.iter().filter_map(|prompt| prompt.indexed(index)).collect();
        if prompts.is_empty() {
            return Ok(Segmented::default());
        }
        let mut found =
            self.worker.segment(&frames, &prompts, [first as u32, last as u32], self.threshold)?;
        found.objects.retain(|object| object.score.is_none_or(|score| score >= self.threshold));
        for object in &mut found.objects {
            let masks = std::mem::take(&mut object.masks).into_iter();
            object.masks =
                masks.filter_map(|(index, mask)| Some((*numbers.get(index as usize)?, mask))).collect();
        }
        found.objects.sort_by(|a, b| b.score.unwrap_or(0.0).total_cmp(&a.score.unwrap_or(0.0)));
        Ok(found)
    }
}

impl Segmented {
    /// Everything that was found, frame by frame.
    pub fn union(&self) -> BTreeMap<u32, Mask> {
        let mut union = BTreeMap::<u32, Mask>::new();
        for (frame, mask) in self.objects.iter().flat_map(|object| &object.masks) {
            union
                .entry(*frame)
                .and_modify(|together| together.union_with(mask))
                .or_insert_with(|| mask.clone());
        }
        union
    }
}

impl ClipPrompt {
    /// The prompt as a worker reads it, with an index instead of the frame; none if the frame has no index.
    pub(super) fn indexed(&self, index: impl Fn(u32) -> Option<usize>) -> Option<Value> {
        Some(match self {
            Self::Box { object, frame, box_px } => {
                json!({ "obj": object, "frame": index(*frame)?, "box_px": box_px })
            }
            Self::Point { object, frame, point_px } => {
                json!({ "obj": object, "frame": index(*frame)?, "point_px": point_px })
            }
            // Text may find several objects: the worker numbers those itself.
            Self::Text(text) => json!({ "obj": 1, "text": text }),
        })
    }
}
