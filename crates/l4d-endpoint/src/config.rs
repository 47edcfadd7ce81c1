//! An endpoint: where a server runs, which model is meant, and how it is to be asked.

use std::collections::BTreeMap;
use std::fmt;
use std::net::IpAddr;
use std::path::Path;
use std::str::FromStr;

use l4d_data::digest::sha256_hex;
use l4d_data::toml_file;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use ureq::http::{HeaderName, Uri};

use crate::budget::Prices;
use crate::coordinates::Convention;
use crate::error::{EndpointError, excerpt};

/// Fields of a question that l4d sets itself, and those of them that an endpoint may leave out.
const OWN: [&str; 3] = ["model", "messages", "stream"];
const OPTIONAL: [&str; 3] = ["temperature", "seed", "response_format"];
/// Kinds of servers.
const SERVERS: [&str; 9] =
    ["generic", "vllm", "llama-cpp", "ollama", "openai", "gemini", "mistral-rs", "transformers", "dashscope"];

/// Root of a server's protocol: `http` or `https`, no user or password, no query, no slash at the end. People write
/// keys into it by mistake, so its errors never quote it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BaseUrl(Uri, String);

impl BaseUrl {
    /// Host and port.
    pub fn authority(&self) -> &str {
        self.0.authority().map_or("", |authority| authority.as_str())
    }

    /// Whether the server runs on this machine.
    pub(crate) fn is_local(&self) -> bool {
        let host = self.0.host().unwrap_or_default().trim_matches(['[', ']']);
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
    }

    /// Whether a key would cross a network unencrypted.
    pub(crate) fn exposes_keys(&self) -> bool {
        self.0.scheme_str() != Some("https") && !self.is_local()
    }
}

impl fmt::Display for BaseUrl {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.1)
    }
}

impl From<BaseUrl> for String {
    fn from(url: BaseUrl) -> Self {
        url.1
    }
}

impl FromStr for BaseUrl {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        text.to_owned().try_into()
    }
}

impl TryFrom<String> for BaseUrl {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, &'static str> {
        let text = text.trim().trim_end_matches('/');
        let uri: Uri = text.parse().map_err(|_why| "is no URL")?;
        if !matches!(uri.scheme_str(), Some("http" | "https")) {
            return Err("is neither http nor https");
        }
        if uri.authority().is_some_and(|authority| authority.as_str().contains('@')) {
            return Err(
                "holds a user name or password: put the key into an environment variable and name that in `api_key_env`",
            );
        }
        if uri.query().is_some() || text.contains('#') {
            return Err("holds a query or fragment: keys and options do not belong there");
        }
        if uri.host().is_none_or(str::is_empty) {
            return Err("names no host");
        }
        Ok(Self(uri, text.to_owned()))
    }
}

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
    /// Convention of the model's coordinates, for couplings that take boxes: docs/endpoints.md lists them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<String>,
    /// How long to wait.
    #[serde(default)]
    pub timeouts: Timeouts,
    /// How often to try.
    #[serde(default)]
    pub retry: Retry,
    /// What tokens cost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prices: Option<Prices>,
}

/// How long to wait, seconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Timeouts {
    /// For one try, from the connection to the last byte received.
    pub request_seconds: f64,
    /// For an answer, all tries and pauses together.
    pub total_seconds: f64,
}

impl Default for Timeouts {
    fn default() -> Self {
        Self { request_seconds: 300.0, total_seconds: 900.0 }
    }
}

/// How often to try, and how long to pause between tries: `first_pause_seconds * 2^n`, and a random part of that
/// once more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Retry {
    /// Tries for one answer, the first included.
    pub tries: u32,
    /// The first pause.
    pub first_pause_seconds: f64,
}

impl Default for Retry {
    fn default() -> Self {
        Self { tries: 6, first_pause_seconds: 1.0 }
    }
}

