//! An endpoint: where a server runs, which model is meant, and how it is to be asked.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use l4d_data::digest::sha256_hex;
use l4d_data::store::read_bounded;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use ureq::http::HeaderName;

use crate::base_url::BaseUrl;
use crate::budget::Prices;
use crate::error::EndpointError;

const MAX_CONFIG_BYTES: u64 = 1 << 20;
/// Fields of a question that an endpoint may leave out.
const OPTIONAL: [&str; 3] = ["temperature", "seed", "response_format"];
/// Kinds of servers, and what their users should know.
const SERVERS: [(&str, &str); 9] = [
    ("generic", "anything that speaks the OpenAI protocol"),
    (
        "vllm",
        "raise --limit-mm-per-prompt for several pictures; bit-stable across batches only with VLLM_BATCH_INVARIANT=1",
    ),
    ("llama-cpp", "start with --mmproj, --jinja and, for boxes, --image-min-tokens 1024"),
    (
        "ollama",
        "start with OLLAMA_CONTEXT_LENGTH=32768 or more: the default context drops the first pictures without an error",
    ),
    ("openai", "newer models take no temperature: write omit = [\"temperature\"]; the seed is best effort"),
    ("gemini", "base_url https://generativelanguage.googleapis.com/v1beta/openai"),
    ("mistral-rs", "ignores the seed; takes one picture unless started with --max-num-images"),
    ("transformers", "`transformers serve` ignores the schema"),
    ("dashscope", "base_url https://dashscope-intl.aliyuncs.com/compatible-mode/v1"),
];

/// Everything about an endpoint except its key, which is in an environment variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endpoint {
    /// Root of the protocol, for example `http://localhost:8000/v1`.
    pub base_url: BaseUrl,
    /// Name of the model, as the server knows it.
    pub model: String,
    /// Environment variable that holds the key; `None` for servers that want none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub api_key_env: Option<String>,
    /// Kind of the server: `generic`, `vllm`, `llama-cpp`, `openai`, ...
    #[serde(default = "generic")]
    pub server: String,
    /// Further headers: header -> environment variable that holds its value.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub header_env: BTreeMap<String, String>,
    /// Further fields of the question's body, as the server wants them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub body: BTreeMap<String, Value>,
    /// Fields of the question's body that the server does not take.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub omit: Vec<String>,
    /// Convention of the model's coordinates, where it is known; `l4d endpoint calibrate` finds it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<String>,
    /// How long to wait.
    #[serde(default)]
    pub timeouts: Timeouts,
    /// How often to try.
    #[serde(default)]
    pub retry: Retry,
    /// How much to take.
    #[serde(default)]
    pub limits: Limits,
    /// What tokens cost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prices: Option<Prices>,
}

/// How long to wait, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Timeouts {
    /// For a connection.
    pub connect_seconds: f64,
    /// For one try, from the first byte sent to the last byte received.
    pub request_seconds: f64,
    /// For an answer, all tries and pauses together.
    pub total_seconds: f64,
}

impl Default for Timeouts {
    fn default() -> Self {
        Self { connect_seconds: 10.0, request_seconds: 300.0, total_seconds: 900.0 }
    }
}

/// How often to try, and how long to pause between tries: `first_pause_seconds * 2^n`, at most
/// `longest_pause_seconds`, and a random part of that once more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Retry {
    /// Tries for one answer, the first included.
    pub tries: u32,
    /// The first pause.
    pub first_pause_seconds: f64,
    /// The longest pause.
    pub longest_pause_seconds: f64,
}

impl Default for Retry {
    fn default() -> Self {
        Self { tries: 6, first_pause_seconds: 1.0, longest_pause_seconds: 60.0 }
    }
}

/// How much to take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Bytes of one answer.
    pub response_bytes: u64,
    /// Pixels that cost one token, for estimates before anything is asked.
    pub pixels_per_token: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { response_bytes: 8 << 20, pixels_per_token: 28 * 28 }
    }
}

impl Endpoint {
    /// An endpoint with defaults.
    ///
    /// # Errors
    /// If the URL or the name of the model is unsound.
    pub fn new(base_url: &str, model: impl Into<String>) -> Result<Self, EndpointError> {
        let base_url = base_url.parse().map_err(|message: &str| {
            EndpointError::not_asked("base_url", message, "write it like http://localhost:8000/v1")
        })?;
        let endpoint = Self {
            base_url,
            model: model.into(),
            api_key_env: None,
            server: generic(),
            header_env: BTreeMap::new(),
            body: BTreeMap::new(),
            omit: Vec::new(),
            coordinates: None,
            timeouts: Timeouts::default(),
            retry: Retry::default(),
            limits: Limits::default(),
            prices: None,
        };
        endpoint.check("endpoint")?;
        Ok(endpoint)
    }

