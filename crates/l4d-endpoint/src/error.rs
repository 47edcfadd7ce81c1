//! What can go wrong between a question and its answer, by kind, each with a remedy. No variant ever holds a key.

use std::path::PathBuf;
use std::time::Duration;

use l4d_data::DataError;
use serde::Serialize;

/// An error of an endpoint, its configuration, or an answer.
#[derive(Debug, thiserror::Error)]
pub enum EndpointError {
    /// A file of the configuration, cache or recording.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A setting that cannot be.
    #[error("{place}: {message}")]
    Config {
        /// File and field, or flag.
        place: String,
        /// What is wrong there.
        message: String,
        /// What to do about it.
        remedy: String,
    },
    /// A picture that no server would take.
    #[error("a picture cannot be sent: {message}")]
    Picture {
        /// What is wrong with it.
        message: String,
    },
    /// A question that is larger than the configured limits.
    #[error("the question is too large: {message}")]
    QuestionTooLarge {
        /// Which limit, by how much.
        message: String,
    },
    /// No connection, a timeout, a reset: nothing usable came back.
    #[error("{url}: {message}")]
    Transport {
        /// What was asked.
        url: String,
        /// Which way it failed.
        fault: Fault,
        /// In the words of the operating system.
        message: String,
    },
    /// The server answered with a status that is no success.
    #[error("{url}: HTTP {status}: {message}")]
    Status {
        /// What was asked.
        url: String,
        /// The status.
        status: u16,
        /// How long the server wants to be left alone.
        retry_after: Option<Duration>,
        /// What the server says, shortened.
        message: String,
    },
    /// Too many requests, as the server sees it.
    #[error("{url}: HTTP {status}, too many requests: {message}")]
    RateLimit {
        /// What was asked.
        url: String,
        /// The status.
        status: u16,
        /// How long the server wants to be left alone.
        retry_after: Option<Duration>,
        /// What the server says, shortened.
        message: String,
    },
    /// The server points elsewhere. Never followed: the key is for this host.
    #[error("{url}: HTTP {status}: the server points to {target}")]
    Redirect {
        /// What was asked.
        url: String,
        /// The status.
        status: u16,
        /// Where it points.
        target: String,
    },
    /// The answer is larger than the configured limit.
    #[error("{url}: the answer is larger than {limit_bytes} bytes")]
    AnswerTooLarge {
        /// What was asked.
        url: String,
        /// The limit.
        limit_bytes: u64,
    },
    /// A web page instead of an answer.
    #[error("{url}: HTTP {status}: the server sent a web page{}", titled(title))]
    WebPage {
        /// What was asked.
        url: String,
        /// The status.
        status: u16,
        /// Title of the page.
        title: Option<String>,
    },
    /// A success whose body is an error.
    #[error("{url}: HTTP {status}, but the body is an error: {message}")]
    ErrorBody {
        /// What was asked.
        url: String,
        /// The status.
        status: u16,
        /// The status that the body speaks of.
        code: Option<u16>,
        /// What the server says, shortened.
        message: String,
    },
    /// Bytes that are not the protocol's answer.
    #[error("{url}: the answer is not what the protocol says: {message}: {excerpt}")]
    Protocol {
        /// What was asked.
        url: String,
        /// What is missing or malformed.
        message: String,
        /// Its first characters.
        excerpt: String,
    },
    /// The model or its server declined.
    #[error("the model refused: {message}")]
    Refused {
        /// Its words.
        message: String,
    },
    /// The answer was cut at the limit of tokens.
    #[error("the answer was cut off at the limit of tokens: ...{excerpt}")]
    Truncated {
        /// Its last characters.
        excerpt: String,
    },
    /// The model said nothing.
    #[error("the model gave an empty answer")]
    Empty,
    /// The answer holds no JSON.
    #[error("the answer holds no JSON: {excerpt}")]
    NoJson {
        /// Its first characters.
        excerpt: String,
    },
    /// The answer begins JSON that never ends.
    #[error("the answer ends in the middle of its JSON: ...{excerpt}")]
    HalfJson {
        /// Its last characters.
        excerpt: String,
    },
    /// The answer's JSON is not of the shape that was asked for.
    #[error("the answer's JSON is not what was asked for: {field}: {message}")]
    Schema {
        /// Path to the field.
        field: String,
        /// What is wrong there.
        message: String,
    },
    /// So many failures in a row that asking on would be rude.
    #[error("{url}: gave up after {failures} failures in a row, the last one: {last}")]
    Broken {
        /// The endpoint.
        url: String,
        /// How many.
        failures: u32,
        /// The last one.
        last: String,
    },
    /// The budget does not cover the question.
    #[error("the budget does not cover the question: {message}")]
    Budget {
        /// Which limit, how much is spent, how much the question may need.
        message: String,
    },
    /// Replaying, and nobody recorded this question.
    #[error("{}: holds no answer to this question ({digest})", folder.display())]
    NotRecorded {
        /// The recording.
        folder: PathBuf,
        /// Name of the missing exchange.
        digest: String,
    },
}

