//! Rounds of annotation: what is asked of whom, what was answered, what follows from it.
//!
//! A round is a folder of files. An annotator's process reads what is asked ([`Round`]) and writes one append-only
//! log of its own ([`Ballot`]); it never opens the key, another log, or a verdict. Afterwards [`read_responses`] reads
//! all logs, [`verdict`] compares them with the [`Key`] and [`agreement`] says how much people agreed before anything
//! was thrown out.
//!
//! This crate decides nothing about pictures, keys on a keyboard or terminals, and it changes no query.
//! Everything but [`Ballot`] is a pure function of files that it is given.

pub mod agreement;
mod ballot;
pub mod codes;
pub mod control;
pub mod draw;
pub mod files;
#[cfg(test)]
mod fixture;
mod history;
mod item;
pub mod judged;
pub mod key;
mod line;
mod log_file;
mod order;
mod replay;
mod responses;
pub mod round;
mod round_dir;
mod rule;
mod scene;
#[cfg(test)]
mod tests;
pub mod verdict;
mod vote;

pub use ballot::Ballot;
pub use item::{Item, ItemId, ItemIdError};
pub use judged::{Evidence, Judged};
pub use key::Key;
pub use responses::{Responses, read_responses};
pub use round::Round;
pub use round_dir::RoundDir;
pub use rule::{FrameRule, Rule, RuleError};
pub use vote::{Answer, Choice, Event, Response, ShownFrames};
