//! Queries and scenarios that models propose, and the checks between them and the benchmark.
//!
//! This crate owns what a model is asked, how its answer is read, and which proposals are worth a person's time. It
//! refuses to know how a question reaches a model (`l4d-endpoint`), what a predicate means (`l4d-query`) and how a
//! picture is drawn (`l4d-frames`). Nothing that it writes is part of the benchmark: people carry it there.

mod answer;
pub mod queries;
mod quote;
pub mod scenarios;

pub use answer::{AskOptions, Asked};
