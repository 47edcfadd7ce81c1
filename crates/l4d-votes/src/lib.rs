//! Rounds of annotation: what is asked of whom, what was answered, what follows from it.
//!
//! A round is a folder of files. An annotator's process reads what is asked ([`Round`]) and writes one append-only
//! log of its own ([`Ballot`]); it never opens the key, another log, or a verdict. Afterwards [`sheet`] reads all
//! logs, [`verdict`] compares them with the [`Key`] and [`agreement`] says how much people agreed before anything
//! was thrown out.
//!
//! This crate decides nothing about pictures, keys on a keyboard or terminals, and it changes no query.
//! Everything but [`Ballot`] is a pure function of files that it is given.

pub mod agreement;
pub mod ballot;
mod cast;
pub mod codes;
pub mod control;
pub mod event;
#[cfg(test)]
mod fixture;
pub mod item;
mod journal;
pub mod key;
mod ledger;
mod line;
pub mod make;
mod order;
pub mod record;
mod replay;
pub mod round;
pub mod rule;
pub mod sheet;
pub mod verdict;

pub use ballot::{Ballot, Notice};
pub use event::{Answer, Choice, Event, Seen};
pub use item::{Item, ItemId};
pub use key::Key;
pub use round::{Round, RoundDir};
pub use rule::{FrameRule, Rule};
pub use sheet::{Sheet, Standing};
