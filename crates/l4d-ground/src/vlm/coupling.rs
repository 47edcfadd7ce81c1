//! The ways in which a model and a segmenter work together.

use serde::{Deserialize, Serialize};

use super::request::Template;

/// What a model hands to a segmenter. The paper does not say; `text` fits what it does say best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Text, Self::Box, Self::Pick];

    /// As in settings.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Box => "box",
            Self::Pick => "pick",
        }
    }

    /// The kind of prompt that the segmenter must take.
    pub(super) fn prompt_kind(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Text | Self::Pick => "text",
        }
    }

    /// The prompt with which a plan is asked for.
    pub(super) fn template(self) -> Template {
        match self {
            Self::Text => Template::TEXT,
            Self::Box => Template::BOX,
            Self::Pick => Template::NOUN,
        }
    }

    /// All prompts that it uses.
    pub(super) fn templates(self) -> Vec<Template> {
        match self {
            Self::Text | Self::Box => vec![self.template()],
            Self::Pick => vec![Template::NOUN, Template::PICK],
        }
    }
}
