//! Exchanges on disk: one file each, named by the digest of its question, written whole or not at all.
//!
//! A cache and a recording are the same kind of folder. The raw response is kept, so that a better parser reads
//! old answers for free.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use l4d_data::digest::sha256_hex;
use l4d_data::{DataError, json};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::call::{Call, Response};

const FORMAT: &str = "l4d-exchange 1";

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Exchange {
    format: String,
    request: Value,
    response: Response,
}

/// A folder of exchanges.
#[derive(Debug)]
pub(crate) struct Exchanges {
    folder: PathBuf,
    /// Two threads that write one exchange would share its temporary file.
    writing: Mutex<()>,
}

impl Exchanges {
    pub(crate) fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), writing: Mutex::new(()) }
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The kept response to this call, if there is one.
    pub(crate) fn read(&self, call: &Call) -> Result<Option<Response>, DataError> {
        let path = self.path(&call.digest);
        if !path.exists() {
            return Ok(None);
        }
        let exchange: Exchange = json::read(&path)?;
        let damaged = |location: &str, message: &str| {
            DataError::invalid(&path, location, message, "delete the file: it is asked or recorded again")
        };
        if exchange.format != FORMAT {
            return Err(damaged("format", "is not one that this version reads"));
        }
        if sha256_hex(json::canonical(&exchange.request).as_bytes()) != call.digest {
            return Err(damaged("request", "is not the question that the file's name says"));
        }
        Ok(Some(exchange.response))
    }

    /// Keeps a response.
    pub(crate) fn write(&self, call: &Call, response: &Response) -> Result<(), DataError> {
        let exchange = Exchange {
            format: FORMAT.to_owned(),
            request: call.identity.clone(),
            response: response.clone(),
        };
        let _writing = self.writing.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        json::write(&self.path(&call.digest), &exchange)
    }

    /// Drops a response.
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
    use std::collections::BTreeMap;

    use serde_json::json;

    use super::*;

    fn call(text: &str) -> Call {
        let body = json!({ "text": text });
        Call::post("http://localhost/v1/chat".to_owned(), &body, body.clone())
    }

    fn response(body: &str) -> Response {
        Response { status: 200, headers: BTreeMap::new(), body: body.to_owned() }
    }

    #[test]
    fn an_exchange_is_found_by_its_question_alone() {
        let folder = tempfile::tempdir().unwrap();
        let store = Exchanges::new(folder.path());
        store.write(&call("a"), &response("A")).unwrap();
        assert_eq!(store.read(&call("a")).unwrap().unwrap().body, "A");
        assert!(store.read(&call("b")).unwrap().is_none());
        store.remove(&call("a")).unwrap();
        store.remove(&call("a")).unwrap();
        assert!(store.read(&call("a")).unwrap().is_none());
    }

    #[test]
    fn a_damaged_or_exchanged_file_is_named_and_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let store = Exchanges::new(folder.path());
        store.write(&call("a"), &response("A")).unwrap();
        let path = store.path(&call("a").digest);
        let whole = fs::read_to_string(&path).unwrap();
        for damage in
            [whole[..40].to_owned(), whole.replace("\"a\"", "\"b\""), whole.replace(FORMAT, "other")]
        {
            fs::write(&path, damage).unwrap();
            let error = store.read(&call("a")).unwrap_err();
            assert!(error.to_string().contains(&call("a").digest), "{error}");
        }
    }
}
