//! Rounds of annotation: what is asked of whom, what was answered, what follows from it.
//!
//! A round is a folder of files. An annotator's process reads what is asked ([`Round`]) and writes one append-only
//! log of its own ([`Ballot`]); it never opens the key, another log, or a verdict. Afterwards [`JudgedRound`] reads all logs
//! and compares them with the [`Key`], and [`measure`] says how much people agreed before anything was thrown out.
//!
//! This crate decides nothing about pictures, keys on a keyboard or terminals, and it changes no query.
//! Everything but [`Ballot`] is a pure function of files that it is given.

mod agreement;
mod ballot;
mod control;
mod draw;
#[cfg(test)]
mod fixture;
mod history;
mod item;
pub mod judged;
pub mod key;
mod line;
mod order;
mod replay;
mod responses;
mod round;
mod round_dir;
mod scene;
mod verdict;
mod vote;

pub use agreement::measure;
pub use ballot::Ballot;
pub use draw::draw_round;
pub use item::{Item, ItemId, ItemIdError};
pub use judged::{Evidence, JudgedRound};
pub use key::Key;
pub use line::Source;
pub use round::{Gold, Round, RoundSettings, SCHEMA};
pub use round_dir::RoundDir;
pub use verdict::{ItemVerdict, Outcome};
pub use vote::{Answer, Choice, Event, Response, ShownFrames};
