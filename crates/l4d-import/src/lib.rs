//! How scenes, captures, annotations and results travel between l4d and the tools of others.
//!
//! Owns the foreign formats: what their files are called, which axes and units they speak, and where their
//! readers go wrong. Refuses to know how anything is rendered, solved or judged.

pub mod annotations;
pub mod capture;
pub mod colmap;
pub mod export;
pub mod npy;
pub mod ply;
pub mod pose;
pub mod results;