/// Ways in which nothing comes back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The name of the host is unknown.
    UnknownHost,
    /// Nobody listens there.
    NoConnection,
    /// No answer in time.
    Timeout,
    /// The connection ended before the answer did.
    Reset,
    /// No trust in the other side.
    Tls,
    /// Anything else.
    Other,
}

/// What kind of error it is: the column of a table, the tag in a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Configuration, files, pictures, limits: nothing was asked.
    Setup,
    /// Nothing came back.
    Transport,
    /// A status that is no success.
    Status,
    /// Too many requests.
    RateLimit,
    /// Something came back that is no answer: a web page, an error inside a success, garbage, too much.
    Garbage,
    /// The model declined.
    Refused,
    /// The answer was cut off.
    Truncated,
    /// The answer does not hold the JSON that was asked for.
    Unparsed,
    /// Not asked: the endpoint kept failing.
    Broken,
    /// Not asked: the budget is spent.
    Budget,
    /// Not asked: the recording does not hold it.
    NotRecorded,
}

fn titled(title: &Option<String>) -> String {
    title.as_ref().map_or_else(String::new, |title| format!(" (\"{title}\")"))
}

impl EndpointError {
    /// Which kind it is.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Data(_) | Self::Config { .. } | Self::Picture { .. } | Self::QuestionTooLarge { .. } => {
                Kind::Setup
            }
            Self::Transport { .. } => Kind::Transport,
            Self::Status { .. } | Self::Redirect { .. } => Kind::Status,
            Self::RateLimit { .. } => Kind::RateLimit,
            Self::AnswerTooLarge { .. }
            | Self::WebPage { .. }
            | Self::ErrorBody { .. }
            | Self::Protocol { .. } => Kind::Garbage,
            Self::Refused { .. } => Kind::Refused,
            Self::Truncated { .. } => Kind::Truncated,
            Self::Empty | Self::NoJson { .. } | Self::HalfJson { .. } | Self::Schema { .. } => Kind::Unparsed,
            Self::Broken { .. } => Kind::Broken,
            Self::Budget { .. } => Kind::Budget,
            Self::NotRecorded { .. } => Kind::NotRecorded,
        }
    }

    /// Whether the server may have worked on the question before it failed.
    pub(crate) fn may_have_cost(&self) -> bool {
        matches!(
            self,
            Self::Transport { fault: Fault::Timeout | Fault::Reset, .. } | Self::AnswerTooLarge { .. }
        )
    }

    /// What to do about it.
    pub fn hint(&self) -> String {
        match self {
            Self::Data(error) => error.hint().unwrap_or_default(),
            Self::Config { remedy, .. } => remedy.clone(),
            Self::Picture { .. } => "send PNG, JPEG or WebP".to_owned(),
            Self::QuestionTooLarge { .. } => {
                "send fewer or smaller pictures, or raise the limit under [limits] of the endpoint file".to_owned()
            }
            Self::Transport { fault, .. } => fault.hint().to_owned(),
            Self::Status { status, .. } => status_hint(*status).to_owned(),
            Self::RateLimit { .. } => {
                "wait, use fewer --jobs, or ask the provider for a higher limit; answers so far are in the cache"
                    .to_owned()
            }
            Self::Redirect { .. } => {
                "set `base_url` to where the server points, if you trust it: keys are not sent after a redirect"
                    .to_owned()
            }
            Self::AnswerTooLarge { .. } => {
                "check that `base_url` is a model server, or raise `limits.response_bytes`".to_owned()
            }
            Self::WebPage { .. } => {
                "`base_url` is probably not the root of the protocol: it often ends in /v1; a proxy or login page may stand between"
                    .to_owned()
            }
            Self::ErrorBody { .. } => "see the server's own log; `l4d endpoint check` tells what works".to_owned(),
            Self::Protocol { .. } => {
                "check `base_url` and `server` of the endpoint; `l4d endpoint check` tells what works".to_owned()
            }
            Self::Refused { .. } => "reword the question, or use another model".to_owned(),
            Self::Truncated { .. } => "raise the limit of tokens, or use a model that thinks less".to_owned(),
            Self::Empty => "raise the limit of tokens, or use another model".to_owned(),
            Self::NoJson { .. } | Self::HalfJson { .. } | Self::Schema { .. } => {
                "use a server that keeps to a schema (`l4d endpoint check` tells), or a larger model".to_owned()
            }
            Self::Broken { .. } => {
                "see to the server and run the command again: answers so far are in the cache".to_owned()
            }
            Self::Budget { .. } => {
                "raise --max-tokens-total or --max-cost; answers so far are in the cache".to_owned()
            }
            Self::NotRecorded { .. } => {
                "the question differs from the recorded one (pictures, text, model, settings): record it with record:<folder>"
                    .to_owned()
            }
        }
    }
}

