//! The same bytes on any number of threads.

use l4d_splat::conformance::{Outputs, cases};
use l4d_splat::raster::Cpu;

fn outputs(threads: usize, name: &str) -> Outputs {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let case = cases().into_iter().find(|case| case.name == name).unwrap();
    pool.install(|| Outputs::of(&Cpu::new(), &case).unwrap())
}

#[test]
fn one_two_and_eight_threads_give_the_same_bytes() {
    for name in ["room", "cloud", "10000 layers", "nothing"] {
        let one = outputs(1, name);
        assert!([2, 3, 8].into_iter().all(|threads| outputs(threads, name) == one), "{name}");
    }
}
