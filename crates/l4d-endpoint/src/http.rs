//! The network: one HTTP exchange with bounds on time and size, the key in its header, no redirect followed.

use std::fmt;
use std::io;
use std::time::Duration;

use ureq::Agent;
use ureq::http::{HeaderName, HeaderValue};

use crate::call::{Call, Response};
use crate::config::Endpoint;
use crate::error::{EndpointError, Fault};
use crate::secret::{Environment, Redactor, Secret};
use crate::transport::Transport;

/// A server behind a URL.
pub(crate) struct Http {
    agent: Agent,
    headers: Vec<(HeaderName, HeaderValue)>,
    redactor: Redactor,
    response_bytes: u64,
}

impl Http {
    /// Reads the keys that the endpoint names from the environment.
    pub(crate) fn open(endpoint: &Endpoint, environment: Environment<'_>) -> Result<Self, EndpointError> {
        let key =
            endpoint.api_key_env.as_ref().map(|name| Secret::read(name.as_str(), environment)).transpose()?;
        let mut secrets = Vec::new();
        let mut headers = Vec::new();
        if let Some(key) = key {
            headers.push(secret_header("authorization", &format!("Bearer {}", key.expose()))?);
            secrets.push(key);
        }
        for (name, variable) in &endpoint.header_env {
            let secret = Secret::read(variable.as_str(), environment)?;
            headers.push(secret_header(name, secret.expose())?);
            secrets.push(secret);
        }
        for (name, value) in &endpoint.headers {
            headers.push(header(name, value)?);
        }
        let mut config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            // A server that ends an idle connection makes the next question on it fail, and questions take so long
            // that a new connection for each costs nothing.
            .max_idle_connections(0)
            .timeout_connect(Some(Duration::from_secs_f64(endpoint.timeouts.connect_seconds)))
            .user_agent(concat!("l4d/", env!("CARGO_PKG_VERSION")));
        if endpoint.base_url.is_local() {
            // A proxy of the environment would look for this machine's servers on its own.
            config = config.proxy(None);
        }
        Ok(Self {
            agent: config.build().new_agent(),
            headers,
            redactor: Redactor::new(&secrets),
            response_bytes: endpoint.limits.response_bytes,
        })
    }

    fn exchange(&self, call: &Call, patience: Duration) -> Result<Response, ureq::Error> {
        let mut response = match &call.body {
            Some(body) => {
                let mut request = self.agent.post(&call.url).header("content-type", "application/json");
                for (name, value) in &self.headers {
                    request = request.header(name, value);
                }
                request.config().timeout_global(Some(patience)).build().send(body)?
            }
            None => {
                let mut request = self.agent.get(&call.url);
                for (name, value) in &self.headers {
                    request = request.header(name, value);
                }
                request.config().timeout_global(Some(patience)).build().call()?
            }
        };
        let body = response.body_mut().with_config().limit(self.response_bytes).read_to_vec()?;
        let header = |name: &&str| {
            let value = response.headers().get(*name)?.to_str().ok()?;
            Some(((*name).to_owned(), self.redactor.text(value)))
        };
        Ok(Response {
            status: response.status().as_u16(),
            headers: Response::HEADERS.iter().filter_map(header).collect(),
            body: self.redactor.body(&String::from_utf8_lossy(&body)),
        })
    }

    fn translate(&self, call: &Call, error: ureq::Error) -> EndpointError {
        let url = call.url.clone();
        let message = self.redactor.text(&error.to_string());
        let fault = match &error {
            ureq::Error::BodyExceedsLimit(_) => {
                return EndpointError::AnswerTooLarge { url, limit_bytes: self.response_bytes };
            }
            ureq::Error::Protocol(_) | ureq::Error::Http(_) | ureq::Error::LargeResponseHeader(..) => {
                return EndpointError::Protocol {
                    url,
                    message: "it is not HTTP".to_owned(),
                    excerpt: message,
                };
            }
            ureq::Error::Timeout(_) => Fault::Timeout,
            ureq::Error::HostNotFound => Fault::UnknownHost,
            ureq::Error::ConnectionFailed => Fault::NoConnection,
            ureq::Error::BodyStalled => Fault::Reset,
            ureq::Error::Tls(_) | ureq::Error::Rustls(_) => Fault::Tls,
            ureq::Error::Io(error) => fault_of(error.kind()),
            _ => Fault::Other,
        };
        EndpointError::Transport { url, fault, message }
    }
}

impl Transport for Http {
    fn send(&self, call: &Call, patience: Duration) -> Result<Response, EndpointError> {
        self.exchange(call, patience).map_err(|error| self.translate(call, error))
    }
}

impl fmt::Debug for Http {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&HeaderName> = self.headers.iter().map(|(name, _)| name).collect();
        formatter.debug_struct("Http").field("headers", &names).finish_non_exhaustive()
    }
}

fn fault_of(kind: io::ErrorKind) -> Fault {
    use io::ErrorKind;
    match kind {
        ErrorKind::ConnectionRefused | ErrorKind::HostUnreachable | ErrorKind::NetworkUnreachable => {
            Fault::NoConnection
        }
        ErrorKind::TimedOut | ErrorKind::WouldBlock => Fault::Timeout,
        ErrorKind::ConnectionReset
        | ErrorKind::ConnectionAborted
        | ErrorKind::BrokenPipe
        | ErrorKind::UnexpectedEof
        | ErrorKind::NotConnected => Fault::Reset,
        _ => Fault::Other,
    }
}

fn header(name: &str, value: &str) -> Result<(HeaderName, HeaderValue), EndpointError> {
    let unusable = |message: &str| EndpointError::Config {
        place: format!("header {name}"),
        message: message.to_owned(),
        remedy: "use an ASCII name and value".to_owned(),
    };
    let value =
        HeaderValue::from_str(value).map_err(|_bad| unusable("has a value that HTTP does not allow"))?;
    let name: HeaderName = name.parse().map_err(|_bad| unusable("has a name that HTTP does not allow"))?;
    Ok((name, value))
}

fn secret_header(name: &str, value: &str) -> Result<(HeaderName, HeaderValue), EndpointError> {
    let (name, mut value) = header(name, value)?;
    value.set_sensitive(true);
    Ok((name, value))
}
