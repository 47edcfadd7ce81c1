//! Against another program: pictures and gradients that PyTorch computed in f64 (see `fixture.py`).

use l4d_splat::ShDegree;
use l4d_splat::raster::{Cpu, DrawingGradient, RasterSettings, Rasterizer, Reference};
use l4d_splat::splats::{SplatParts, Splats};
use l4d_splat::view::View;
use serde::Deserialize;

#[derive(Deserialize)]
struct Fixture {
    view: Camera,
    background: [f32; 3],
    splats: Fields<f32>,
    drawing: Picture<f64>,
    weights: Picture<f32>,
    gradients: Fields<f64>,
}

#[derive(Deserialize)]
struct Camera {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    camera_from_world: [[f64; 4]; 3],
}

#[derive(Deserialize)]
struct Fields<F> {
    means: Vec<F>,
    scales: Vec<F>,
    rotations: Vec<F>,
    opacities: Vec<F>,
    sh: Vec<F>,
}

#[derive(Deserialize)]
struct Picture<F> {
    colour: Vec<F>,
    alpha: Vec<F>,
    depth_sum: Vec<F>,
}

fn fixture() -> Fixture {
    serde_json::from_str(include_str!("torch.json")).unwrap()
}

fn splats(fields: &Fields<f32>) -> Splats {
    Splats::new(SplatParts {
        sh_degree: ShDegree::MAX,
        means: fields.means.as_chunks().0.to_vec(),
        scales: fields.scales.as_chunks().0.to_vec(),
        rotations: fields.rotations.as_chunks().0.to_vec(),
        opacities: fields.opacities.clone(),
        sh: fields.sh.as_chunks().0.to_vec(),
    })
    .unwrap()
}

/// Largest difference, absolute or relative to the largest expected number.
fn difference(found: &[f32], expected: &[f64], relative: bool) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let worst = found
        .iter()
        .zip(expected)
        .map(|(&found, expected)| (f64::from(found) - expected).abs())
        .fold(0.0, f64::max);
    if relative { worst / largest } else { worst }
}

#[test]
fn pictures_and_gradients_are_those_of_pytorch() {
    let fixture = fixture();
    let splats = splats(&fixture.splats);
    let Camera { width, height, fx, fy, cx, cy, camera_from_world } = fixture.view;
    let view = View::new([width, height], [fx, fy], [cx, cy], camera_from_world).unwrap();
    let settings = RasterSettings { background: fixture.background, ..RasterSettings::default() };
    let rasterizers: [Box<dyn Rasterizer>; 3] =
        [Box::new(Reference), Box::new(Cpu::new()), Box::new(Cpu::portable())];
    for rasterizer in rasterizers {
        let projected = rasterizer.prepare(&splats, &view, &settings).unwrap();
        let drawing = projected.draw().unwrap();
        let slopes = DrawingGradient {
            colour: fixture.weights.colour.as_chunks().0.to_vec(),
            alpha: fixture.weights.alpha.clone(),
            depth_sum_m: fixture.weights.depth_sum.clone(),
        };
        let gradients = projected.backward(&drawing, &slopes).unwrap();
        let pictures = [
            ("colour", drawing.colour.as_flattened(), &fixture.drawing.colour),
            ("alpha", &drawing.alpha, &fixture.drawing.alpha),
            ("summed depth", &drawing.depth_sum_m, &fixture.drawing.depth_sum),
        ];
        for (name, found, expected) in pictures {
            let worst = difference(found, expected, false);
            println!("{} {name}: {worst:.1e}", rasterizer.name());
            assert!(worst < 1e-5, "{} {name}: {worst:e}", rasterizer.name());
        }
        let Fields { means, scales, rotations, opacities, sh } = &fixture.gradients;
        let names = ["means", "scales", "rotations", "opacities", "sh"];
        let expected = [means, scales, rotations, opacities, sh];
        for ((name, found), expected) in names.into_iter().zip(gradients.by.lists()).zip(expected) {
            let worst = difference(found, expected, true);
            println!("{} gradient by {name}: {worst:.1e}", rasterizer.name());
            assert!(worst < 1e-5, "{} gradient by {name}: {worst:e}", rasterizer.name());
        }
    }
}