impl Endpoint {
    /// How the model writes boxes.
    ///
    /// # Errors
    /// The endpoint does not say, or names no convention.
    pub fn convention(&self) -> Result<&'static Convention, EndpointError> {
        match &self.coordinates {
            Some(name) => Convention::named(name),
            None => Err(EndpointError::not_asked(
                "coordinates",
                format!("it is not known how `{}` writes boxes", excerpt(&self.model)),
                "set `coordinates` in the endpoint file: docs/endpoints.md lists which models write boxes how",
            )),
        }
    }

    /// An endpoint with defaults.
    ///
    /// # Errors
    /// If the URL or the name of the model is unsound.
    pub fn new(base_url: &str, model: &str) -> Result<Self, EndpointError> {
        let endpoint = Self {
            base_url: base_url.parse().map_err(|message: &str| {
                EndpointError::not_asked("base_url", message, "write it like http://localhost:8000/v1")
            })?,
            model: model.to_owned(),
            api_key_env: None,
            server: generic(),
            header_env: BTreeMap::new(),
            body: BTreeMap::new(),
            omit: Vec::new(),
            coordinates: None,
            timeouts: Timeouts::default(),
            retry: Retry::default(),
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
        let endpoint: Self =
            toml_file::read(path, "see docs/endpoints.md for the fields of an endpoint file")?;
        endpoint.check(&path.display().to_string())?;
        Ok(endpoint)
    }

    /// Refuses what cannot be; `place` is named in the error.
    ///
    /// # Errors
    /// Names the first field that is unsound.
    pub fn check(&self, place: &str) -> Result<(), EndpointError> {
        let day = 86_400.0;
        let Timeouts { request_seconds, total_seconds } = self.timeouts;
        let Retry { tries, first_pause_seconds } = self.retry;
        let mut variables = self.api_key_env.iter().chain(self.header_env.values());
        let one_of = |names: &[&str]| format!("use one of {}", names.join(", "));
        let rules = [
            (
                SERVERS.contains(&self.server.as_str()),
                "server",
                "is no kind of server that l4d knows",
                one_of(&SERVERS),
            ),
            (
                !self.model.trim().is_empty() && !self.model.chars().any(char::is_control),
                "model",
                "names no model",
                "name one that the server lists".to_owned(),
            ),
            (
                variables.all(|name| is_variable(name)),
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
                !OWN.iter().any(|field| self.body.contains_key(*field)),
                "body",
                "must not set `model`, `messages` or `stream`",
                "l4d sets these fields itself".to_owned(),
            ),
            (
                self.omit.iter().all(|field| OPTIONAL.contains(&field.as_str())),
                "omit",
                "names a field that cannot be left out",
                one_of(&OPTIONAL),
            ),
            (
                [request_seconds, total_seconds].iter().all(|&seconds| seconds > 0.0 && seconds <= day),
                "timeouts",
                "must be more than 0 and at most 86400 seconds",
                "choose a waiting time".to_owned(),
            ),
            (
                tries > 0 && (0.0..=day).contains(&first_pause_seconds),
                "retry",
                "`tries` must be at least 1, pauses 0 to 86400 seconds",
                "use 1 to never try again".to_owned(),
            ),
            (
                self.prices.is_none_or(|prices| prices.is_sound()),
                "prices",
                "must be finite and not negative",
                "give the price of a million tokens".to_owned(),
            ),
        ];
        match rules.into_iter().find(|(holds, ..)| !holds) {
            Some((_, field, message, hint)) => {
                Err(EndpointError::not_asked(format!("{place}: {field}"), message, hint))
            }
            None => Ok(()),
        }
    }

    /// The URL of a route of the protocol.
    pub(crate) fn url(&self, route: &str) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: &str = "base_url = \"http://localhost:8000/v1\"\nmodel = \"m\"\n";

    fn read(text: &str) -> Result<Endpoint, EndpointError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("endpoint.toml");
        std::fs::write(&path, text).unwrap();
        Endpoint::read(&path)
    }

    #[test]
    fn a_file_says_everything_and_defaults_say_the_rest() {
        let endpoint = read(
            r#"
            base_url = "https://gpu.example.org:8443/v1/"
            model = "Qwen/Qwen3-VL-8B-Instruct"
            api_key_env = "LAB_KEY"
            server = "vllm"
            coordinates = "rel1000_xyxy"
            omit = ["seed"]
            header_env = { x-organisation = "LAB_ORGANISATION" }
            timeouts = { request_seconds = 60 }
            prices = { prompt_per_million = 0.5, completion_per_million = 1.5 }
            [body]
            chat_template_kwargs = { enable_thinking = false }
            "#,
        )
        .unwrap();
        assert_eq!(endpoint.url("chat/completions"), "https://gpu.example.org:8443/v1/chat/completions");
        assert_eq!(endpoint.timeouts, Timeouts { request_seconds: 60.0, ..Timeouts::default() });
        assert_eq!(endpoint.body["chat_template_kwargs"]["enable_thinking"], false);
        assert!(!endpoint.base_url.exposes_keys());
        assert_eq!(read(BASE).unwrap(), Endpoint::new("http://localhost:8000/v1", "m").unwrap());
    }

    #[test]
    fn ids_tell_endpoints_and_models_apart() {
        let pairs = [("http://a:1/v1", "m"), ("http://a:1/v2", "m"), ("http://a:1/v1", "../../m")];
        let ids = pairs.map(|(url, model)| Endpoint::new(url, model).unwrap().id());
        assert!(ids[0] != ids[1] && ids[1] != ids[2] && ids[0] != ids[2], "{ids:?}");
        assert!(ids.iter().all(|id| l4d_data::Name::new(id.as_str()).is_ok()), "{ids:?}");
    }

    #[test]
    fn what_cannot_be_is_refused_with_field_and_hint() {
        let cases = [
            ("model = \"m\"".to_owned(), "base_url"),
            ("base_url = \"http://localhost\"".to_owned(), "model"),
            (BASE.replace("\"m\"", "\" \""), "model"),
            (BASE.replace("http:", "ftp:"), "neither http nor https"),
            (BASE.replace("localhost:8000/v1", "h/v1?x=1"), "query"),
            (BASE.replace("http://localhost:8000", ""), "base_url"),
            (format!("{BASE}server = \"vlm\""), "no kind of server"),
            (format!("{BASE}[retry]\ntries = 0"), "tries"),
            (format!("{BASE}[retry]\nfirst_pause_seconds = nan"), "pauses"),
            (format!("{BASE}[timeouts]\nrequest_seconds = -1"), "timeouts"),
            (format!("{BASE}[timeouts]\nrequest_minutes = 1"), "timeouts"),
            (format!("{BASE}[prices]\nprompt_per_million = -1\ncompletion_per_million = 1"), "prices"),
            (format!("{BASE}[body]\nstream = true"), "must not set"),
            (format!("{BASE}omit = [\"messages\"]"), "cannot be left out"),
            (format!("{BASE}[header_env]\n\"a b\" = \"C\""), "no HTTP header"),
            (format!("{BASE}unknown = 1"), "unknown"),
            ("base_url = ".to_owned(), "line 1"),
        ];
        for (text, words) in cases {
            let error = read(&text).unwrap_err();
            assert!(error.to_string().contains(words), "{text}\n{error}");
            assert!(!error.hint().is_empty());
        }
    }

    #[test]
    fn secrets_in_the_wrong_place_are_refused_and_not_quoted() {
        let cases = [
            "base_url = \"https://me:sk-canary@host/v1\"\nmodel = \"m\"".to_owned(),
            "base_url = \"https://sk-canary@host/v1\"\nmodel = \"m\"".to_owned(),
            "base_url = \"https://host/v1?key=sk-canary\"\nmodel = \"m\"".to_owned(),
            format!("{BASE}api_key = \"sk-canary\""),
            format!("{BASE}api_key_env = \"sk-canary\""),
            format!("{BASE}api_key_env = [\"sk-canary\"]"),
            format!("{BASE}header_env = \"sk-canary\""),
            format!("{BASE}server = \"sk-canary\""),
            format!("{BASE}timeouts = \"sk-canary \\\" sk-canary\""),
            format!("{BASE}[headers]\nx-api-key = \"sk-canary\""),
            format!("{BASE}[header_env]\nx-api-key = \"sk-canary\""),
            format!("{BASE}api_key = sk-canary"),
            format!("{BASE}api_key = \"sk-canary"),
        ];
        for text in cases {
            let error = read(&text).unwrap_err();
            let told = format!("{error} {error:?} {}", error.hint());
            assert!(!told.contains("canary"), "{told}");
        }
        assert!(!format!("{:?}", Endpoint::new("https://sk-canary@host", "m")).contains("canary"));
    }
}
