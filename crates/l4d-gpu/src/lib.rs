//! The rasterizer of 4D Gaussians on graphics hardware, through wgpu.
//!
//! [`Gpu`] keeps the contract of [`l4d_splat::raster::Rasterizer`] and passes the same conformance suite as the processor.
//! Owns the passes, their buffers and the errors of drivers; no other crate knows wgpu. `docs/gpu.md` has the rest.
//!
//! ```no_run
//! let gpu = l4d_gpu::Gpu::open(&"best".parse()?)?;
//! let rasterizer: &dyn l4d_splat::raster::Rasterizer = &gpu;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ```text
//! project -> sort by depth -> count -> scan | emit -> sort by tile -> ranges |
//!     draw                                   pixels
//!     splat_features                         pixels, eight channels a pass
//!     gather_features -> reduce              Gaussians, eight channels a pass
//!     backward -> reduce -> project_backward gradients
//! ```
//!
//! At each bar the host waits and reads back: first the number of pairs of tile and Gaussian, for which it makes lists of
//! that length. Sorting is a stable radix sort of four bits a round. A tile is a workgroup of 64 lanes with four pixels
//! each. The host computes depths in f64 with one rounding, so that all rasterizers have the same order.
//!
//! One adapter gives the same bytes each time: no float atomics, no subgroups, sums in a fixed order. What does not fit
//! the adapter's limits is refused with the name of the limit.

mod adapter;
mod backward;
mod commands;
mod constants;
mod device;
mod error;
mod features;
mod forward;
mod projection;
mod shaders;
mod sort;
mod upload;

pub use adapter::{AdapterChoice, AdapterReport, adapters};
pub use device::Gpu;
pub use error::GpuError;
