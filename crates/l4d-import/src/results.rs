//! Results of other methods in: masks, relevancy maps, latents and claimed numbers, whatever they are called on disk.
//!
//! Owns how foreign files are found by templates, what they hold ([`codec`]), and which traps of their formats are
//! recognised; every assumption that was made is written down ([`import`]). What is known of single methods is data
//! ([`preset`]).

mod claims;
pub mod codec;
mod codes;
pub mod import;
pub mod inside;
mod latents;
mod picture;
pub mod preset;
mod prompts;
pub mod relevancy;
mod shift;
mod template;
