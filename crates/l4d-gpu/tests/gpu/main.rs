//! The rasterizer on an adapter: against the reference and against itself.
//!
//! Without an adapter these tests fail and say what to install; they never skip.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

use std::sync::OnceLock;

use l4d_gpu::{AdapterChoice, Gpu};

mod conformance;
mod determinism;
mod refusals;

fn open() -> Gpu {
    Gpu::open(&AdapterChoice::Best).unwrap_or_else(|error| panic!("{error}"))
}

/// Opened once, so that passes are compiled once.
fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(open)
}
