//! Target `colmap`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| l4d_fuzz::run("colmap", bytes));
