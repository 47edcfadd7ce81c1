//! Masks: sets of pixels, COCO's compressed run lengths, PNG pictures of masks and of instance ids, morphology.
//!
//! All that a judge of masks needs. What is in a scene and how it looks is known elsewhere.

pub mod ids;
pub mod mask;
pub mod morphology;
pub mod png;
pub mod rle;
pub mod runs;

pub use mask::Mask;
pub use runs::Runs;
