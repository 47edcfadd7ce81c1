//! Where answers come from: a server, a server that is recorded, or a recording.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use l4d_data::json;

use crate::config::Endpoint;
use crate::error::EndpointError;
use crate::exchange::{Call, Exchanges, Response};
use crate::http::Http;
use crate::secret::Environment;

const ENDPOINT_FILE: &str = "endpoint.json";

/// Where answers come from: `live`, `record:<folder>` or `replay:<folder>`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Link {
    /// The server.
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

/// An open [`Link`].
#[derive(Debug)]
pub(crate) enum Transport {
    Live(Http),
    Record(Http, Exchanges),
    Replay(Exchanges),
}

impl Transport {
    pub(crate) fn open(
        endpoint: &Endpoint,
        link: &Link,
        environment: Environment<'_>,
    ) -> Result<Self, EndpointError> {
        Ok(match link {
            Link::Live => Self::Live(Http::open(endpoint, environment)?),
            Link::Record(folder) => {
                let http = Http::open(endpoint, environment)?;
                // Names of variables that hold keys are of no use to readers of a recording.
                let mut endpoint = endpoint.clone();
                endpoint.api_key_env = None;
                endpoint.header_env.clear();
                json::write(&folder.join(ENDPOINT_FILE), &endpoint)?;
                Self::Record(http, Exchanges::new(folder))
            }
            Link::Replay(folder) => Self::Replay(Exchanges::new(folder)),
        })
    }

    /// Sends once and waits for no longer than `patience`; any status is a response.
    pub(crate) fn send(&self, call: &Call, patience: Duration) -> Result<Response, EndpointError> {
        match self {
            Self::Live(http) => Ok(http.send(call, patience)?),
            Self::Record(http, exchanges) => {
                let response = http.send(call, patience)?;
                let kept = exchanges.read(call).ok().flatten();
                // A failure of the server does not replace what it said before.
                if response.is_success() || !kept.is_some_and(|kept| kept.is_success()) {
                    exchanges.write(call, &response)?;
                }
                Ok(response)
            }
            Self::Replay(exchanges) => exchanges.read(call)?.ok_or_else(|| {
                EndpointError::not_asked(
                    exchanges.folder.display().to_string(),
                    format!("holds no answer to question {}", call.digest),
                    "the question differs from the recorded one (pictures, text, model, settings): record it with \
                     record:<folder>",
                )
            }),
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
}
