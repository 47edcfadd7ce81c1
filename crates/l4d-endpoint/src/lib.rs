//! Client of model servers that speak the OpenAI protocol: profiles, retries, cache, recordings, budget, keys, and
//! the coordinate conventions in which models write boxes. It knows nothing of what is asked.
//!
//! A key comes from an environment variable and leaves this process in a request header alone. The HTTP library
//! logs raw bytes through the `log` facade at its finest level: a program that installs a logger for that facade
//! must keep `ureq` and `ureq_proto` out of it.

mod base_url;
mod budget;
pub mod calibration;
mod client;
mod config;
pub mod coordinates;
mod error;
mod exchange;
mod extract;
mod http;
mod message;
mod openai;
pub mod probe;
mod reply;
mod request;
mod retry;
mod secret;
mod transport;

pub use base_url::BaseUrl;
pub use budget::{Budget, Plan, Prices, Spent, Tokens};
pub use calibration::Calibrations;
pub use client::{CacheUse, Client};
pub use config::Endpoint;
pub use coordinates::{BoxPx, Convention};
pub use error::{EndpointError, Failure};
pub use message::{Image, Message, Part, Role};
pub use reply::{Finish, Origin, Reply, Usage};
pub use request::{Request, Schema};
pub use transport::Link;
