//! Files behind an address, from any byte on: what a download goes on with.

use std::fmt;
use std::io::Read;
use std::time::Duration;

use ureq::Agent;
use ureq::http::StatusCode;

use crate::config::BaseUrl;

const LONGEST_CONNECTING: Duration = Duration::from_secs(10);
const LONGEST_WAITING: Duration = Duration::from_secs(60);
/// A file that takes longer ends with an error, and the next request goes on where it ended.
const LONGEST_FILE: Duration = Duration::from_secs(3600);
/// Hosts of data sets hand requests on to where the bytes are.
const MOST_REDIRECTS: u32 = 5;

/// A server of files.
pub struct Files {
    agent: Agent,
    base: BaseUrl,
}

/// The bytes of a file as they arrive.
pub struct Arriving {
    /// Which byte is the first: the one that was asked for, or 0 from a server that knows no ranges.
    pub first: u64,
    /// The bytes.
    pub reader: Box<dyn Read>,
}

/// Why a file does not arrive.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{url}: {message}")]
pub struct FileError {
    url: String,
    message: String,
    /// Whether to ask again may help.
    pub is_passing: bool,
}

impl FileError {
    /// Why, without the address.
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl Files {
    /// Files below an address.
    pub fn below(base: &BaseUrl) -> Self {
        let mut config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(MOST_REDIRECTS)
            .timeout_connect(Some(LONGEST_CONNECTING))
            .timeout_recv_response(Some(LONGEST_WAITING))
            .timeout_recv_body(Some(LONGEST_FILE))
            .user_agent(concat!("l4d/", env!("CARGO_PKG_VERSION")));
        if base.is_local() {
            // A proxy of the environment would look for this machine's servers on its own.
            config = config.proxy(None);
        }
        Self { agent: config.build().new_agent(), base: base.clone() }
    }

    /// The address of a file.
    pub fn url(&self, file: &str) -> String {
        format!("{}/{file}", self.base)
    }

    /// Asks for a file from a byte on.
    ///
    /// # Errors
    /// If the server cannot be reached or has no such file.
    pub fn read(&self, file: &str, from: u64) -> Result<Arriving, FileError> {
        let url = self.url(file);
        let fail = |message: String, is_passing| FileError { url: url.clone(), message, is_passing };
        let mut request = self.agent.get(&url);
        if from > 0 {
            request = request.header("range", format!("bytes={from}-"));
        }
        let response = request.call().map_err(|error| fail(error.to_string(), true))?;
        let status = response.status();
        // What is here already may be longer than what is there: then it is something else.
        if status == StatusCode::RANGE_NOT_SATISFIABLE && from > 0 {
            return self.read(file, 0);
        }
        if !status.is_success() {
            let is_passing = status.is_server_error() || status == StatusCode::TOO_MANY_REQUESTS;
            return Err(fail(format!("the server answers {status}"), is_passing));
        }
        let first = if status == StatusCode::PARTIAL_CONTENT { from } else { 0 };
        Ok(Arriving { first, reader: Box::new(response.into_body().into_reader()) })
    }
}

impl fmt::Debug for Files {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Files").field("base", &self.base).finish_non_exhaustive()
    }
}

impl fmt::Debug for Arriving {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Arriving").field("first", &self.first).finish_non_exhaustive()
    }
}
