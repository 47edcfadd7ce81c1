//! The same bytes each time, and whatever the adapter has room for.

use l4d_gpu::Gpu;
use l4d_splat::conformance::{Case, cases};
use l4d_splat::raster::{Drawing, DrawingGradient, Rasterizer};
use l4d_splat::splats::SplatGradients;

use crate::{gpu, open};

/// Everything that a rasterizer computes of one scene.
#[derive(PartialEq)]
struct Answers {
    drawing: Drawing,
    gradients: SplatGradients,
    spread: Vec<u32>,
    gathered: Vec<u32>,
    radii: Vec<u32>,
}

fn answers(gpu: &Gpu, case: &Case) -> Answers {
    let projected = gpu.prepare(&case.splats, &case.view, &case.settings).unwrap();
    let drawing = projected.draw().unwrap();
    let mut gradient = DrawingGradient::zeros(&case.view);
    for (pixel, slope) in gradient.colour.iter_mut().enumerate() {
        *slope = [(pixel as f32).sin(), (pixel as f32).cos(), 0.3];
    }
    let gradients = projected.backward(&drawing, &gradient).unwrap();
    let features: Vec<f32> = (0..case.splats.len() * 11).map(|i| (i as f32).sin()).collect();
    let pixels: Vec<f32> = (0..case.view.pixel_count() * 11).map(|i| (i as f32).cos()).collect();
    let bits = |list: Vec<f32>| list.into_iter().map(f32::to_bits).collect();
    Answers {
        drawing,
        gradients,
        spread: bits(projected.spread(&features, 11).unwrap()),
        gathered: bits(projected.gather(&pixels, 11).unwrap()),
        radii: bits(projected.radii_px().unwrap()),
    }
}

fn some_cases() -> impl Iterator<Item = Case> {
    cases().into_iter().filter(|case| ["room", "cloud", "10000 layers", "nothing"].contains(&case.name))
}

#[test]
fn twice_the_same_bytes() {
    let other = open();
    for case in some_cases() {
        let first = answers(gpu(), &case);
        assert!(answers(gpu(), &case) == first, "{}", case.name);
        assert!(answers(&other, &case) == first, "{} on a device of its own", case.name);
    }
}

#[test]
fn parts_that_fit_give_the_bytes_of_the_whole() {
    // Several bands, several batches of pairs, several pieces of spherical harmonics.
    for (name, limit) in [("room", 50_000), ("cloud", 35_000)] {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        let small = open().with_binding_limit(limit);
        assert!(answers(&small, &case) == answers(gpu(), &case), "{name}");
    }
}

#[test]
fn many_threads_may_ask_at_once() {
    let cases: Vec<Case> = some_cases().collect();
    let alone: Vec<Answers> = cases.iter().map(|case| answers(gpu(), case)).collect();
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                for (case, alone) in std::iter::zip(&cases, &alone) {
                    assert!(answers(gpu(), case) == *alone, "{}", case.name);
                }
            });
        }
    });
}
