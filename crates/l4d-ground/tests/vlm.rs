//! Grounding by models that are asked: replies of every shape, and the whole way from question to masks with a server
//! that says what a test tells it to.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

#[path = "vlm/chain.rs"]
mod chain;
mod clips;
#[path = "vlm/replies.rs"]
mod replies;
#[path = "vlm/server.rs"]
mod server;
