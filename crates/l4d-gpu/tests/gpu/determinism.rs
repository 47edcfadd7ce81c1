//! The same bytes each time, and whatever the adapter has room for.

use l4d_gpu::Gpu;
use l4d_splat::conformance::{Case, Outputs, cases};

use crate::{gpu, open};

fn outputs(gpu: &Gpu, case: &Case) -> Outputs {
    Outputs::of(gpu, case).unwrap()
}

fn some_cases() -> impl Iterator<Item = Case> {
    cases().into_iter().filter(|case| ["room", "cloud", "10000 layers", "nothing"].contains(&case.name))
}

#[test]
fn twice_the_same_bytes() {
    let other = open();
    for case in some_cases() {
        let first = outputs(gpu(), &case);
        assert!(outputs(gpu(), &case) == first, "{}", case.name);
        assert!(outputs(&other, &case) == first, "{} on a device of its own", case.name);
    }
}

#[test]
fn many_threads_may_ask_at_once() {
    let cases: Vec<Case> = some_cases().collect();
    let alone: Vec<Outputs> = cases.iter().map(|case| outputs(gpu(), case)).collect();
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                for (case, alone) in std::iter::zip(&cases, &alone) {
                    assert!(outputs(gpu(), case) == *alone, "{}", case.name);
                }
            });
        }
    });
}
