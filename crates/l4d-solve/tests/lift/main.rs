//! Lifting on made-up rooms, whose true labels are known.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod answers;
mod disk;
mod fixture;
mod hazards;
mod methods;
mod threads;
