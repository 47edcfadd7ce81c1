//! The client against a scripted server.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod asking;
mod common;
mod failures;
mod keeping;
mod keys;
#[path = "../scripted/mod.rs"]
mod scripted;
