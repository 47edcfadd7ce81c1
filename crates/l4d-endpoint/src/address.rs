//! Where a server stands and what a key's variable is called: two texts into which people write secrets by mistake.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use ureq::http::Uri;
use ureq::http::uri::Authority;

use crate::error::EndpointError;

/// Root of a server's protocol: `http` or `https`, no user or password, no query, no slash at the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct BaseUrl {
    text: String,
    authority: String,
    is_local: bool,
    is_encrypted: bool,
}

impl BaseUrl {
    /// The URL without a slash at the end.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Host and port.
    pub fn authority(&self) -> &str {
        &self.authority
    }

    /// Whether the server stands on this machine.
    pub fn is_local(&self) -> bool {
        self.is_local
    }

    /// Whether a key would cross a network in the clear.
    pub fn exposes_keys(&self) -> bool {
        !self.is_encrypted && !self.is_local
    }
}

impl fmt::Display for BaseUrl {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

/// Why a text is no [`BaseUrl`] or [`Variable`]. Never quotes it: it may hold a password or a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct Invalid {
    message: &'static str,
    remedy: &'static str,
}

impl Invalid {
    /// As an error about the field or flag of that name.
    pub fn at(self, place: &str) -> EndpointError {
        let Self { message, remedy } = self;
        EndpointError::Config {
            place: place.to_owned(),
            message: message.to_owned(),
            remedy: remedy.to_owned(),
        }
    }
}

impl FromStr for BaseUrl {
    type Err = Invalid;

    fn from_str(text: &str) -> Result<Self, Invalid> {
        let example = "write it like http://localhost:8000/v1";
        let uri: Uri =
            text.trim().parse().map_err(|_why| Invalid { message: "is no URL", remedy: example })?;
        let authority: &Authority =
            uri.authority().ok_or(Invalid { message: "names no host", remedy: example })?;
        if authority.as_str().contains('@') {
            return Err(Invalid {
                message: "holds a user name or password",
                remedy: "put the key into an environment variable and name that in `api_key_env`",
            });
        }
        let is_encrypted = match uri.scheme_str() {
            Some("https") => true,
            Some("http") => false,
            _ => return Err(Invalid { message: "is neither http nor https", remedy: example }),
        };
        if uri.query().is_some() || text.contains('#') {
            return Err(Invalid {
                message: "holds a query or fragment",
                remedy: "keys and options do not belong there",
            });
        }
        let host = authority.host().trim_matches(['[', ']']);
        let is_local = host == "localhost"
            || host.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback());
        if host.is_empty() {
            return Err(Invalid { message: "names no host", remedy: example });
        }
        let text = text.trim().trim_end_matches('/').to_owned();
        Ok(Self { text, authority: authority.as_str().to_owned(), is_local, is_encrypted })
    }
}

impl TryFrom<String> for BaseUrl {
    type Error = Invalid;

    fn try_from(text: String) -> Result<Self, Invalid> {
        text.parse()
    }
}

impl From<BaseUrl> for String {
    fn from(url: BaseUrl) -> Self {
        url.text
    }
}

/// Name of an environment variable: capitals, digits and `_`. A key that was written in its place looks otherwise.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Variable(String);

impl Variable {
    /// The name.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for Variable {
    type Err = Invalid;

    fn from_str(text: &str) -> Result<Self, Invalid> {
        let allowed = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
        let starts_well = text.starts_with(|letter: char| letter.is_ascii_uppercase() || letter == '_');
        if !starts_well || text.len() > 80 || !text.bytes().all(allowed) {
            return Err(Invalid {
                message: "is not the name of an environment variable",
                remedy: "name the variable (capitals, digits, `_`) that holds the key, never the key itself",
            });
        }
        Ok(Self(text.to_owned()))
    }
}

impl TryFrom<String> for Variable {
    type Error = Invalid;

    fn try_from(text: String) -> Result<Self, Invalid> {
        text.parse()
    }
}

impl From<Variable> for String {
    fn from(variable: Variable) -> Self {
        variable.0
    }
}
