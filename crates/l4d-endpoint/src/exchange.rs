//! One HTTP exchange as data, folders of them (a cache or a recording), and where answers come from: a server, a
//! server that is recorded, or a recording.
//!
//! The raw response is kept, so that a better parser reads old answers for free.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use l4d_data::DataError;
use l4d_data::digest::sha256_hex;
use l4d_data::json::{self, canonical};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::config::Endpoint;
use crate::error::EndpointError;

const ENDPOINT_FILE: &str = "endpoint.json";
const FORMAT: &str = "l4d-exchange 1";

/// What is sent, without the key.
#[derive(Debug, Clone)]
pub(crate) struct Call {
    /// The full URL.
    pub(crate) url: String,
    /// The body of a POST; `None` for a GET.
    pub(crate) body: Option<Vec<u8>>,
    /// What identifies the question: route and body, with digests in the place of pictures.
    identity: Value,
    /// SHA-256 of the canonical identity.
    pub(crate) digest: String,
}

impl Call {
    pub(crate) fn new(url: String, body: Option<Vec<u8>>, identity: Value) -> Self {
        let digest = sha256_hex(canonical(&identity).as_bytes());
        Self { url, body, identity, digest }
    }
}

/// What came back, keys taken out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Response {
    pub(crate) status: u16,
    /// The few headers that matter, in lower case.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) headers: BTreeMap<String, String>,
    /// The body; bytes that are no UTF-8 are replaced. Empty where the status is an error.
    pub(crate) body: String,
}

impl Response {
    /// Headers that are kept.
    pub(crate) const HEADERS: [&'static str; 5] =
        ["content-type", "date", "location", "retry-after", "retry-after-ms"];

    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.get(name).map(String::as_str)
    }

    pub(crate) fn is_success(&self) -> bool {
        (200..300).contains(&self.status)
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Exchange {
    format: String,
    request: Value,
    response: Response,
}

/// A folder of exchanges, one file per question, named by its digest.
#[derive(Debug)]
pub(crate) struct Exchanges {
    folder: PathBuf,
}

impl Exchanges {
    pub(crate) fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// The kept response to this call, if there is one.
    pub(crate) fn read(&self, call: &Call) -> Result<Option<Response>, DataError> {
        let path = self.path(&call.digest);
        if !path.exists() {
            return Ok(None);
        }
        let exchange: Exchange = json::read(&path)?;
        let damaged = |field: &str, message: &str| {
            DataError::invalid(&path, field, message, "delete the file: it is asked or recorded again")
        };
        if exchange.format != FORMAT {
            return Err(damaged("format", "is not one that this version reads"));
        }
        if sha256_hex(canonical(&exchange.request).as_bytes()) != call.digest {
            return Err(damaged("request", "is not the question that the file's name says"));
        }
        Ok(Some(exchange.response))
    }

    /// The same, where there has to be one.
    pub(crate) fn recorded(&self, call: &Call) -> Result<Response, EndpointError> {
        self.read(call)?.ok_or_else(|| {
            EndpointError::not_asked(
                self.folder.display().to_string(),
                format!("holds no answer to question {}", call.digest),
                "the question differs from the recorded one (pictures, text, model, settings): record it with \
                 record:<folder>",
            )
        })
    }

    /// A failure of the server does not replace what it said before.
    pub(crate) fn record(&self, call: &Call, response: &Response) -> Result<(), DataError> {
        let kept = self.read(call).ok().flatten();
        if response.is_success() || !kept.is_some_and(|kept| kept.is_success()) {
            self.write(call, response)?;
        }
        Ok(())
    }

    pub(crate) fn write(&self, call: &Call, response: &Response) -> Result<(), DataError> {
        let exchange = Exchange {
            format: FORMAT.to_owned(),
            request: call.identity.clone(),
            response: response.clone(),
        };
        json::write(&self.path(&call.digest), &exchange)
    }

    pub(crate) fn remove(&self, call: &Call) -> Result<(), DataError> {
        let path = self.path(&call.digest);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                Err(DataError::io(&path, "delete", error))
            }
            _ => Ok(()),
        }
    }

    fn path(&self, digest: &str) -> PathBuf {
        self.folder.join(&digest[..2]).join(format!("{digest}.json"))
    }
}

/// Where answers come from: `live`, `record:<folder>` or `replay:<folder>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Link {
    #[default]
    Live,
    /// The server, and everything that it says is kept in a folder.
    Record(PathBuf),
    /// Such a folder, and no network at all.
    Replay(PathBuf),
}

impl FromStr for Link {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "live" => Ok(Self::Live),
            Some(("record", folder)) if !folder.is_empty() => Ok(Self::Record(folder.into())),
            Some(("replay", folder)) if !folder.is_empty() => Ok(Self::Replay(folder.into())),
            _ => Err("write `live`, `record:<folder>` or `replay:<folder>`".to_owned()),
        }
    }
}

impl Endpoint {
    /// The endpoint that a recording was made of.
    ///
    /// # Errors
    /// If `endpoint.json` in the folder is missing or unsound.
    pub fn recorded(folder: &Path) -> Result<Self, EndpointError> {
        let path = folder.join(ENDPOINT_FILE);
        let endpoint: Self = json::read(&path)?;
        endpoint.check(&path.display().to_string())?;
        Ok(endpoint)
    }

    /// Begins a recording. Names of variables that hold keys are of no use to its readers.
    pub(crate) fn record(&self, folder: &Path) -> Result<(), DataError> {
        let open = Self { api_key_env: None, header_env: BTreeMap::new(), ..self.clone() };
        json::write(&folder.join(ENDPOINT_FILE), &open)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_damaged_file_is_refused_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let exchanges = Exchanges::new(folder.path());
        let call = Call::new(String::new(), None, json!({ "text": "a" }));
        let response = Response { status: 200, headers: BTreeMap::new(), body: "A".to_owned() };
        exchanges.write(&call, &response).unwrap();
        assert_eq!(exchanges.read(&call).unwrap(), Some(response));
        let path = exchanges.path(&call.digest);
        let whole = fs::read_to_string(&path).unwrap();
        for damage in
            [whole[..40].to_owned(), whole.replace("\"a\"", "\"b\""), whole.replace(FORMAT, "other")]
        {
            fs::write(&path, damage).unwrap();
            let error = exchanges.read(&call).unwrap_err();
            assert!(error.to_string().contains(&call.digest), "{error}");
        }
    }

    #[test]
    fn links_are_read_from_text() {
        assert_eq!("live".parse(), Ok(Link::Live));
        assert_eq!("replay:a:b/c".parse(), Ok(Link::Replay("a:b/c".into())));
        assert_eq!("record:x".parse(), Ok(Link::Record("x".into())));
        for bad in ["", "replay", "replay:", "tape:x"] {
            assert!(bad.parse::<Link>().is_err(), "{bad}");
        }
    }
}