impl Fault {
    fn hint(self) -> &'static str {
        match self {
            Self::UnknownHost => "check the host in `base_url`, and the network",
            Self::NoConnection => "start the server, or check host and port in `base_url`",
            Self::Timeout => "give the server more time under [timeouts], send less, or see why it is slow",
            Self::Reset => "see the server's own log: it ended the connection before the answer did",
            Self::Tls => "check the certificate of the server, or whether it speaks plain http",
            Self::Other => "check `base_url` and the network",
        }
    }
}

fn status_hint(status: u16) -> &'static str {
    match status {
        401 | 403 => "check the key in the variable that `api_key_env` names, and what it may do",
        404 => "check `base_url` (it often ends in /v1) and `model`: `l4d endpoint check` lists the models",
        413 => "send fewer or smaller pictures",
        400 | 422 => {
            "the server does not take the question as it is: `l4d endpoint check` tells what it supports"
        }
        500.. => "see the server's own log",
        _ => "`l4d endpoint check` tells what the server supports",
    }
}

const EXCERPT_CHARS: usize = 200;

/// The first characters of a text, on one line.
pub(crate) fn excerpt(text: &str) -> String {
    shorten(text.trim(), false)
}

/// The last characters of a text, on one line.
pub(crate) fn tail(text: &str) -> String {
    shorten(text.trim(), true)
}

fn shorten(text: &str, from_end: bool) -> String {
    let count = text.chars().count();
    let skipped = if from_end { count.saturating_sub(EXCERPT_CHARS) } else { 0 };
    // Control characters could move the cursor of a terminal or forge lines of a log.
    let plain = |letter: char| if letter.is_control() { ' ' } else { letter };
    let mut short: String = text.chars().skip(skipped).take(EXCERPT_CHARS).map(plain).collect();
    if !from_end && count > EXCERPT_CHARS {
        short.push_str("...");
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_one_short_harmless_line() {
        assert_eq!(excerpt(" a\n\u{1b}[31mb "), "a  [31mb");
        assert_eq!(excerpt(&"ä".repeat(300)).chars().count(), 203);
        assert_eq!(tail(&format!("{}end", "ä".repeat(300))).chars().count(), 200);
        assert!(tail("the end").ends_with("end"));
    }
}
