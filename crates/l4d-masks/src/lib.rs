//! Masks: sets of pixels, COCO's compressed run lengths, PNG pictures of masks and of instance ids, morphology.
//!
//! All that a judge of masks needs. How a scene looks is known elsewhere.

pub mod ids;
pub mod mask;
pub mod morphology;
pub mod png;
pub mod target;

pub use l4d_data::rle::{Rle, RleError};
pub use mask::{Mask, iou};
