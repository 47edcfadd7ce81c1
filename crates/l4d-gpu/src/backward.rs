//! From a picture's error to the gradient of the splats.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{Drawing, DrawingGradient};
use l4d_splat::splats::SplatGradients;
use rayon::prelude::*;

use crate::carry::sum_over_pairs;
use crate::error::Fault;
use crate::projection::Projection;
use crate::shaders::{BODY_GRADIENTS, LANES, MOMENTS, Pass};
use crate::work::{groups_of, whole};

/// As `blame.wgsl` reads it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Slopes {
    by_colour: [f32; 3],
    by_depth_sum: f32,
    by_alpha: f32,
    worth: f32,
    unused: [f32; 2],
}

/// As `unproject.wgsl` writes it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct BodyGradient {
    mean: [f32; 3],
    mean_ndc: [f32; 2],
    scale: [f32; 3],
    rotation: [f32; 4],
    opacity: f32,
    visible: f32,
    unused: [f32; 2],
}

const _: () = assert!(size_of::<BodyGradient>() == 4 * BODY_GRADIENTS as usize);

pub(crate) fn backward(
    scene: &Projection<'_>,
    drawing: &Drawing,
    gradient: &DrawingGradient,
) -> Result<SplatGradients, Fault> {
    let gpu = scene.gpu;
    let slopes: Vec<Slopes> = (0..scene.view.pixel_count())
        .into_par_iter()
        .map(|pixel| slopes_of(scene.settings.background, drawing, gradient, pixel))
        .collect();
    let sums = sum_over_pairs(scene, MOMENTS, |work, band, pairs, partials| {
        let slopes = gpu.filled("derivatives by pixels", &slopes[band.first_pixel..band.end_pixel])?;
        scene.over_tiles(work, Pass::Blame, band, pairs, &[&scene.lights(band)?, &slopes, partials])
    })?;

    let body_bytes = size_of::<BodyGradient>() as u64 * scene.splats.len() as u64;
    let sh_bytes = size_of_val(scene.splats.sh()) as u64;
    let by_body = gpu.long_buffer("derivatives by bodies", body_bytes)?;
    let by_sh = gpu.long_buffer("derivatives by spherical harmonics", sh_bytes)?;
    let mut work = gpu.work();
    for run in &scene.pieces {
        work.run(
            Pass::Unproject,
            groups_of(run.len(), LANES),
            &run.part(),
            &[
                whole(&scene.constants),
                whole(&scene.bodies),
                run.of_sh(&scene.sh),
                whole(&scene.footprints),
                whole(&sums),
                run.of_gradients(&by_body),
                run.of_sh(&by_sh),
            ],
        )?;
    }
    let by_body = work.fetch(&by_body, 0, body_bytes)?;
    let by_sh = work.fetch(&by_sh, 0, sh_bytes)?;
    work.submit();
    let bodies: Vec<BodyGradient> = gpu.receive(&by_body)?;
    Ok(SplatGradients {
        means: bodies.iter().map(|body| body.mean).collect(),
        scales: bodies.iter().map(|body| body.scale).collect(),
        rotations: bodies.iter().map(|body| body.rotation).collect(),
        opacities: bodies.iter().map(|body| body.opacity).collect(),
        sh: gpu.receive(&by_sh)?,
        means_ndc: bodies.iter().map(|body| body.mean_ndc).collect(),
        visible: bodies.iter().map(|body| body.visible > 0.0).collect(),
    })
}

fn slopes_of(background: [f32; 3], drawing: &Drawing, gradient: &DrawingGradient, pixel: usize) -> Slopes {
    let by_colour = gradient.colour[pixel];
    let by_depth_sum = gradient.depth_sum_m[pixel];
    let left = f64::from(drawing.transmittance[pixel]);
    // The background shows through 1 - alpha: its part of the loss is a loss by alpha.
    let mut by_alpha = f64::from(gradient.alpha[pixel]);
    let mut worth = f64::from(by_depth_sum) * f64::from(drawing.depth_sum_m[pixel]);
    for channel in 0..3 {
        let (slope, behind) = (f64::from(by_colour[channel]), f64::from(background[channel]));
        by_alpha -= slope * behind;
        worth += slope * (f64::from(drawing.colour[pixel][channel]) - left * behind);
    }
    worth += by_alpha * (1.0 - left);
    Slopes { by_colour, by_depth_sum, by_alpha: by_alpha as f32, worth: worth as f32, unused: [0.0; 2] }
}

/// Radii of the squares in which the Gaussians are drawn.
pub(crate) fn radii(scene: &Projection<'_>) -> Result<Vec<f32>, Fault> {
    let bytes = crate::projection::FOOTPRINT_BYTES * scene.splats.len() as u64;
    let mut work = scene.gpu.work();
    let parcel = work.fetch(&scene.footprints, 0, bytes)?;
    work.submit();
    let footprints: Vec<[f32; 12]> = scene.gpu.receive(&parcel)?;
    Ok(footprints.iter().map(|footprint| footprint[7]).collect())
}
