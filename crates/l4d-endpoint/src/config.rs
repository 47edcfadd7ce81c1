//! An endpoint: where a server stands, which model is meant, and how it is to be asked.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use l4d_data::digest::sha256_hex;
use l4d_data::store::read_bounded;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::address::{BaseUrl, Invalid, Variable};
use crate::budget::Prices;
use crate::error::EndpointError;
use crate::server::{Dialect, Server};

const MAX_CONFIG_BYTES: u64 = 1 << 20;

/// Everything about an endpoint except its key, which stands in an environment variable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endpoint {
    /// Root of the protocol, for example `http://localhost:8000/v1`.
    pub base_url: BaseUrl,
    /// Name of the model, as the server knows it.
    pub model: String,
    /// Environment variable that holds the key; `None` for servers that want none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub api_key_env: Option<Variable>,
    /// Kind of the server: `generic`, `vllm`, `llama-cpp`, `ollama`, ...
    #[serde(default = "generic")]
    pub server: String,
    /// Further headers; nothing secret.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub headers: BTreeMap<String, String>,
    /// Further headers whose values are secrets: header -> environment variable.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub header_env: BTreeMap<String, Variable>,
    /// Further fields of the question's body, as the server wants them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub body: BTreeMap<String, Value>,
    /// Convention of the model's coordinates, where it is known; `l4d endpoint calibrate` finds it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<String>,
    /// How long to wait.
    #[serde(default)]
    pub timeouts: Timeouts,
    /// How often to try.
    #[serde(default)]
    pub retry: Retry,
    /// How much to send and to take.
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

/// How often to try, and how long to pause between tries: a random part of `first * 2^n`, `longest` at most.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Retry {
    /// Tries for one answer, the first included.
    pub tries: u32,
    /// Longest first pause.
    pub first_pause_seconds: f64,
    /// Longest of all pauses.
    pub longest_pause_seconds: f64,
    /// After this many questions in a row that failed for want of a working server, no more are asked for a while.
    pub failures_in_a_row: u32,
    /// How long that while is.
    pub rest_seconds: f64,
}

impl Default for Retry {
    fn default() -> Self {
        Self {
            tries: 6,
            first_pause_seconds: 1.0,
            longest_pause_seconds: 60.0,
            failures_in_a_row: 5,
            rest_seconds: 60.0,
        }
    }
}

/// How much to send and to take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Pictures in one question; default: what the kind of server takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub images: Option<usize>,
    /// Bytes of one question as it is sent.
    pub request_bytes: u64,
    /// Bytes of one answer.
    pub response_bytes: u64,
    /// Pixels that cost one token, for estimates before anything is asked.
    pub pixels_per_token: u32,
    /// Tokens of question and answer together; only Ollama is told. Default: what the question needs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub context_tokens: Option<u64>,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            images: None,
            request_bytes: 256 << 20,
            response_bytes: 8 << 20,
            pixels_per_token: 28 * 28,
            context_tokens: None,
        }
    }
}

