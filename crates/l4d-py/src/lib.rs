//! The Python package `l4d`: what the project reads, judges and draws, as numpy arrays.
//!
//! This crate owns how Python sees the types of the other crates: names, shapes, units, exceptions. It refuses to
//! compute anything that one of them could, so that a number is the same in Python and in the binary, to the last
//! bit. Work that takes long runs without the global lock of the interpreter.

mod arrays;
mod benchmark;
mod camera;
mod capture;
mod clips;
mod error;
mod frame;
mod judge;
mod query;
mod results;
mod sample;
mod scene;
mod splats;
mod timeline;
mod truth;

use pyo3::prelude::*;

/// Arrays of a frame are large and short-lived. The allocator of the C library hands their pages back to the system after
/// each frame and takes them again for the next, which costs more than half of what reading does.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// What `l4d/__init__.py` hands on.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{
        arrays::{rle_decode, rle_encode},
        benchmark::Benchmark,
        camera::Camera,
        capture::Capture,
        clips::Clips,
        frame::{Frame, FrameClip},
        judge::{Finding, check, score, write_baseline},
        query::{Event, Instance, Query},
        results::ResultsWriter,
        sample::{decode_colour, decode_depth, decode_ids},
        scene::Scene,
        splats::{Picture, PictureClip, Splats},
        timeline::Timeline,
        truth::Truth,
    };

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
