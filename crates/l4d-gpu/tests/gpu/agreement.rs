//! The adapter against the processor: what has to be equal is equal, what is rounded differs by little.

use l4d_splat::conformance::{Case, cases};
use l4d_splat::raster::{Cpu, DrawingGradient, Projected, Rasterizer};
use l4d_splat::splats::SplatGradients;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::gpu;

/// Colour and alpha of a pixel.
const COLOUR: f32 = 1e-4;
/// Summed depth, relative to the largest of the picture.
const DEPTH: f32 = 1e-4;
/// Gradients, relative to the largest of the field.
const GRADIENT: f32 = 1e-3;
/// Share of the pixels that a threshold may change, and by how much.
const FLIPS: f32 = 1e-3;
const FLIP: f32 = 0.02;
/// Share of the Gaussians whose gradient such pixels may change, by as much.
const TOUCHED: f32 = 0.02;

#[test]
fn pictures_agree_with_those_of_the_processor() {
    let cpu = Cpu::new();
    println!("{:<18} {:>9} {:>9} {:>6}", "scene", "colour", "depth", "flips");
    for case in cases() {
        let ours = gpu().prepare(&case.splats, &case.view, &case.settings).unwrap().draw().unwrap();
        let theirs = cpu.prepare(&case.splats, &case.view, &case.settings).unwrap().draw().unwrap();
        assert_eq!((ours.width, ours.height), (theirs.width, theirs.height));
        let farthest = theirs.depth_sum_m.iter().copied().fold(1.0, f32::max);
        let (mut colour, mut depth, mut flips) = (0.0_f32, 0.0_f32, 0);
        for pixel in 0..case.view.pixel_count() {
            let of_colour = std::iter::zip(ours.colour[pixel], theirs.colour[pixel])
                .chain([(ours.alpha[pixel], theirs.alpha[pixel])])
                .chain([(ours.transmittance[pixel], theirs.transmittance[pixel])])
                .map(|(ours, theirs)| off(ours, theirs))
                .fold(0.0, f32::max);
            let of_depth = off(ours.depth_sum_m[pixel], theirs.depth_sum_m[pixel]) / farthest;
            if of_colour > COLOUR || of_depth > DEPTH {
                assert!(of_colour <= FLIP && of_depth <= FLIP, "{}, pixel {pixel}: {of_colour:e}", case.name);
                flips += 1;
            } else {
                (colour, depth) = (colour.max(of_colour), depth.max(of_depth));
            }
        }
        println!("{:<18} {colour:>9.1e} {depth:>9.1e} {flips:>6}", case.name);
        let allowed = (FLIPS * case.view.pixel_count() as f32).ceil() as usize;
        assert!(flips <= allowed, "{}: {flips} flips", case.name);
    }
}

#[test]
fn depth_quantiles_are_those_of_the_processor() {
    let cpu = Cpu::new();
    for case in cases() {
        let drawn = |rasterizer: &dyn Rasterizer| {
            let drawing =
                rasterizer.prepare(&case.splats, &case.view, &case.settings).unwrap().draw().unwrap();
            let quantiles = drawing.quantiles.unwrap();
            [quantiles.near_m, quantiles.median_m, quantiles.far_m].concat()
        };
        // Depths come from the same computation: equal to the bit, unless a transmittance lies on a level.
        let differ =
            std::iter::zip(drawn(gpu()), drawn(&cpu)).filter(|(ours, theirs)| ours != theirs).count();
        let allowed = (3.0 * FLIPS * case.view.pixel_count() as f32).ceil() as usize;
        assert!(differ <= allowed, "{}: {differ}", case.name);
    }
}

#[test]
fn the_order_is_that_of_the_processor() {
    let cpu = Cpu::new();
    for case in cases() {
        let ours = gpu().prepare(&case.splats, &case.view, &case.settings).unwrap();
        let theirs = cpu.prepare(&case.splats, &case.view, &case.settings).unwrap();
        let (width, height) = (case.view.width(), case.view.height());
        let mut differ = 0;
        for (column, row) in
            [(0, 0), (width / 2, height / 2), (width - 1, height / 3), (width / 4, height - 1)]
        {
            let order = |projected: &dyn Projected| -> Vec<u32> {
                projected.contributors(column, row).unwrap().iter().map(|entry| entry.index).collect()
            };
            let (ours, theirs) = (order(ours.as_ref()), order(theirs.as_ref()));
            // Who is below a threshold may differ; who is in front of whom may not.
            let both = |list: &[u32], other: &[u32]| -> Vec<u32> {
                list.iter().copied().filter(|index| other.contains(index)).collect()
            };
            assert_eq!(both(&ours, &theirs), both(&theirs, &ours), "{} at ({column}, {row})", case.name);
            differ += usize::from(ours != theirs);
        }
        assert!(differ <= 1, "{}: {differ} pixels", case.name);
    }
}

