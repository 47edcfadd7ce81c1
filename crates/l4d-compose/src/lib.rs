//! Queries of composed scenes: enumerated from tracks, proved, chosen so that no shortcut finds the referents, said.
//!
//! Owns which predicates are tried, which of the proved ones make a set, and what is refused. Refuses to know how scenes
//! are composed or rendered, what a clause means (`l4d-query` judges every candidate), and how English works: sentences
//! come from a function.

mod atoms;
mod candidate;
mod choose;
mod compose;
mod enumerate;
mod facts;
mod parties;
mod screen;
mod sentence;

pub use candidate::Candidate;
pub use compose::{Composed, LEAST_QUERIES, Order, Refused, Say, queries, write};
pub use enumerate::enumerate;
