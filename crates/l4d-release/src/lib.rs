//! Freezing a version of the benchmark, and the forms in which platforms host it.
//!
//! A release is a self-contained folder: archives by scene, tables, metadata, checksums; that of a private test is two,
//! one that the organiser keeps and one without answers. It is a function of the
//! benchmark, the renders, the votes and the arguments, byte for byte.
//! It goes the other way too: what is asked of a release comes back into the folders of the verbs ([`download`]).
//! It carries files and counts what they say; the caller says what votes ([`votes::Votes`]) and scores
//! ([`host::Entry`]) there are.

pub mod archive;
pub mod codes;
mod columnar;
pub mod contents;
mod croissant;
pub mod day;
mod documents;
pub mod download;
pub mod freeze;
pub mod gather;
pub mod host;
pub mod inspect;
pub mod participants;
mod parts;
pub mod renders;
pub mod shards;
mod splats;
mod tables;
pub mod version;
pub mod votes;
mod words;

pub use contents::Contents;
pub use day::Day;
pub use freeze::{Pictures, Plan, ReleaseOptions, Released, examine, freeze, plan};
pub use inspect::inspect;
pub use votes::Votes;
