//! Every rasterizer of this crate through the suite that all rasterizers pass.

use l4d_splat::conformance::{Bounds, Finding, cases, central_differences, check, refusals, table};
use l4d_splat::raster::{Cpu, Rasterizer, Reference};
use rayon::prelude::*;

fn conforms(rasterizer: &dyn Rasterizer, bounds: &Bounds) {
    let findings = check(rasterizer, bounds).unwrap();
    println!("{}\n{}", rasterizer.name(), table(&findings));
    let failures: Vec<&Finding> = findings.iter().filter(|finding| !finding.passes()).collect();
    assert!(failures.is_empty(), "{}: {failures:#?}", rasterizer.name());
    assert_eq!(refusals(rasterizer).unwrap(), [""; 0]);
}

#[test]
fn the_reference_in_f64_is_itself_up_to_the_width_of_its_answers() {
    conforms(&Reference, &Bounds { colour: 1e-7, depth: 1e-7, gradient: 1e-7, flips: 0.0, ..Bounds::CPU });
}

#[test]
fn the_processor_conforms() {
    conforms(&Cpu::new(), &Bounds::CPU);
}

#[test]
fn the_processor_conforms_without_wide_instructions() {
    conforms(&Cpu::portable(), &Bounds::CPU);
}

/// Gradients of the reference against central differences of its own pictures: 6 derivatives of each field.
#[test]
fn the_gradients_of_the_reference_are_central_differences_on_every_scene() {
    cases().into_par_iter().for_each(|case| {
        let found = central_differences(&case, 6).unwrap();
        println!(
            "{:<18} {:>9.1e} {:>5} of {}",
            case.name,
            found.error,
            found.compared,
            found.compared + found.skipped
        );
        assert!(found.error <= 1e-5 && found.skipped <= found.compared, "{}: {found:?}", case.name);
    });
}

#[test]
fn a_plain_build_uses_the_wide_instructions_that_the_machine_has() {
    #[cfg(target_arch = "x86_64")]
    {
        let has = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        assert_eq!(Cpu::new().uses_avx2(), has);
        // Unless the build itself asks for them, the portable path does without.
        assert_eq!(Cpu::portable().uses_avx2(), cfg!(all(target_feature = "avx2", target_feature = "fma")));
    }
    assert!(!Cpu::new().name().is_empty());
}
