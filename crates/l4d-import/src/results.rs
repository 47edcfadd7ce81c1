//! Results of other methods in: masks, relevancy maps, latents and claimed numbers, whatever they are called on disk.
//!
//! Owns how foreign files are found ([`template`]), what they hold ([`codec`]), and which traps of their formats are
//! recognised; every assumption that was made is written down ([`import`]). What is known of single methods is data
//! ([`preset`]).

pub mod claims;
pub mod codec;
pub mod codes;
pub mod import;
pub mod inside;
pub mod latents;
pub mod picture;
pub mod preset;
pub mod prompts;
pub mod relevancy;
pub mod shift;
pub mod template;