#[test]
fn radii_are_those_of_the_processor() {
    let cpu = Cpu::new();
    for case in cases() {
        let radii = |rasterizer: &dyn Rasterizer| {
            rasterizer.prepare(&case.splats, &case.view, &case.settings).unwrap().radii_px().unwrap()
        };
        for (ours, theirs) in std::iter::zip(radii(gpu()), radii(&cpu)) {
            // Rounded up to whole pixels, of which large ones have no digits.
            assert!((ours - theirs).abs() <= 1.0_f32.max(1e-5 * theirs), "{}: {ours} {theirs}", case.name);
            assert_eq!(ours > 0.0, theirs > 0.0, "{}", case.name);
        }
    }
}

#[test]
fn gradients_agree_with_those_of_the_processor() {
    let cpu = Cpu::new();
    println!("{:<18} {:<10} {:>9} {:>6}", "scene", "by", "error", "flips");
    for case in cases() {
        let (ours, theirs) = (gradients(gpu(), &case), gradients(&cpu, &case));
        for ((field, width, ours), (_, _, theirs)) in std::iter::zip(fields(&ours), fields(&theirs)) {
            assert_eq!(ours.len(), theirs.len());
            let largest = theirs.iter().fold(0.0_f32, |most, value| most.max(value.abs()));
            let scale = if largest > 0.0 { largest } else { 1.0 };
            let (mut worst, mut flips) = (0.0_f32, 0);
            for (ours, theirs) in std::iter::zip(ours.chunks(width), theirs.chunks(width)) {
                let error = std::iter::zip(ours, theirs)
                    .map(|(&ours, &theirs)| off(ours, theirs) / scale)
                    .fold(0.0, f32::max);
                if error <= GRADIENT {
                    worst = worst.max(error);
                } else {
                    assert!(error <= FLIP, "{} by {field}: {ours:?} {theirs:?} of {scale:e}", case.name);
                    flips += 1;
                }
            }
            println!("{:<18} {field:<10} {worst:>9.1e} {flips:>6}", case.name);
            let allowed = (TOUCHED * (theirs.len() / width) as f32).ceil() as usize;
            assert!(flips <= allowed, "{} by {field}: {flips} flips", case.name);
        }
        assert_eq!(ours.visible, theirs.visible, "{}", case.name);
    }
}

/// Distance of two numbers; that of NaN from anything has no bound.
fn off(ours: f32, theirs: f32) -> f32 {
    let difference = (ours - theirs).abs();
    if difference.is_nan() { f32::INFINITY } else { difference }
}

fn gradients(rasterizer: &dyn Rasterizer, case: &Case) -> SplatGradients {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut slopes = DrawingGradient::zeros(&case.view);
    slopes.colour.iter_mut().flatten().for_each(|slope| *slope = random.random_range(-1.0..1.0));
    slopes.alpha.iter_mut().for_each(|slope| *slope = random.random_range(-1.0..1.0));
    slopes.depth_sum_m.iter_mut().for_each(|slope| *slope = random.random_range(-0.3..0.3));
    let projected = rasterizer.prepare(&case.splats, &case.view, &case.settings).unwrap();
    projected.backward(&projected.draw().unwrap(), &slopes).unwrap()
}

/// Name, numbers a Gaussian, all numbers.
fn fields(gradients: &SplatGradients) -> [(&'static str, usize, &[f32]); 6] {
    [
        ("means", 3, gradients.means.as_flattened()),
        ("scales", 3, gradients.scales.as_flattened()),
        ("rotations", 4, gradients.rotations.as_flattened()),
        ("opacities", 1, &gradients.opacities),
        ("sh", 3, gradients.sh.as_flattened()),
        ("means, ndc", 2, gradients.means_ndc.as_flattened()),
    ]
}
