//! Grounding by models that are asked (paper, section 4, "Multi-View Semantic Grounder"): a vision-language model says
//! what is meant, a segmenter outlines it.
//!
//! This module owns the couplings of the two, which the paper leaves open. How a question travels is known to
//! `l4d-endpoint`, how masks are made to [`crate::worker`]. One view at a time, one question each (`pick`: two).

mod prompt;
#[cfg(test)]
mod tests;
mod view;

use std::collections::BTreeMap;
use std::sync::Arc;

use l4d_data::digest::sha256_hex;
use l4d_endpoint::{Client, Convention, Endpoint, EndpointError, Plan};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use self::prompt::Template;
use self::view::View;
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question, sentence};
use crate::unreadable::Unreadable;
use crate::worker::{Segmenter, WorkerError};

/// What a model hands to a segmenter. The paper does not say; `text` fits what it does say best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Coupling {
    /// A rewritten expression, to a segmenter of text.
    Text,
    /// Boxes in some frames, to a segmenter that follows them through all frames.
    Box,
    /// The kind of thing, to a segmenter of text; the model then chooses among what was found.
    Pick,
}

impl Coupling {
    /// The prompts that it uses; with the first one a plan is asked for.
    fn templates(self) -> &'static [Template] {
        match self {
            Self::Text => &[Template::TEXT],
            Self::Box => &[Template::BOX],
            Self::Pick => &[Template::NOUN, Template::PICK],
        }
    }
}

/// How a model is asked.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Pictures of a view that are sent, spread over the clip.
    pub keyframes: usize,
    /// Pixels that a sent picture has about: clips are enlarged by a whole factor. Models see small pictures badly;
    /// a megapixel is about a thousand tokens.
    pub picture_pixels: u32,
    /// Longest answer, tokens, thinking included.
    pub answer_tokens: u32,
    /// 0 for the likeliest answer; none leaves it to the server.
    pub temperature: Option<f64>,
    /// Seed of the sampling, where the server knows one.
    pub seed: Option<u32>,
    /// Which asking this is, from 0: others are asked anew instead of being taken from the cache.
    pub repeat: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            keyframes: 16,
            picture_pixels: 1 << 20,
            answer_tokens: 2048,
            temperature: Some(0.0),
            seed: Some(0),
            repeat: 0,
        }
    }
}

/// Why a grounder cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum VlmError {
    /// The endpoint, or how its model writes boxes.
    #[error(transparent)]
    Endpoint(#[from] EndpointError),
    /// The segmenter does not take what the coupling gives.
    #[error(transparent)]
    Worker(#[from] WorkerError),
    /// A setting that cannot be.
    #[error("{field}: {message}")]
    Settings {
        field: &'static str,
        /// What is wrong with it.
        message: &'static str,
    },
}

impl VlmError {
    /// What to do about it.
    pub fn hint(&self) -> &str {
        match self {
            Self::Endpoint(error) => error.hint(),
            Self::Worker(error) => error.hint(),
            Self::Settings { .. } => "leave it out for its default",
        }
    }
}

/// A vision-language model and a segmenter.
#[derive(Debug)]
pub struct Vlm {
    client: Client,
    convention: &'static Convention,
    segmenter: Arc<Segmenter>,
    coupling: Coupling,
    settings: Settings,
}

impl Vlm {
    /// A coupling of a model and a segmenter. Boxes need a convention of coordinates.
    ///
    /// # Errors
    /// A setting cannot be, the segmenter does not take what the coupling gives, or the convention is not known.
    pub fn new(
        client: Client,
        segmenter: Arc<Segmenter>,
        coupling: Coupling,
        settings: Settings,
    ) -> Result<Self, VlmError> {
        let refuse = |field, message| Err(VlmError::Settings { field, message });
        if !(1..=256).contains(&settings.keyframes) {
            return refuse("keyframes", "must be 1 to 256");
        }
        if !(1 << 12..=1 << 24).contains(&settings.picture_pixels) {
            return refuse("picture_pixels", "must be 4096 to 16777216");
        }
        if settings.answer_tokens == 0 {
            return refuse("answer_tokens", "must be at least 1");
        }
        segmenter.takes(if coupling == Coupling::Box { "box" } else { "text" })?;
        let convention = match coupling {
            Coupling::Box => client.endpoint().convention()?,
            // No coordinates are asked for.
            Coupling::Text | Coupling::Pick => Convention::named("rel1000_xyxy")?,
        };
        Ok(Self { client, convention, segmenter, coupling, settings })
    }

    /// The server that is asked.
    pub fn endpoint(&self) -> &Endpoint {
        self.client.endpoint()
    }

    /// What asking these questions would mean; nothing is sent. For `pick`, the second question is counted with
    /// unmarked pictures, since its candidates are not known yet.
    ///
    /// # Errors
    /// A picture cannot be encoded, or the cache not be read.
    pub fn estimate<'a>(
        &self,
        questions: impl IntoIterator<Item = (&'a ViewClip, &'a Question)>,
    ) -> Result<Plan, EndpointError> {
        let mut total = Plan::default();
        for (clip, question) in questions {
            // What cannot be asked costs nothing.
            let Ok(view) = View::new(self, clip, question) else { continue };
            let pictures = view.plain()?;
            total += match self.coupling {
                Coupling::Pick => {
                    let noun = view.plan_request(Template::NOUN, Vec::new());
                    self.client.plan(&[noun, view.choice_request(pictures, 1)])
                }
                Coupling::Text | Coupling::Box => {
                    self.client.plan([&view.plan_request(self.coupling.templates()[0], pictures)])
                }
            };
        }
        Ok(total)
    }
}

impl Grounder for Vlm {
    fn identity(&self) -> Value {
        let endpoint = self.client.endpoint();
        let prompts: Vec<Value> = self.coupling.templates().iter().map(Template::identity).collect();
        json!({
            "grounder": "vlm",
            "version": 1,
            "coupling": self.coupling,
            "prompts": prompts,
            "model": endpoint.model,
            // Where it runs may change what it says; the address itself stays private.
            "endpoint": sha256_hex(endpoint.id().as_bytes())[..12],
            "server": endpoint.server,
            "body": endpoint.body,
            "coordinates": (self.coupling == Coupling::Box).then_some(&self.convention.name),
            "settings": self.settings,
            "segmenter": self.segmenter.identity(),
        })
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        sentence(text).map(|_| ())
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        let mut view = match View::new(self, clip, question) {
            Ok(view) => view,
            Err(outcome) => return Grounding::without_answer(outcome),
        };
        match view.masks() {
            Ok(found) => Grounding::of_masks(clip, found.union(), view.notes),
            Err(Outcome::Absent) => Grounding::of_masks(clip, BTreeMap::new(), view.notes),
            Err(outcome) => Grounding { notes: view.notes, ..Grounding::without_answer(outcome) },
        }
    }
}
