//! A worker in the terms of clips: canonical frames instead of indices.

use std::collections::BTreeMap;

use l4d_data::Interval;
use l4d_frames::Mask;
use serde_json::{Value, json};

use super::error::WorkerError;
use super::frames::FrameStore;
use super::protocol::{Hello, Prompt, What};
use super::{Answer, Worker};
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
#[derive(Debug, Clone, PartialEq)]
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

    /// Who does the work.
    pub fn hello(&self) -> &Hello {
        self.worker.hello()
    }

    /// Everything that its masks depend on beside clip and prompts.
    pub fn identity(&self) -> Value {
        json!({ "worker": self.hello(), "threshold": self.threshold })
    }

    /// Whether it takes prompts of a kind (`box`, `point`, `text`).
    pub fn takes(&self, kind: &str) -> Result<(), WorkerError> {
        let hello = self.hello();
        if hello.prompts.iter().any(|taken| taken == kind) {
            return Ok(());
        }
        let message = format!("it takes {}, not {kind}", hello.prompts.join(", "));
        Err(WorkerError::Unfit { worker: hello.name.clone(), message })
    }

    /// Looks for objects in a clip, or in the part of it that is asked about.
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
        let prompts: Vec<Prompt> =
            prompts.iter().filter_map(|prompt| indexed(prompt, &numbers, &asked)).collect();
        if prompts.is_empty() {
            return Ok(Segmented::default());
        }
        let answer = self.worker.segment(&frames, &prompts, [first as u32, last as u32], self.threshold)?;
        Ok(self.canonical(answer, &numbers))
    }

    fn canonical(&self, answer: Answer, numbers: &[u32]) -> Segmented {
        let Answer { objects, skipped } = answer;
        let mut objects: Vec<Object> = objects
            .into_values()
            .filter(|found| found.score.is_none_or(|score| score >= self.threshold))
            .map(|found| {
                let canonical = |(index, mask): (u32, Mask)| Some((*numbers.get(index as usize)?, mask));
                Object { masks: found.masks.into_iter().filter_map(canonical).collect(), score: found.score }
            })
            .collect();
        objects.sort_by(|a, b| b.score.unwrap_or(0.0).total_cmp(&a.score.unwrap_or(0.0)));
        Segmented { objects, skipped }
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

/// A prompt with an index instead of a frame; none if the frame is not asked about.
fn indexed(prompt: &ClipPrompt, numbers: &[u32], is_asked: &dyn Fn(&u32) -> bool) -> Option<Prompt> {
    let index = |frame: &u32| -> Option<u32> {
        let index = numbers.binary_search(frame).ok().filter(|_| is_asked(frame))?;
        u32::try_from(index).ok()
    };
    Some(match prompt {
        ClipPrompt::Box { object, frame, box_px } => {
            Prompt { obj: *object, what: What::Box { frame: index(frame)?, box_px: *box_px } }
        }
        ClipPrompt::Point { object, frame, point_px } => {
            Prompt { obj: *object, what: What::Point { frame: index(frame)?, point_px: *point_px } }
        }
        ClipPrompt::Text(text) => Prompt { obj: 1, what: What::Text { text: text.clone() } },
    })
}
