//! Results of other methods in: masks, relevancy maps, latents and claimed numbers, whatever they are called on disk.
//!
//! Owns how foreign files are found ([`template`]), what they hold, and which traps of their formats are recognised;
//! every assumption that was made is written down. Refuses to know how masks are scored and how anything was trained.

pub mod arrays;
pub mod codes;
pub mod relevancy;
