//! The rasterizer of 4D Gaussians on graphics hardware, through wgpu.
//!
//! [`Gpu`] keeps the contract of [`l4d_splat::raster::Rasterizer`]: the same tests in the same order as the
//! processor's, so that one conformance suite holds for both. This crate owns the passes, their buffers and what can
//! go wrong with a driver. It refuses to know what a picture is for, and no other crate knows wgpu.
//!
//! ```no_run
//! use l4d_gpu::{AdapterChoice, Gpu};
//!
//! // What `--adapter` says; `cpu` is the caller's business.
//! let choice: AdapterChoice = "best".parse()?;
//! let gpu = Gpu::open(&choice)?;
//! let of_the_manifest = gpu.adapter();
//! let rasterizer: &dyn l4d_splat::raster::Rasterizer = &gpu;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Passes
//!
//! ```text
//! project -> sort by depth -> count -> scan | emit -> sort by tile -> ranges |
//!     draw                                              pixels
//!     spread                                            pixels, eight channels a pass
//!     gather -> reduce                                  Gaussians, eight channels a pass
//!     blame -> reduce -> unproject                      gradients
//!     trace                                             one pixel's Gaussians
//! ```
//!
//! At each bar the host waits and reads back. The first time it learns how many pairs of tile and Gaussian there
//! are and makes lists of that length: nothing is bounded by a guess, and nothing is cut off. Sorting is a radix sort
//! of four bits a round, stable: first Gaussians by depth, then pairs by tile, so that each tile lists its Gaussians
//! front to back, and equal depths by index. A tile is a workgroup of 64 lanes with four pixels each.
//!
//! # Order
//!
//! The host computes depths, in f64 with one rounding. Shaders have no f64, and the order of Gaussians whose depths
//! almost agree would differ between adapters, and from the processor's. Everything else of the projection is f32,
//! written so that it keeps its digits for needles, discs and blobs of any size: a determinant as a sum of squares,
//! covariances in units of the largest entry, gradients through whitened axes (`shaders/project_backward.wgsl`).
//!
//! # Same bytes
//!
//! One adapter gives the same bytes each time: no float atomics, no subgroups. Sums over the pixels of a tile are
//! taken lane after lane, sums over the tiles of a Gaussian in the order in which its pairs were emitted. Where the
//! adapter has no room for a whole, parts go on where the part before stopped, which adds the same numbers in the
//! same order. Between adapters, results differ by rounding: a compiler may fuse a product and a sum.
//!
//! # Limits
//!
//! A pass binds at most eight storage buffers and 16 KiB of workgroup memory, as WebGPU promises; buffers that a
//! pass sees stay below the adapter's `max_storage_buffer_binding_size`. Spherical harmonics and gradients go in
//! pieces, pictures in bands, sums of pairs in batches; what is left (48 bytes a Gaussian, 4 a pair) is refused with
//! the name of the limit where it does not fit. `docs/gpu.md` has the table.

mod adapter;
mod backward;
mod bands;
mod commands;
mod constants;
mod device;
mod error;
mod features;
mod forward;
mod projected;
mod projection;
mod shaders;
mod sort;
mod upload;

pub use adapter::{ADAPTER_VARIABLE, AdapterChoice, AdapterReport, adapters};
pub use device::Gpu;
pub use error::GpuError;
pub use upload::Uploaded;
