//! Lifting on made-up rooms, whose true labels are known.

mod answers;
mod fixture;
mod hazards;
mod methods;
