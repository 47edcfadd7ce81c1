//! Drawing: from the adapter's pixels to the picture that all rasterizers hand back.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{DepthQuantiles, Drawing};
use rayon::prelude::*;

use crate::error::Failure;
use crate::projection::{PIXEL_BYTES, Projection};
use crate::shaders::Pass;

/// As `draw.wgsl` writes it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Pixel {
    colour: [f32; 3],
    depth_sum_m: f32,
    /// Of the last Gaussian in front of which a level of transmittance is left.
    crossed_m: [f32; 3],
    unused: f32,
}

pub(crate) fn draw(scene: &Projection<'_>) -> Result<Drawing, Failure> {
    let count = scene.view.pixel_count() as u64;
    let picture = scene.gpu.buffer("picture", PIXEL_BYTES * count)?;
    let mut commands = scene.gpu.commands();
    let left = scene.over_tiles(&mut commands, Pass::Draw, &[&picture])?;
    let (picture, left) =
        (commands.copy_out(&picture, 0, PIXEL_BYTES * count)?, commands.copy_out(&left, 0, 4 * count)?);
    commands.submit();
    let pixels: Vec<Pixel> = scene.gpu.read_back(&picture)?;
    let left: Vec<f32> = scene.gpu.read_back(&left)?;
    Ok(assemble(scene, &pixels, left.into_iter().map(f32::abs).collect()))
}

fn assemble(scene: &Projection<'_>, pixels: &[Pixel], transmittance: Vec<f32>) -> Drawing {
    let background = scene.settings.background;
    let colour = |(pixel, left): (&Pixel, &f32)| -> [f32; 3] {
        std::array::from_fn(|channel| pixel.colour[channel] + left * background[channel])
    };
    let quantile = |which: usize| -> Vec<f32> {
        let level = DepthQuantiles::LEVELS[which];
        let depth = |(pixel, &left): (&Pixel, &f32)| {
            if left < level { pixel.crossed_m[which] } else { f32::INFINITY }
        };
        pixels.par_iter().zip(&transmittance).map(depth).collect()
    };
    let quantiles = scene.settings.quantiles.then(|| DepthQuantiles {
        near_m: quantile(0),
        median_m: quantile(1),
        far_m: quantile(2),
    });
    Drawing {
        width: scene.view.width(),
        height: scene.view.height(),
        colour: pixels.par_iter().zip(&transmittance).map(colour).collect(),
        alpha: transmittance.iter().map(|left| 1.0 - left).collect(),
        depth_sum_m: pixels.iter().map(|pixel| pixel.depth_sum_m).collect(),
        quantiles,
        transmittance,
    }
}
