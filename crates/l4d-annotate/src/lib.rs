//! How a person finds what a sentence means: the terminal application, and a page for a browser ([`offline`]).
//!
//! Model, update and view are apart: [`keys`] turns what the terminal says into messages, [`update`] is a pure
//! function from state and message to state and effects, [`view`] draws the state into cells, [`session`] carries
//! out the effects. Pictures are decoded and encoded in a thread of their own ([`paint_thread`]), so that no key waits
//! for one.
//!
//! The annotator is shown a prompt, pictures and numbers drawn by lot. This crate knows nothing of the key of a
//! round, of other ballots, and of what a vote leads to.

mod art;
mod decoder;
mod draft;
mod error;
mod field;
pub mod keys;
mod layout;
mod look;
mod message;
mod model;
pub mod offline;
mod paint_thread;
mod painter;
mod picture;
mod run;
pub mod scene;
mod session;
pub mod terminal;
#[cfg(test)]
mod testing;
mod update;
mod view;
mod viewport;

pub use error::AnnotateError;
pub use run::{Options, Outcome, annotate};