impl Endpoint {
    /// An endpoint with defaults.
    pub fn new(base_url: &str, model: impl Into<String>) -> Result<Self, EndpointError> {
        let endpoint = Self {
            base_url: base_url.parse().map_err(|invalid: Invalid| invalid.at("base_url"))?,
            model: model.into(),
            api_key_env: None,
            server: generic(),
            headers: BTreeMap::new(),
            header_env: BTreeMap::new(),
            body: BTreeMap::new(),
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
    pub fn read(path: &Path) -> Result<Self, EndpointError> {
        let bytes = read_bounded(path, MAX_CONFIG_BYTES)?;
        let place = path.display().to_string();
        let remedy = "see docs/endpoints.md for the fields of an endpoint file";
        let text =
            String::from_utf8(bytes).map_err(|_not_utf8| refuse(&place, "is not UTF-8 text", remedy))?;
        let wrong = |field: String, message: &str| {
            // The parser's own rendering would quote the line, and somebody may have written a key into it.
            refuse(&format!("{place}: {field}"), without_values(message), remedy)
        };
        let document = toml::Deserializer::parse(&text).map_err(|error| {
            let line = error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
            wrong(format!("line {line}"), error.message())
        })?;
        let endpoint: Self = serde_path_to_error::deserialize(document).map_err(|error| {
            let field = error.path().to_string();
            wrong(if field == "." { "top level".to_owned() } else { field }, error.inner().message())
        })?;
        endpoint.check(&place)?;
        Ok(endpoint)
    }

    /// Refuses what cannot be; `place` is named in the error.
    pub fn check(&self, place: &str) -> Result<(), EndpointError> {
        let refuse = |field: &str, message: &str, remedy: &str| {
            Err(refuse(&format!("{place}: {field}"), message, remedy))
        };
        Server::named(&self.server)?;
        if self.model.trim().is_empty() || self.model.chars().any(char::is_control) {
            return refuse("model", "names no model", "name one that the server lists");
        }
        let Timeouts { connect_seconds, request_seconds, total_seconds } = self.timeouts;
        let Retry { tries, first_pause_seconds, longest_pause_seconds, failures_in_a_row, rest_seconds } =
            self.retry;
        let positive = [connect_seconds, request_seconds, total_seconds];
        let pauses = [first_pause_seconds, longest_pause_seconds, rest_seconds];
        let day = 86_400.0;
        if !positive.into_iter().all(|seconds| seconds > 0.0 && seconds <= day) {
            return refuse(
                "timeouts",
                "must be more than 0 and at most 86400 seconds",
                "choose a waiting time",
            );
        }
        if !pauses.into_iter().all(|seconds| (0.0..=day).contains(&seconds)) {
            return refuse("retry", "pauses must be 0 to 86400 seconds", "choose a pause");
        }
        if tries == 0 || failures_in_a_row == 0 {
            return refuse(
                "retry",
                "`tries` and `failures_in_a_row` must be at least 1",
                "use 1 to never try again",
            );
        }
        if self.limits.pixels_per_token == 0 || self.limits.response_bytes == 0 {
            return refuse("limits", "must be at least 1", "leave the field out for its default");
        }
        if self.prices.is_some_and(|prices| !prices.is_sound()) {
            return refuse("prices", "must be finite and not negative", "give the price of a million tokens");
        }
        self.check_headers(place)?;
        for field in ["model", "messages", "stream"] {
            if self.body.contains_key(field) {
                return refuse("body", &format!("must not set `{field}`"), "l4d sets this field itself");
            }
        }
        Ok(())
    }

    fn check_headers(&self, place: &str) -> Result<(), EndpointError> {
        use ureq::http::{HeaderName, HeaderValue};
        let refuse = |field: &str, message: &str, remedy: &str| {
            Err(refuse(&format!("{place}: {field}"), message, remedy))
        };
        for name in self.headers.keys().chain(self.header_env.keys()) {
            if HeaderName::from_str(name).is_err() {
                return refuse("headers", "a name is no HTTP header", "use letters, digits and `-`");
            }
        }
        for (name, value) in &self.headers {
            let lower = name.to_lowercase();
            if ["authorization", "cookie", "key", "token", "secret"].iter().any(|word| lower.contains(word)) {
                let remedy = "name the environment variable that holds it under [header_env]";
                return refuse(
                    &format!("headers.{name}"),
                    "is a secret, which has no place in a file",
                    remedy,
                );
            }
            if HeaderValue::from_str(value).is_err() {
                return refuse(
                    &format!("headers.{name}"),
                    "is no value of an HTTP header",
                    "use one line of ASCII",
                );
            }
        }
        Ok(())
    }

    /// What is known about its kind of server.
    pub fn kind(&self) -> &'static Server {
        // `check` has found it before.
        Server::named(&self.server).unwrap_or(&Server::all()[0])
    }

    /// The URL of a route of the protocol.
    pub fn url(&self, route: &str) -> String {
        let root = self.base_url.as_str();
        let root = match self.kind().dialect {
            Dialect::Openai => root,
            // Users write Ollama's OpenAI root, its own routes stand beside it.
            Dialect::Ollama => root.strip_suffix("/v1").unwrap_or(root),
        };
        format!("{root}/{route}")
    }

    /// A name for folders and tables of what was learned about this endpoint and model.
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

fn refuse(place: &str, message: impl Into<String>, remedy: impl Into<String>) -> EndpointError {
    EndpointError::Config { place: place.to_owned(), message: message.into(), remedy: remedy.into() }
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
