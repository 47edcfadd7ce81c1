//! A view and the constants of blending as the shaders know them, and the one thing that the host projects: depth.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{RasterSettings, TILE};
use l4d_splat::splats::Splats;
use l4d_splat::view::View;
use rayon::prelude::*;

use crate::sort::bits_of;

/// By how much the box around an ellipse is widened, in units of the exponent in base 2: more than the error of any
/// adapter's logarithm.
const SLACK: f64 = 1e-2;
/// Gaussians handled by one task.
const CHUNK: usize = 4096;

/// As `shared/scene.wgsl` has it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SceneConstants {
    rotation: [[f32; 4]; 3],
    centre_high: [f32; 4],
    centre_low: [f32; 4],
    focal: [f32; 2],
    principal: [f32; 2],
    slope_least: [f32; 2],
    slope_most: [f32; 2],
    pixels: [u32; 2],
    tiles: [u32; 2],
    blur: f32,
    sigmas: f32,
    alpha_min: f32,
    alpha_max: f32,
    transmittance_min: f32,
    span: f32,
    sh_degree: u32,
    splats: u32,
    depth_base: u32,
    hidden_key: u32,
    unused: [u32; 2],
}

impl SceneConstants {
    pub(crate) fn new(view: &View, settings: &RasterSettings, splats: &Splats, depths: &Depths) -> Self {
        let centre = view.centre();
        let high = centre.map(|value| value as f32);
        let low: [f32; 3] = std::array::from_fn(|axis| (centre[axis] - f64::from(high[axis])) as f32);
        let pixels = [view.width(), view.height()];
        let (focal, principal) = (view.focal(), view.principal());
        let slope = |axis: usize, edge: f64, sign: f64| {
            let size = f64::from(pixels[axis]);
            let beyond = (f64::from(settings.frustum_margin) - 1.0) * size / (2.0 * focal[axis]);
            ((edge * size - principal[axis]) / focal[axis] + sign * beyond) as f32
        };
        Self {
            rotation: view.rotation().map(|row| padded(row.map(|value| value as f32))),
            centre_high: padded(high),
            centre_low: padded(low),
            focal: focal.map(|value| value as f32),
            principal: principal.map(|value| (value - 0.5) as f32),
            slope_least: [slope(0, 0.0, -1.0), slope(1, 0.0, -1.0)],
            slope_most: [slope(0, 1.0, 1.0), slope(1, 1.0, 1.0)],
            pixels,
            tiles: pixels.map(|side| side.div_ceil(TILE as u32)),
            blur: settings.blur_px2,
            sigmas: settings.coverage_sigmas,
            alpha_min: settings.alpha_min,
            alpha_max: settings.alpha_max,
            transmittance_min: settings.transmittance_min,
            span: (SLACK - f64::from(settings.alpha_min).log2()) as f32,
            sh_degree: splats.sh_degree().get().into(),
            splats: splats.len() as u32,
            depth_base: depths.base,
            hidden_key: depths.hidden_key,
            unused: [0; 2],
        }
    }
}

fn padded([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, 0.0]
}

/// Distances along the optical axis, and how they become keys.
///
/// The host computes them, in f64 and with one rounding at the end: shaders have no f64, and the order of Gaussians
/// whose depths almost agree, as on a wall, would depend on the adapter. So it is that of the other rasterizers.
#[derive(Debug)]
pub(crate) struct Depths {
    /// Metres; 0 for what is not in front of the near plane.
    pub(crate) metres: Vec<f32>,
    base: u32,
    hidden_key: u32,
}

impl Depths {
    pub(crate) fn new(view: &View, settings: &RasterSettings, splats: &Splats) -> Self {
        let (centre, [_, _, ahead], near) = (view.centre(), view.rotation(), f64::from(settings.near_m));
        let metres: Vec<f32> = splats
            .means()
            .par_iter()
            .with_min_len(CHUNK)
            .map(|mean| {
                let offset: [f64; 3] = std::array::from_fn(|axis| f64::from(mean[axis]) - centre[axis]);
                let depth = ahead[0] * offset[0] + ahead[1] * offset[1] + ahead[2] * offset[2];
                if depth > near { depth as f32 } else { 0.0 }
            })
            .collect();
        // Bits of positive floats are in the order of the floats.
        let (least, most) = metres
            .iter()
            .filter(|&&depth| depth > 0.0)
            .map(|depth| depth.to_bits())
            .fold((u32::MAX, 0), |(least, most), bits| (least.min(bits), most.max(bits)));
        let (base, hidden_key) = if least <= most { (least, most - least + 1) } else { (0, 0) };
        Self { metres, base, hidden_key }
    }

    /// Bits of the largest key.
    pub(crate) fn key_bits(&self) -> u32 {
        bits_of(self.hidden_key)
    }
}
