//! Files of other programs, without their meaning: NumPy arrays, torch pickles, safetensors, PLY, COLMAP models.
//!
//! Everything that is read is untrusted: sizes are checked against the length of the file before memory is allocated,
//! nothing is ever executed, and what is wrong is reported with its place and a hint.

pub mod arrays;
pub mod colmap;
mod element;
pub mod fault;
pub mod npy;
pub mod pickle;
pub mod ply;
pub mod python;
pub mod tensor;
pub mod tensor_file;
pub mod zip;

pub use fault::Fault;
pub use tensor::Tensor;
