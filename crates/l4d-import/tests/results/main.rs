//! Foreign results in: the arithmetic against the originals', and whole folders from disk to a score.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on must say where")]

mod bench;
mod folders;
mod hostile;
mod reference;
mod relevancy;
mod troubles;
