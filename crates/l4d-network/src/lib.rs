//! The trained network: display colour of one picture in, things out, each with its pixels, what it may be called and
//! what it looks like.
//!
//! Owns the weights and how they are run. Refuses to know sentences, time and depth. `training/` has how the network
//! learned; the weights say what they were trained on.

mod pool;
mod resize;
mod run;
mod segment;
#[cfg(test)]
mod tests;
mod weights;

pub use run::{Found, Network, Picture, Seen};
pub use weights::{Description, WeightsError};
