//! The same bytes on any number of threads.

use l4d_splat::conformance::cases;
use l4d_splat::raster::{Cpu, Drawing, DrawingGradient, Rasterizer};
use l4d_splat::splats::SplatGradients;

/// Bits of everything that a rasterizer computes of one scene.
#[derive(PartialEq)]
struct Answers {
    drawing: Drawing,
    gradients: SplatGradients,
    spread: Vec<u32>,
    gathered: Vec<u32>,
}

fn answers(threads: usize, name: &str) -> Answers {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let case = cases().into_iter().find(|case| case.name == name).unwrap();
    pool.install(|| {
        let cpu = Cpu::new();
        let projected = cpu.prepare(&case.splats, &case.view, &case.settings).unwrap();
        let drawing = projected.draw().unwrap();
        let mut gradient = DrawingGradient::zeros(&case.view);
        for (pixel, slope) in gradient.colour.iter_mut().enumerate() {
            *slope = [(pixel as f32).sin(), (pixel as f32).cos(), 0.3];
        }
        let gradients = projected.backward(&drawing, &gradient).unwrap();
        let features: Vec<f32> = (0..case.splats.len() * 3).map(|i| (i as f32).sin()).collect();
        let pixels: Vec<f32> = (0..case.view.pixel_count() * 3).map(|i| (i as f32).cos()).collect();
        let bits = |list: Vec<f32>| list.into_iter().map(f32::to_bits).collect();
        Answers {
            drawing,
            gradients,
            spread: bits(projected.spread(&features, 3).unwrap()),
            gathered: bits(projected.gather(&pixels, 3).unwrap()),
        }
    })
}

#[test]
fn one_two_and_eight_threads_give_the_same_bytes() {
    for name in ["room", "cloud", "10000 layers", "nothing"] {
        let one = answers(1, name);
        assert!([2, 3, 8].into_iter().all(|threads| answers(threads, name) == one), "{name}");
    }
}
