//! Recording and replaying: what a server said, kept in a folder, stands in for the server.

use std::path::Path;
use std::time::Duration;

use l4d_data::json;

use crate::call::{Call, Response};
use crate::config::Endpoint;
use crate::error::EndpointError;
use crate::store::Exchanges;
use crate::transport::Transport;

const ENDPOINT_FILE: &str = "endpoint.json";

/// Keeps everything that another transport brings back.
#[derive(Debug)]
pub(crate) struct Recorder<T> {
    inner: T,
    exchanges: Exchanges,
}

impl<T: Transport> Recorder<T> {
    /// Notes in the folder whom the recording is of; never how its keys are called.
    pub(crate) fn new(inner: T, folder: &Path, endpoint: &Endpoint) -> Result<Self, EndpointError> {
        let mut endpoint = endpoint.clone();
        endpoint.api_key_env = None;
        endpoint.header_env.clear();
        json::write(&folder.join(ENDPOINT_FILE), &endpoint)?;
        Ok(Self { inner, exchanges: Exchanges::new(folder) })
    }
}

impl<T: Transport> Transport for Recorder<T> {
    fn send(&self, call: &Call, patience: Duration) -> Result<Response, EndpointError> {
        let response = self.inner.send(call, patience)?;
        let kept = self.exchanges.read(call).ok().flatten();
        // A server's bad day must not spoil what it said before.
        if response.is_success() || !kept.is_some_and(|kept| kept.is_success()) {
            self.exchanges.write(call, &response)?;
        }
        Ok(response)
    }
}

/// Answers from a recording alone.
#[derive(Debug)]
pub(crate) struct Replay {
    exchanges: Exchanges,
}

impl Replay {
    pub(crate) fn new(folder: &Path) -> Self {
        Self { exchanges: Exchanges::new(folder) }
    }
}

impl Transport for Replay {
    fn send(&self, call: &Call, _patience: Duration) -> Result<Response, EndpointError> {
        self.exchanges.read(call)?.ok_or_else(|| EndpointError::NotRecorded {
            folder: self.exchanges.folder().to_owned(),
            digest: call.digest.clone(),
        })
    }
}

impl Endpoint {
    /// The endpoint that a recording was made of.
    pub fn recorded(folder: &Path) -> Result<Self, EndpointError> {
        let path = folder.join(ENDPOINT_FILE);
        let endpoint: Self = json::read(&path)?;
        endpoint.check(&path.display().to_string())?;
        Ok(endpoint)
    }
}
