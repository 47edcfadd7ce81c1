//! A worker in the terms of clips: canonical frames instead of indices. And the sentence straight to it: the paper's
//! ablation without a model that reasons.

use std::collections::BTreeMap;
use std::sync::Arc;

use l4d_data::Interval;
use l4d_endpoint::{BoxPx, one_line};
use l4d_masks::Mask;
use serde_json::{Value, json};

use super::Worker;
use super::error::WorkerError;
use super::frames::FrameStore;
use super::protocol::{Hello, MaskLine, Segment};
use crate::clip::ViewClip;
use crate::grounder::{CheckedQuestion, Grounder, Grounding, Question, sentence};
use crate::unreadable::Unreadable;

/// More objects than any sentence means.
const MOST_OBJECTS: usize = 64;
/// Remarks about one answer that are kept.
const MOST_REMARKS: usize = 16;

/// A worker with the place where it finds frames.
#[derive(Debug)]
pub struct Segmenter {
    worker: Worker,
    store: FrameStore,
    threshold: f64,
}

/// What to look for in a clip.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ClipPrompt {
    /// A box in a frame.
    Box {
        /// Which of the objects, from 1.
        object: u32,
        /// Canonical frame.
        frame: u32,
        /// Pixels of the clip.
        place: BoxPx,
    },
    Text(String),
}

/// What was found in a clip.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Segmented {
    /// The objects, by descending score, then by the worker's own number.
    pub(crate) objects: Vec<Object>,
    /// Steps that the worker had to leave out.
    pub(crate) skipped: Vec<String>,
}

/// An object that was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Object {
    /// Canonical frame -> its mask, at the size of the clip.
    pub(crate) masks: BTreeMap<u32, Mask>,
    /// How sure the worker is, 0 to 1.
    pub(crate) score: Option<f64>,
}

impl Segmenter {
    /// Objects with a score below `threshold` (0 to 1) are left out; 0 leaves it to the worker.
    pub fn new(worker: Worker, store: FrameStore, threshold: f64) -> Self {
        Self { worker, store, threshold }
    }

    /// What the worker says of itself.
    pub(crate) fn hello(&self) -> &Hello {
        self.worker.hello()
    }

    /// Everything that its masks depend on beside clip and prompts.
    pub(crate) fn identity(&self) -> Value {
        json!({ "worker": self.hello(), "threshold": self.threshold })
    }

    /// An error unless it takes prompts of a kind (`box`, `text`).
    pub(crate) fn takes(&self, kind: &str) -> Result<(), WorkerError> {
        let hello = self.hello();
        if hello.prompts.iter().any(|taken| taken == kind) {
            return Ok(());
        }
        let message = format!("it takes {}, not {kind}", hello.prompts.join(", "));
        Err(WorkerError::Unfit { worker: hello.name.clone(), message })
    }

    /// Looks for objects in a clip, or in the part of it that is asked about.
    pub(crate) fn segment(
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
    pub(crate) fn union(&self) -> BTreeMap<u32, Mask> {
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
            Self::Box { object, frame, place: BoxPx { x0, y0, x1, y1 } } => {
                json!({ "obj": object, "frame": index(*frame)?, "box_px": [x0, y0, x1, y1] })
            }
            // Text may find several objects: the worker numbers those itself.
            Self::Text(text) => json!({ "obj": 1, "text": text }),
        })
    }
}

/// What came of a request so far; masks are by index of the frame.
#[derive(Debug)]
pub(super) struct PartialAnswer {
    size: (u32, u32),
    range: [u32; 2],
    objects: BTreeMap<u32, Object>,
}

impl PartialAnswer {
    pub(super) fn new(segment: &Segment<'_>) -> Self {
        let size = (segment.frames.width, segment.frames.height);
        Self { size, range: segment.range, objects: BTreeMap::new() }
    }

    /// Takes a mask; the error says why the whole answer is of no use.
    pub(super) fn add(&mut self, line: &MaskLine) -> Result<(), String> {
        let [first, last] = self.range;
        if !(first..=last).contains(&line.frame) {
            return Err(format!("a mask of frame {}, asked were {first} to {last}", line.frame));
        }
        let mask = line.rle.decode(self.size.0, self.size.1)?;
        if !self.objects.contains_key(&line.obj) && self.objects.len() == MOST_OBJECTS {
            return Err(format!("more than {MOST_OBJECTS} objects"));
        }
        let found = self.objects.entry(line.obj).or_default();
        if found.masks.insert(line.frame, mask).is_some() {
            return Err(format!("two masks of object {} in frame {}", line.obj, line.frame));
        }
        found.score = match (found.score, line.score) {
            (Some(before), Some(score)) => Some(before.max(score)),
            (before, score) => before.or(score),
        };
        Ok(())
    }

    /// The whole answer, with the steps that the worker left out.
    pub(super) fn finish(self, skipped: &[String]) -> Segmented {
        let skipped = skipped.iter().take(MOST_REMARKS).map(|remark| one_line(remark, 200));
        Segmented { objects: self.objects.into_values().collect(), skipped: skipped.collect() }
    }
}

/// Answers with whatever the segmenter makes of the sentence (`no-vlm`).
#[derive(Debug)]
pub struct TextGrounder {
    segmenter: Arc<Segmenter>,
}

impl TextGrounder {
    /// The sentence as it is, to this segmenter.
    ///
    /// # Errors
    /// The segmenter takes no text.
    pub fn new(segmenter: Arc<Segmenter>) -> Result<Self, WorkerError> {
        segmenter.takes("text")?;
        Ok(Self { segmenter })
    }
}

impl Grounder for TextGrounder {
    fn identity(&self) -> Value {
        json!({ "grounder": "no-vlm", "version": 1, "segmenter": self.segmenter.identity() })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        sentence(text).map(|_| ())
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        let asked = match CheckedQuestion::new(clip, question) {
            Ok(asked) => asked,
            Err(outcome) => return Grounding::without_answer(outcome),
        };
        let prompt = ClipPrompt::Text(asked.sentence.to_owned());
        match self.segmenter.segment(clip, &[prompt], question.range) {
            Ok(found) => {
                let mut notes =
                    vec![format!("`{}` found {} objects", self.segmenter.hello().name, found.objects.len())];
                notes.extend(found.skipped.iter().map(|step| format!("the segmenter left out: {step}")));
                Grounding::of_masks(clip, found.union(), notes)
            }
            Err(error) => Grounding::without_answer(error.outcome()),
        }
    }
}
