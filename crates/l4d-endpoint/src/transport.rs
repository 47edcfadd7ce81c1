//! The seam between questions and the network: real, recorded, replayed, or a test's own.

use std::fmt::Debug;
use std::time::Duration;

use crate::call::{Call, Response};
use crate::error::EndpointError;

/// Carries one call and brings back one response, whatever its status. Tries once: patience lives elsewhere.
pub trait Transport: Debug + Send + Sync {
    /// Sends and waits, for no longer than `patience`.
    fn send(&self, call: &Call, patience: Duration) -> Result<Response, EndpointError>;
}
