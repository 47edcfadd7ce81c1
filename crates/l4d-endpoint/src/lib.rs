//! Client of model servers that speak the OpenAI protocol: profiles, retries, cache, recordings, budget, keys, and
//! the coordinate conventions in which models write boxes. It knows nothing of what is asked. Beside them, files behind an
//! address, for downloads.
//!
//! A key comes from an environment variable and leaves this process in a request header alone. The HTTP library
//! logs raw bytes through the `log` facade at its finest level: a program that installs a logger for that facade
//! must keep `ureq` and `ureq_proto` out of it.

mod budget;
mod client;
mod config;
pub mod coordinates;
mod error;
mod exchange;
mod files;
mod http;
mod openai;
mod reply;
mod request;
mod retry;
mod secret;

pub use budget::{Budget, Plan, Prices, Spent, Tokens};
pub use client::{CacheUse, Client};
pub use config::{BaseUrl, Endpoint};
pub use coordinates::{BoxPx, Convention};
pub use error::{EndpointError, Failure, one_line};
pub use exchange::Link;
pub use files::{Arriving, FileError, Files};
pub use reply::{Finish, Origin, Reply, Usage, documents};
pub use request::{Image, Message, Part, Request, Schema};
