//! What a camera saw: colour, depth in metres, instance ids; masks of instances and pictures of all of it.
//!
//! This crate decodes and draws. It knows what a pixel means (which instance, how far, which colour on a
//! screen) and whether the frames of a scene contradict each other or the tracks. It refuses to know what a
//! query means, how a mask is scored and how anything was rendered. All that needs renders stands behind the
//! feature `exr`, so that the judge can use the masks without linking a decoder of renders.

pub mod display;
pub mod drawn;
pub mod frame;
pub mod ids;
pub mod mask;
pub mod morphology;
pub mod png;
pub mod quantiles;
pub mod rle;
pub mod runs;
pub mod targets;
pub mod truth;

#[cfg(feature = "exr")]
pub mod backdrop;
#[cfg(feature = "exr")]
pub mod check;
#[cfg(feature = "exr")]
pub mod clip;
#[cfg(feature = "exr")]
pub mod closeup;
#[cfg(feature = "exr")]
pub mod exr;
#[cfg(feature = "exr")]
#[cfg(test)]
mod fake;
#[cfg(feature = "exr")]
pub mod geometry;
#[cfg(feature = "draw")]
pub mod overlay;
#[cfg(feature = "draw")]
pub mod photo;
#[cfg(feature = "exr")]
pub mod preview;
#[cfg(feature = "exr")]
pub mod sheet;
#[cfg(feature = "draw")]
pub mod text;

pub use display::Display;
pub use frame::{Frame, Surfaces};
pub use mask::Mask;
pub use runs::Runs;
