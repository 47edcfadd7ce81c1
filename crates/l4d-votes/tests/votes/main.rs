//! The crate from outside: through the files of a round.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod coefficients;
mod kill;
mod reference;
mod speed;
mod support;
