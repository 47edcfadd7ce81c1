//! The suite that all rasterizers pass.

use l4d_splat::conformance::{Bounds, Finding, check, refusals, table};
use l4d_splat::raster::Rasterizer;

use crate::gpu;

/// What is promised against the reference in f64. Projections are computed in f32 here, in f64 on the processor.
const BOUNDS: Bounds = Bounds { colour: 1e-4, depth: 1e-4, gradient: 1e-3, ..Bounds::CPU };

#[test]
fn the_adapter_conforms() {
    let findings = check(gpu(), &BOUNDS).unwrap();
    println!("{}\n{}", gpu().name(), table(&findings));
    let failures: Vec<&Finding> = findings.iter().filter(|finding| !finding.passes()).collect();
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    assert_eq!(refusals(gpu()).unwrap(), [""; 0]);
}
