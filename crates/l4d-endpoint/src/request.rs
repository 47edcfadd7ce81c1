//! A question to a model, free of any server's spelling.

use serde_json::Value;

use crate::message::{Image, Message, Part};

/// A question.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The conversation so far; the last message is the question.
    pub messages: Vec<Message>,
    /// The shape of the answer. Servers that ignore it get the question all the same.
    pub schema: Option<Schema>,
    /// 0 for the likeliest answer; `None` leaves it to the server.
    pub temperature: Option<f64>,
    /// Seed of the sampling; not every server knows one.
    pub seed: Option<u32>,
    /// Longest answer, tokens, thinking included.
    pub max_tokens: u32,
    /// Asks the very same thing once more instead of taking the kept answer: part of the cache key, not of what
    /// is sent.
    pub repeat: u32,
}

impl Request {
    /// A question with the defaults of the project: temperature 0, seed 0, 1024 tokens, no schema.
    pub fn new(messages: Vec<Message>) -> Self {
        Self { messages, schema: None, temperature: Some(0.0), seed: Some(0), max_tokens: 1024, repeat: 0 }
    }

    /// With a schema.
    #[must_use]
    pub fn with_schema(mut self, schema: Schema) -> Self {
        self.schema = Some(schema);
        self
    }

    /// With another limit of the answer.
    #[must_use]
    pub fn with_max_tokens(mut self, max_tokens: u32) -> Self {
        self.max_tokens = max_tokens;
        self
    }

    /// All pictures, in order.
    pub fn images(&self) -> impl Iterator<Item = &Image> {
        self.messages.iter().flat_map(|message| &message.parts).filter_map(|part| match part {
            Part::Image(image) => Some(image),
            Part::Text(_) => None,
        })
    }
}

/// A JSON Schema of the answer. Servers in strict mode want an object at the root, every property required and
/// `additionalProperties: false`, and no `anyOf`.
#[derive(Debug, Clone, PartialEq)]
pub struct Schema {
    /// Letters, digits, `_` and `-`.
    pub name: String,
    /// The schema itself.
    pub value: Value,
}

impl Schema {
    /// A named schema.
    pub fn new(name: impl Into<String>, value: Value) -> Self {
        Self { name: name.into(), value }
    }
}
