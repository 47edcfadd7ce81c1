//! The sentence straight to a segmenter that understands text: the paper's ablation without a model that reasons.

use std::sync::Arc;

use serde_json::{Value, json};

use super::error::WorkerError;
use super::segmenter::{ClipPrompt, Segmenter};
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Question};
use crate::question::{self, CheckedQuestion};
use crate::unread::Unread;

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

    fn reads(&self, text: &str) -> Result<(), Unread> {
        question::sentence(text).map(|_| ())
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
