//! The network: one HTTP exchange with bounds on time and size, the key in its header, no redirect followed.

use std::fmt;
use std::io::ErrorKind;
use std::time::Duration;

use ureq::http::{HeaderName, HeaderValue, Request, Response};
use ureq::{Agent, AsSendBody, Body};

use crate::config::Endpoint;
use crate::error::{EndpointError, Failure};
use crate::exchange::{self, Call};
use crate::secret::{Environment, Redactor, Secret};

const LONGEST_CONNECTING: Duration = Duration::from_secs(10);
/// No answer of a model is longer.
const MAX_RESPONSE_BYTES: u64 = 8 << 20;

/// A server behind a URL.
pub(crate) struct Http {
    agent: Agent,
    headers: Vec<(HeaderName, HeaderValue)>,
    redactor: Redactor,
}

impl Http {
    /// Reads the keys that the endpoint names from the environment.
    pub(crate) fn open(endpoint: &Endpoint, environment: Environment<'_>) -> Result<Self, EndpointError> {
        let key = endpoint.api_key_env.iter().map(|variable| ("authorization", "Bearer ", variable));
        let others = endpoint.header_env.iter().map(|(name, variable)| (name.as_str(), "", variable));
        let mut secrets = Vec::new();
        let mut headers = Vec::new();
        for (name, prefix, variable) in key.chain(others) {
            let secret = Secret::read(variable, environment)?;
            headers.push(header(name, &format!("{prefix}{}", secret.expose()))?);
            secrets.push(secret);
        }
        if !secrets.is_empty() && endpoint.base_url.exposes_keys() {
            tracing::warn!("keys cross the network in the clear: use https, or a tunnel to localhost");
        }
        let mut config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            // A server that ends an idle connection makes the next question on it fail, and questions take so long
            // that a new connection for each costs nothing.
            .max_idle_connections(0)
            .timeout_connect(Some(LONGEST_CONNECTING))
            .user_agent(concat!("l4d/", env!("CARGO_PKG_VERSION")));
        if endpoint.base_url.is_local() {
            // A proxy of the environment would look for this machine's servers on its own.
            config = config.proxy(None);
        }
        Ok(Self { agent: config.build().new_agent(), headers, redactor: Redactor::new(&secrets) })
    }

    /// Sends once and waits for no longer than `timeout`.
    pub(crate) fn send(&self, call: &Call, timeout: Duration) -> Result<exchange::Response, Failure> {
        self.exchange(call, timeout).map_err(|error| self.failure(call, &error))
    }

    fn exchange(&self, call: &Call, timeout: Duration) -> Result<exchange::Response, ureq::Error> {
        let mut request = Request::builder().uri(&call.url);
        for (name, value) in &self.headers {
            request = request.header(name, value);
        }
        let mut response = match &call.body {
            Some(body) => {
                let request = request.method("POST").header("content-type", "application/json");
                self.run(request.body(body.as_slice())?, timeout)?
            }
            None => self.run(request.body(())?, timeout)?,
        };
        // What a server says of an error may hold the key in any encoding: it is not even read.
        let body = match response.status().is_success() {
            true => response.body_mut().with_config().limit(MAX_RESPONSE_BYTES).read_to_vec()?,
            false => Vec::new(),
        };
        let header = |name: &&str| {
            let value = response.headers().get(*name)?.to_str().ok()?;
            Some(((*name).to_owned(), self.redactor.text(value)))
        };
        Ok(exchange::Response {
            status: response.status().as_u16(),
            headers: exchange::Response::HEADERS.iter().filter_map(header).collect(),
            body: self.redactor.body(&String::from_utf8_lossy(&body)),
        })
    }

    fn run(
        &self,
        request: Request<impl AsSendBody>,
        timeout: Duration,
    ) -> Result<Response<Body>, ureq::Error> {
        self.agent.run(self.agent.configure_request(request).timeout_global(Some(timeout)).build())
    }

    fn failure(&self, call: &Call, error: &ureq::Error) -> Failure {
        use ureq::Error;
        let lasting = |hint| Failure::lasting(&call.url, self.redactor.text(&error.to_string()), hint);
        let unreachable = || Failure {
            is_passing: true,
            ..lasting("start the server, or check host and port in `base_url`")
        };
        let interrupted = |hint| Failure { is_passing: true, may_have_cost: true, ..lasting(hint) };
        let timeout =
            || interrupted("give the server more time under [timeouts], send less, or see why it is slow");
        let reset = || interrupted("see the server's own log: it ended the connection before the answer did");
        match error {
            Error::BodyExceedsLimit(limit) => Failure {
                message: format!("the answer is larger than {limit} bytes"),
                may_have_cost: true,
                ..lasting("check that `base_url` is a model server, and ask for less")
            },
            Error::Protocol(_) | Error::Http(_) | Error::LargeResponseHeader(..) => {
                let failure = lasting("check `base_url`: it is not that of a model server");
                Failure { message: format!("the answer is not HTTP: {}", failure.message), ..failure }
            }
            Error::Timeout(_) => timeout(),
            Error::HostNotFound => lasting("check the host in `base_url`, and the network"),
            Error::ConnectionFailed => unreachable(),
            Error::BodyStalled => reset(),
            Error::Tls(_) | Error::Rustls(_) => {
                lasting("check the certificate of the server, or whether it speaks plain http")
            }
            Error::Io(error) => match error.kind() {
                ErrorKind::ConnectionRefused | ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => {
                    unreachable()
                }
                ErrorKind::TimedOut | ErrorKind::WouldBlock => timeout(),
                ErrorKind::ConnectionReset
                | ErrorKind::ConnectionAborted
                | ErrorKind::BrokenPipe
                | ErrorKind::UnexpectedEof
                | ErrorKind::NotConnected => reset(),
                _ => lasting("check `base_url` and the network"),
            },
            _ => lasting("check `base_url` and the network"),
        }
    }
}

impl fmt::Debug for Http {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&HeaderName> = self.headers.iter().map(|(name, _)| name).collect();
        formatter.debug_struct("Http").field("headers", &names).finish_non_exhaustive()
    }
}

/// A header with a secret value.
fn header(name: &str, value: &str) -> Result<(HeaderName, HeaderValue), EndpointError> {
    let unusable = |message: &str| {
        EndpointError::not_asked(format!("header {name}"), message, "use an ASCII name and value")
    };
    let mut value =
        HeaderValue::from_str(value).map_err(|_bad| unusable("has a value that HTTP does not allow"))?;
    value.set_sensitive(true);
    let name = name.parse().map_err(|_bad| unusable("has a name that HTTP does not allow"))?;
    Ok((name, value))
}
