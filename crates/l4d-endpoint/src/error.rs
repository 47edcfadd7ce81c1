//! What can go wrong between a question and its answer, each with a hint. No error ever holds a key.

use std::time::Duration;

use l4d_data::error::is_hidden;
use l4d_data::{DataError, StageError};

/// An error of an endpoint, its configuration, or an answer.
#[derive(Debug, thiserror::Error)]
pub enum EndpointError {
    /// A file of the configuration, cache or recording.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Nothing was asked: a setting, a picture, the budget or the recording does not allow it.
    #[error("{place}: {message}")]
    NotAsked {
        /// File and field, flag, or folder.
        place: String,
        /// What is wrong there.
        message: String,
        /// What to do about it.
        hint: String,
    },
    /// The server was not reached, or what it sent is no answer.
    #[error(transparent)]
    Server(#[from] Failure),
    /// The model or its server declined, in these words.
    #[error("the model refused: {0}")]
    Refused(String),
    /// The answer ends at the limit of tokens or in the middle of its JSON; its last characters.
    #[error("the answer is cut off: ...{0}")]
    Truncated(String),
    /// The answer holds no JSON; its first characters.
    #[error("the answer holds no JSON: {0}")]
    NoJson(String),
    /// The answer is empty, or its JSON is not of the shape that was asked for: field and fault.
    #[error("the answer is not what was asked for: {0}")]
    Unfit(String),
}

/// A failure of a server, or on the way to it.
#[derive(Debug, thiserror::Error)]
#[error("{url}: {message}")]
pub struct Failure {
    /// What was asked.
    pub url: String,
    /// What came back, shortened, or the words of the operating system.
    pub message: String,
    /// What to do about it.
    pub hint: &'static str,
    /// Whether the same question may succeed in a while.
    pub is_passing: bool,
    /// How long the server asks to wait.
    pub retry_after: Option<Duration>,
    /// Whether the server may have worked on the question, and may bill it.
    pub may_have_cost: bool,
}

impl Failure {
    /// One that asking again does not mend.
    pub(crate) fn lasting(url: &str, message: impl Into<String>, hint: &'static str) -> Self {
        Self {
            url: url.to_owned(),
            message: message.into(),
            hint,
            is_passing: false,
            retry_after: None,
            may_have_cost: false,
        }
    }
}

impl EndpointError {
    pub(crate) fn not_asked(
        place: impl Into<String>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::NotAsked { place: place.into(), message: message.into(), hint: hint.into() }
    }

    /// What to do about it.
    pub fn hint(&self) -> &str {
        match self {
            Self::Data(error) => error.hint(),
            Self::NotAsked { hint, .. } => hint,
            Self::Server(failure) => failure.hint,
            Self::Refused(_) => "reword the question, or use another model",
            Self::Truncated(_) => "raise the limit of tokens, or use a model that thinks less",
            Self::NoJson(_) | Self::Unfit(_) => {
                "use a server that keeps to a schema (vLLM, llama.cpp), or a larger model"
            }
        }
    }
}

impl From<EndpointError> for StageError {
    fn from(error: EndpointError) -> Self {
        Self::of(&error, error.hint())
    }
}

const EXCERPT_CHARS: usize = 200;

/// The first characters of a text, on one line.
pub(crate) fn excerpt(text: &str) -> String {
    one_line(text, EXCERPT_CHARS)
}

/// The last characters of a text, on one line.
pub(crate) fn tail(text: &str) -> String {
    let text = text.trim_end();
    let skipped = text.chars().count().saturating_sub(EXCERPT_CHARS);
    one_line(&text.chars().skip(skipped).collect::<String>(), EXCERPT_CHARS)
}

/// The beginning of a text of others on one line, without anything that steers a terminal or forges lines of a log.
pub fn one_line(text: &str, longest: usize) -> String {
    let shown = text.replace(|letter: char| is_hidden(letter) && !letter.is_whitespace(), "");
    let line = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    let more = if line.chars().count() > longest { "..." } else { "" };
    line.chars().take(longest).chain(more.chars()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_one_short_harmless_line() {
        assert_eq!(excerpt(" a\n\u{1b}[31mb\u{202e} "), "a [31mb");
        assert_eq!(excerpt(&"ä".repeat(300)).chars().count(), 203);
        let end = tail(&format!("{}end", "ä".repeat(300)));
        assert!(end.chars().count() == 200 && end.ends_with("end"));
    }
}
