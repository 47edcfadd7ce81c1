//! Root of a server's protocol: a URL into which people write keys by mistake, so that its errors never quote it.

use std::fmt;
use std::net::IpAddr;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use ureq::http::Uri;

/// `http` or `https`, no user or password, no query, no slash at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BaseUrl {
    text: String,
    uri: Uri,
}

impl BaseUrl {
    /// The URL without a slash at the end.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Host and port.
    pub fn authority(&self) -> &str {
        self.uri.authority().map_or("", |authority| authority.as_str())
    }

    /// Whether the server runs on this machine.
    pub fn is_local(&self) -> bool {
        let host = self.uri.host().unwrap_or_default().trim_matches(['[', ']']);
        host == "localhost" || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
    }

    /// Whether a key would cross a network unencrypted.
    pub fn exposes_keys(&self) -> bool {
        self.uri.scheme_str() != Some("https") && !self.is_local()
    }
}

impl fmt::Display for BaseUrl {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.as_str())
    }
}

impl FromStr for BaseUrl {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
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
        Ok(Self { text: text.to_owned(), uri })
    }
}

impl TryFrom<String> for BaseUrl {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, &'static str> {
        text.parse()
    }
}

impl From<BaseUrl> for String {
    fn from(url: BaseUrl) -> Self {
        url.text
    }
}
