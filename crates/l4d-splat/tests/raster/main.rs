//! Rasterizers from outside: against the reference, against themselves, against other programs.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]
#![expect(clippy::print_stdout, reason = "tables of errors, for `--nocapture`")]

mod conformance;
mod determinism;
mod hostile;
mod marked;
mod parity;
