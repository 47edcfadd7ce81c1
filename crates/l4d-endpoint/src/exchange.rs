//! One HTTP exchange as data, and folders of them: a cache or a recording.
//!
//! The raw response is kept, so that a better parser reads old answers for free.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use l4d_data::DataError;
use l4d_data::digest::sha256_hex;
use l4d_data::json::{self, canonical};
use serde::{Deserialize, Serialize};
use serde_json::Value;

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
    /// HTTP status.
    pub(crate) status: u16,
    /// The few headers that matter, in lower case.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(crate) headers: BTreeMap<String, String>,
    /// The body; bytes that are no UTF-8 are replaced.
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
    pub(crate) folder: PathBuf,
    /// Two threads that write one exchange would share its temporary file.
    writing: Mutex<()>,
}

impl Exchanges {
    pub(crate) fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), writing: Mutex::new(()) }
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

    pub(crate) fn write(&self, call: &Call, response: &Response) -> Result<(), DataError> {
        let exchange = Exchange {
            format: FORMAT.to_owned(),
            request: call.identity.clone(),
            response: response.clone(),
        };
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_exchange_is_found_by_its_question_and_a_damaged_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let exchanges = Exchanges::new(folder.path());
        let call = |text: &str| Call::new(String::new(), None, json!({ "text": text }));
        let response = Response { status: 200, headers: BTreeMap::new(), body: "A".to_owned() };
        exchanges.write(&call("a"), &response).unwrap();
        assert_eq!(exchanges.read(&call("a")).unwrap(), Some(response.clone()));
        assert_eq!(exchanges.read(&call("b")).unwrap(), None);

        let path = exchanges.path(&call("a").digest);
        let whole = fs::read_to_string(&path).unwrap();
        for damage in
            [whole[..40].to_owned(), whole.replace("\"a\"", "\"b\""), whole.replace(FORMAT, "other")]
        {
            fs::write(&path, damage).unwrap();
            let error = exchanges.read(&call("a")).unwrap_err();
            assert!(error.to_string().contains(&call("a").digest), "{error}");
        }
        exchanges.remove(&call("a")).unwrap();
        exchanges.remove(&call("a")).unwrap();
        assert_eq!(exchanges.read(&call("a")).unwrap(), None);
    }
}
