//! One HTTP exchange as data: what is sent, what came back, and the digest by which both are found again.

use std::collections::BTreeMap;

use l4d_data::digest::sha256_hex;
use l4d_data::json::canonical;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// What is sent. The key is not part of it: a transport adds headers itself.
#[derive(Debug, Clone)]
pub struct Call {
    /// The full URL.
    pub url: String,
    /// The body of a POST; `None` for a GET.
    pub body: Option<Vec<u8>>,
    /// What identifies the question: route and body, with digests in the place of pictures.
    pub identity: Value,
    /// SHA-256 of the canonical identity.
    pub digest: String,
}

impl Call {
    /// A GET.
    pub(crate) fn get(url: String, route: &str) -> Self {
        Self::identified(url, None, json!({ "route": route }))
    }

    /// A POST of a JSON body; `identity` says the same with digests in the place of pictures.
    pub(crate) fn post(url: String, body: &Value, identity: Value) -> Self {
        Self::identified(url, Some(body.to_string().into_bytes()), identity)
    }

    fn identified(url: String, body: Option<Vec<u8>>, identity: Value) -> Self {
        let digest = sha256_hex(canonical(&identity).as_bytes());
        Self { url, body, identity, digest }
    }
}

/// What came back, keys taken out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Response {
    /// HTTP status.
    pub status: u16,
    /// The few headers that matter, in lower case.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub headers: BTreeMap<String, String>,
    /// The body; bytes that are no UTF-8 are replaced.
    pub body: String,
}

impl Response {
    /// Headers that are kept.
    pub(crate) const HEADERS: [&'static str; 5] =
        ["content-type", "date", "location", "retry-after", "retry-after-ms"];

    /// A header, if it came.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.get(name).map(String::as_str)
    }

    /// Whether the server calls it a success.
    pub(crate) fn is_success(&self) -> bool {
        (200..300).contains(&self.status)
    }
}
