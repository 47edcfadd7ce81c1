//! How scenes, captures, annotations and results travel between l4d and other tools.
//!
//! Knows what files of other layouts are called, which axes and units they use, and where their readers go wrong.

pub mod annotations;
pub mod capture;
pub mod export;
pub mod handout;
pub mod points;
pub mod pose;
pub mod results;
