//! The deformation field and the optimiser against independent computations.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod differences;
mod fixtures;
mod hazards;
mod optimise;
mod parity;
mod reference;
mod threads;