    /// Reads a TOML file.
    ///
    /// # Errors
    /// Names file and field, and never quotes a value: it may be a key in the wrong place.
    pub fn read(path: &Path) -> Result<Self, EndpointError> {
        let bytes = read_bounded(path, MAX_CONFIG_BYTES)?;
        let wrong = |field: &str, message: &str| {
            let place = format!("{}: {field}", path.display());
            let remedy = "see docs/endpoints.md for the fields of an endpoint file";
            EndpointError::not_asked(place, without_values(message), remedy)
        };
        let text = str::from_utf8(&bytes).map_err(|_not_utf8| wrong("top level", "is not UTF-8 text"))?;
        let document = toml::Deserializer::parse(text).map_err(|error| {
            let line = error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
            wrong(&format!("line {line}"), error.message())
        })?;
        let endpoint: Self = serde_path_to_error::deserialize(document).map_err(|error| {
            let field = error.path().to_string();
            wrong(if field == "." { "top level" } else { &field }, error.inner().message())
        })?;
        endpoint.check(&path.display().to_string())?;
        Ok(endpoint)
    }

    /// Refuses what cannot be; `place` is named in the error.
    ///
    /// # Errors
    /// Names the first field that is unsound.
    pub fn check(&self, place: &str) -> Result<(), EndpointError> {
        let day = 86_400.0;
        let Timeouts { connect_seconds, request_seconds, total_seconds } = self.timeouts;
        let timeouts = [connect_seconds, request_seconds, total_seconds];
        let pauses = [self.retry.first_pause_seconds, self.retry.longest_pause_seconds];
        let variables = || self.api_key_env.iter().chain(self.header_env.values());
        let names: Vec<&str> = SERVERS.iter().map(|(name, _)| *name).collect();
        let fields_of_l4d = ["model", "messages", "stream"];
        let rules = [
            (
                names.contains(&self.server.as_str()),
                "server",
                "is no kind of server that l4d knows",
                format!("use one of {}", names.join(", ")),
            ),
            (
                !self.model.trim().is_empty() && !self.model.chars().any(char::is_control),
                "model",
                "names no model",
                "name one that the server lists".to_owned(),
            ),
            (
                variables().all(|name| is_variable(name)),
                "api_key_env or header_env",
                "is not the name of an environment variable",
                "name the variable (capitals, digits, `_`) that holds the key, never the key itself"
                    .to_owned(),
            ),
            (
                self.header_env.keys().all(|name| HeaderName::from_str(name).is_ok()),
                "header_env",
                "a name is no HTTP header",
                "use letters, digits and `-`".to_owned(),
            ),
            (
                !fields_of_l4d.iter().any(|field| self.body.contains_key(*field)),
                "body",
                "must not set `model`, `messages` or `stream`",
                "l4d sets these fields itself".to_owned(),
            ),
            (
                self.omit.iter().all(|field| OPTIONAL.contains(&field.as_str())),
                "omit",
                "names a field that cannot be left out",
                format!("use {}", OPTIONAL.join(", ")),
            ),
            (
                timeouts.iter().all(|&seconds| seconds > 0.0 && seconds <= day),
                "timeouts",
                "must be more than 0 and at most 86400 seconds",
                "choose a waiting time".to_owned(),
            ),
            (
                self.retry.tries > 0 && pauses.iter().all(|seconds| (0.0..=day).contains(seconds)),
                "retry",
                "`tries` must be at least 1, pauses 0 to 86400 seconds",
                "use 1 to never try again".to_owned(),
            ),
            (
                self.limits.pixels_per_token > 0 && self.limits.response_bytes > 0,
                "limits",
                "must be at least 1",
                "leave the field out for its default".to_owned(),
            ),
            (
                self.prices.is_none_or(|prices| prices.is_sound()),
                "prices",
                "must be finite and not negative",
                "give the price of a million tokens".to_owned(),
            ),
        ];
        match rules.into_iter().find(|(holds, ..)| !holds) {
            Some((_, field, message, remedy)) => {
                Err(EndpointError::not_asked(format!("{place}: {field}"), message, remedy))
            }
            None => Ok(()),
        }
    }

    /// What users of this kind of server should know.
    pub fn note(&self) -> &'static str {
        SERVERS.iter().find(|(name, _)| *name == self.server).map_or("", |(_, note)| note)
    }

    /// The field that limits the length of an answer: OpenAI's newer models insist on the newer one.
    pub(crate) fn max_tokens_field(&self) -> &'static str {
        if self.server == "openai" { "max_completion_tokens" } else { "max_tokens" }
    }

    /// The URL of a route of the protocol.
    pub fn url(&self, route: &str) -> String {
        format!("{}/{route}", self.base_url)
    }

    /// A name for folders and tables of what is known about this endpoint and model.
    pub fn id(&self) -> String {
        let host: String =
            self.base_url.authority().replace(|letter: char| !letter.is_ascii_alphanumeric(), "_");
        let digest = sha256_hex(format!("{}\n{}\n{}", self.url(""), self.model, self.server).as_bytes());
        format!("{host}-{}", &digest[..12])
    }
}

fn generic() -> String {
    "generic".to_owned()
}

/// Capitals, digits and `_`: a key that was written in its place looks otherwise.
fn is_variable(name: &str) -> bool {
    let allowed = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
    name.len() <= 80
        && name.bytes().all(allowed)
        && name.starts_with(|letter: char| letter.is_ascii_uppercase() || letter == '_')
}

/// A parser's message without the value that it quotes, which may hold quotes itself.
fn without_values(message: &str) -> String {
    match (message.find('"'), message.rfind('"')) {
        (Some(first), Some(last)) => format!("{}\"...\"{}", &message[..first], &message[last + 1..]),
        _ => message.to_owned(),
    }
}

#[cfg(test)]
mod tests;
