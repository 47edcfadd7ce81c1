//! PanopticQuery (paper, section 4): a sentence in, a 4D grounding out, masks from cameras that no one trained on.
//!
//! This crate owns the stages between a trained model and an answer: clips, grounding of each view, multi-view
//! semantic consensus, 4D lifting, masks. It refuses to know how a grounder finds anything, how splats are trained and
//! drawn, and how masks are judged.

mod account;
pub mod ask;
pub mod batch;
pub mod clips;
pub mod consensus;
pub mod grounded;
pub mod grounders;
pub mod lift;
pub mod method;
pub mod scene;
mod show;
pub mod solve;
#[cfg(test)]
mod testing;
