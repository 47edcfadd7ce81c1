//! What a query means, and the proof that it means exactly one thing.
//!
//! A predicate is a small tree of clauses ([`ast`]), evaluated over the tracks of a scene ([`world`], [`eval`]).
//! [`prove`] compares answer sets with what the query claims. The crate knows nothing of pictures, votes or
//! results; visibility comes in as numbers from the truth file.

pub mod ast;
pub mod eval;
pub mod prove;
pub mod world;

pub use ast::{Clause, Predicate};
pub use prove::{SetSummary, check_set};
