//! One scene that is asked from a browser: a page, sentences in, answers out as they come about.
//!
//! Owns the HTTP interface, who may use it, and the queue of questions, which are answered one after the other. Refuses
//! to know what a page shows and how a sentence is answered: both are given.
//!
//! | request | answer |
//! |---|---|
//! | `GET /` | the page |
//! | `POST /questions` `{"text": "..."}` | 202 and `{"id": 1}`; 422 with `message` and `hint`; 429 while too many wait |
//! | `GET /questions/1` | `{"state": "waiting", "ahead": 2}`, `{"state": "running", "stage": "grounding", "done": 3, "total": 8}`, `{"state": "answered", "answer": ...}` or `{"state": "failed", "message": "...", "hint": "..."}` |
//!
//! Only pages of this server may ask: a request names this address as its host and, if it has one, as its origin, so
//! that pages of others cannot reach it from the browser of the same person, whatever names they give to this machine.

mod desk;
mod site;

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::thread;

use l4d_data::{Progress, StageError};
use serde_json::Value;

use self::desk::Desk;

/// Answers a sentence: a JSON document for the page.
pub type Answerer = dyn Fn(&str, &dyn Progress) -> Result<Value, StageError> + Send + Sync;

/// Why nothing can be served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// Another program has the port, or it needs rights.
    #[error("port {port} of this machine cannot be used: {error}")]
    Port {
        /// That was asked for.
        port: u16,
        /// What the system says.
        error: std::io::Error,
    },
    /// The server stopped.
    #[error("the server stopped: {0}")]
    Stopped(std::io::Error),
}

/// Serves a page and answers questions until the process ends, on the loopback interface alone. `port` 0 takes a free
/// one; `ready` hears which.
///
/// # Errors
/// A port that cannot be used, and whatever ends the server.
pub fn serve(
    page: Vec<u8>,
    answerer: Box<Answerer>,
    port: u16,
    ready: impl FnOnce(SocketAddr),
) -> Result<(), ServeError> {
    let desk = Arc::new(Desk::default());
    let worker = Arc::clone(&desk);
    thread::spawn(move || worker.work(answerer.as_ref()));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build();
    runtime.map_err(ServeError::Stopped)?.block_on(async {
        let unusable = |error| ServeError::Port { port, error };
        let listener = tokio::net::TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await.map_err(unusable)?;
        let address = listener.local_addr().map_err(unusable)?;
        ready(address);
        axum::serve(listener, site::of(page, desk, address)).await.map_err(ServeError::Stopped)
    })
}

#[cfg(test)]
mod tests;
