//! The predicate language of queries, its evaluation over tracks, and the proof that each query has one answer.
//!
//! Owns what a predicate means. Refuses to know pictures: everything is decided from `benchmark/scenes`, and
//! visibility from the counts in `benchmark/truth`.

pub mod ast;
pub mod eval;
#[cfg(test)]
mod fixture;
mod nouns;
mod obb;
pub mod overlap;
pub mod probes;
pub mod prove;
mod reading;
pub mod relations;
pub mod soft;
pub mod stats;
pub mod summary;
mod text;
pub mod thresholds;
pub mod times;
pub mod verbs;
pub mod world;

pub use ast::{Clause, Party, Predicate, Relation, Superlative};
pub use prove::check_set;
pub use summary::SetSummary;
pub use thresholds::Slack;
pub use times::Times;
pub use world::World;
