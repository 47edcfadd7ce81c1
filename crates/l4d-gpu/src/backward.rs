//! Backward: from the gradient of a picture to that of the splats.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{Drawing, DrawingGradient};
use l4d_splat::splats::{SplatGradients, SplatParts};
use rayon::prelude::*;

use crate::commands::{groups_of, whole};
use crate::error::Failure;
use crate::features::sum_over_pairs;
use crate::projection::Projection;
use crate::shaders::{GRADIENT_FLOATS, GRADIENT_SUMS, LANES, Pass};

/// As `backward.wgsl` reads it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct PixelGradient {
    by_colour: [f32; 3],
    by_depth_sum: f32,
    by_alpha: f32,
    rest: f32,
    unused: [f32; 2],
}

/// As `project_backward.wgsl` writes it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct GaussianGradient {
    mean: [f32; 3],
    mean_ndc: [f32; 2],
    scale: [f32; 3],
    rotation: [f32; 4],
    opacity: f32,
    visible: f32,
    unused: [f32; 2],
}

const _: () = assert!(size_of::<GaussianGradient>() == 4 * GRADIENT_FLOATS as usize);

pub(crate) fn backward(
    scene: &Projection<'_>,
    drawing: &Drawing,
    gradient: &DrawingGradient,
) -> Result<SplatGradients, Failure> {
    let gpu = scene.gpu;
    let slopes: Vec<PixelGradient> = (0..scene.view.pixel_count())
        .into_par_iter()
        .map(|pixel| slopes_of(scene.settings.background, drawing, gradient, pixel))
        .collect();
    let slopes = gpu.filled("derivatives by pixels", &slopes)?;
    let mut commands = gpu.commands();
    let sums = sum_over_pairs(scene, &mut commands, GRADIENT_SUMS, Pass::Backward, &slopes)?;

    let count = scene.splats.len() as u64;
    let gaussian_bytes = size_of::<GaussianGradient>() as u64 * count;
    let sh_bytes = size_of_val(scene.splats.sh()) as u64;
    let by_gaussian = gpu.buffer("derivatives by gaussians", gaussian_bytes)?;
    let by_sh = gpu.buffer("derivatives by spherical harmonics", sh_bytes)?;
    let bindings =
        [&scene.constants, &scene.gaussians, &scene.sh, &scene.splats2d, &sums, &by_gaussian, &by_sh];
    commands.run(Pass::ProjectBackward, groups_of(count, LANES), &[count as u32], &bindings.map(whole))?;
    let by_gaussian = commands.copy_out(&by_gaussian, 0, gaussian_bytes)?;
    let by_sh = commands.copy_out(&by_sh, 0, sh_bytes)?;
    commands.submit();
    let gaussians: Vec<GaussianGradient> = gpu.read_back(&by_gaussian)?;
    Ok(SplatGradients {
        by: SplatParts {
            sh_degree: scene.splats.sh_degree(),
            means: gaussians.iter().map(|gaussian| gaussian.mean).collect(),
            scales: gaussians.iter().map(|gaussian| gaussian.scale).collect(),
            rotations: gaussians.iter().map(|gaussian| gaussian.rotation).collect(),
            opacities: gaussians.iter().map(|gaussian| gaussian.opacity).collect(),
            sh: gpu.read_back(&by_sh)?,
        },
        means_ndc: gaussians.iter().map(|gaussian| gaussian.mean_ndc).collect(),
        visible: gaussians.iter().map(|gaussian| gaussian.visible > 0.0).collect(),
    })
}

fn slopes_of(
    background: [f32; 3],
    drawing: &Drawing,
    gradient: &DrawingGradient,
    pixel: usize,
) -> PixelGradient {
    let by_colour = gradient.colour[pixel];
    let by_depth_sum = gradient.depth_sum_m[pixel];
    let left = f64::from(drawing.transmittance[pixel]);
    // The background shows through 1 - alpha: its part of the loss is a loss by alpha.
    let mut by_alpha = f64::from(gradient.alpha[pixel]);
    let mut rest = f64::from(by_depth_sum) * f64::from(drawing.depth_sum_m[pixel]);
    for channel in 0..3 {
        let (slope, behind) = (f64::from(by_colour[channel]), f64::from(background[channel]));
        by_alpha -= slope * behind;
        rest += slope * (f64::from(drawing.colour[pixel][channel]) - left * behind);
    }
    rest += by_alpha * (1.0 - left);
    PixelGradient { by_colour, by_depth_sum, by_alpha: by_alpha as f32, rest: rest as f32, unused: [0.0; 2] }
}
