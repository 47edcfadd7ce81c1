//! Grounders: a sentence and what one camera shows in, one mask per frame out (paper, section 4, "Multi-View Semantic
//! Grounder").
//!
//! This crate owns the contract ([`Grounder`]) and everything that keeps it. A grounder sees one view at a time and
//! knows nothing of the others: whether views agree is for `l4d-solve` to say. How clips were drawn, what becomes of
//! masks, and how they are judged is not known here.

pub mod clip;
pub mod files;
pub mod grounder;
mod grounder_file;
pub mod oracle;
pub mod panoptic;
mod plan;
mod remembered;
#[cfg(test)]
mod testing;
mod unreadable;
pub mod vlm;
pub mod worker;

pub use clip::{ClipFrame, ViewClip};
pub use grounder::{Choice, Grounder, Grounding, Outcome, Question, RunnerUp};
pub use grounder_file::GrounderFile;
pub use unreadable::{Reason, Unreadable};
