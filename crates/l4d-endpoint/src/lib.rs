//! Client of model servers that speak the OpenAI protocol (or Ollama's own).
//!
//! This crate owns how a question reaches a model and how its answer comes back whole: which fields a server
//! takes, retries, cache, recordings, budget, keys, and where a convention of coordinates puts a box. It refuses
//! to know what is asked and what an answer means.
//!
//! A key comes from an environment variable and leaves this process in a request header alone. The HTTP library
//! underneath logs raw bytes through the `log` facade at its finest level: a program that installs a logger for
//! that facade must keep `ureq` and `ureq_proto` out of it.

pub mod address;
mod breaker;
pub mod budget;
pub mod calibration;
pub mod call;
pub mod client;
pub mod config;
pub mod coordinates;
mod dialect;
pub mod error;
mod extract;
mod http;
mod learned;
pub mod message;
pub mod probe;
mod replay;
pub mod reply;
pub mod request;
mod retry;
pub mod secret;
pub mod server;
mod store;
pub mod transport;

pub use address::{BaseUrl, Variable};
pub use budget::{Budget, Plan, Prices, Spent, Tokens};
pub use calibration::Calibrations;
pub use call::{Call, Response};
pub use client::{CacheUse, Client, Link};
pub use config::Endpoint;
pub use coordinates::{BoxPx, Convention};
pub use error::{EndpointError, Kind};
pub use message::{Image, Message, Part, Role};
pub use reply::{Finish, Origin, Reply, Usage};
pub use request::{Request, Schema};
pub use server::Server;
pub use transport::Transport;
