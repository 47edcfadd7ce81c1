//! What a camera saw: colour, depth in metres, instance ids; and pictures of all of it.
//!
//! This crate decodes and draws. It knows what a pixel means (which instance, how far, which colour on a
//! screen) and whether the frames of a scene contradict each other or the tracks. It refuses to know what a
//! query means, how a mask is scored and how anything was rendered.

pub mod backdrop;
pub mod check;
pub mod clip;
pub mod closeup;
pub mod display;
pub mod drawn;
pub mod exr;
pub mod frame;
mod geometry;
pub mod moving_picture;
pub mod overlay;
pub mod photo;
pub mod preview;
mod quantiles;
pub mod sample;
pub mod sheet;
pub mod text;
pub mod truth;

pub use display::Display;
pub use frame::{Frame, Surfaces};
