//! Freezing a version of the benchmark, and the forms in which platforms host it.
//!
//! A release is a folder that stands alone: archives by scene, tables that need no archive, metadata, checksums. It is
//! a function of the benchmark, the renders, the votes and the arguments, byte for byte.
//! The crate refuses to know how scores or frames come about: it carries files, counts what they say, and is told what
//! people's votes say ([`votes::Votes`]) and which scores methods have ([`host::Entry`]).

pub mod archive;
pub mod codes;
pub mod contents;
mod croissant;
pub mod day;
mod documents;
pub mod freeze;
pub mod gather;
pub mod host;
pub mod inspect;
pub mod renders;
mod tables;
pub mod version;
pub mod votes;
mod words;

pub use contents::Contents;
pub use day::Day;
pub use freeze::{Order, Plan, Released, examine, freeze, plan};
pub use inspect::inspect;
pub use votes::Votes;
