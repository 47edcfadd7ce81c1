//! A model's answer.

use serde::de::DeserializeOwned;

use crate::error::{EndpointError, excerpt, tail};
use crate::extract::first_json;

/// An answer that arrived: whole, cut off or refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// What the model said, without its thinking.
    pub text: String,
    /// Why it stopped.
    pub finish: Finish,
    /// What it cost.
    pub usage: Usage,
    /// The model that the server says it used.
    pub model: Option<String>,
    /// Where the answer came from.
    pub origin: Origin,
    /// Digest of the question as it was sent: the name of the exchange in a cache or recording.
    pub digest: String,
    /// What a person who relies on the answer should know (pictures that may have been lost, ...).
    pub notes: Vec<String>,
}

/// Why a model stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finish {
    /// It was done, or the server gives no reason.
    Stop,
    /// It ran into the limit of tokens.
    Length,
    /// It or its server declined, with the words given.
    Refused(String),
}

/// Where an answer came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The server, just now.
    Server,
    /// The cache.
    Cache,
    /// A recording.
    Recording,
}

/// Tokens, as the server counts them; `None` when it does not say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Usage {
    /// Of the question.
    pub prompt_tokens: Option<u64>,
    /// Of the answer, thinking included.
    pub completion_tokens: Option<u64>,
}

impl Reply {
    /// A whole answer of no server, for tests of what reads answers.
    pub fn saying(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            finish: Finish::Stop,
            usage: Usage::default(),
            model: None,
            origin: Origin::Server,
            digest: "d".repeat(64),
            notes: Vec::new(),
        }
    }

    /// The text of a whole answer.
    ///
    /// # Errors
    /// If the answer was cut off, refused or empty.
    pub fn whole(&self) -> Result<&str, EndpointError> {
        match &self.finish {
            Finish::Length => Err(EndpointError::Truncated { excerpt: tail(&self.text) }),
            Finish::Refused(words) => Err(EndpointError::Refused { message: excerpt(words) }),
            Finish::Stop if self.text.is_empty() => {
                Err(EndpointError::Unfit { message: "it is empty".to_owned() })
            }
            Finish::Stop => Ok(&self.text),
        }
    }

    /// The first JSON object or array in a whole answer that is a `T`; prose and code fences are passed over.
    ///
    /// # Errors
    /// As [`Reply::whole`], and if the answer holds no such JSON.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T, EndpointError> {
        first_json(self.whole()?)
    }
}
