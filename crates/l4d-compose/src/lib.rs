//! Sets of composed scenes (docs/compose.md): draws until a scene has queries that are proved, chosen so that no shortcut
//! finds the referents, and said.
//!
//! Owns what is asked of a seed, which predicates are tried, which of the proved ones make a set, and what is refused.
//! Refuses to know how scenes are drawn and rendered (`l4d-blender` runs workers), what a clause means (`l4d-query` judges
//! every candidate), and how English works (`l4d-english`).

mod atoms;
mod candidate;
mod choose;
mod compose;
mod enumerate;
mod facts;
mod ledger;
mod parties;
mod screen;
mod sentence;
pub mod set;
pub mod wish;

pub use candidate::Candidate;
pub use compose::{Composed, LEAST_QUERIES, QueriesRequest, Refused, Say, queries, write};
pub use enumerate::enumerate;
