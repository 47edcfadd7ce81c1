//! Backward over pixels: the gradient of each Gaussian, as sums over its pixels.
//!
//! Front to back like the drawing itself. The loss of what lies behind a Gaussian is that of the whole pixel less
//! what has been blended so far: nothing is divided by a transmittance.

use fearless_simd::{Select as _, f32x8, prelude::*};

use super::blend::{BlendStep, LANES, Plane, Tile, Visitor, blend_tile};
use super::projection::Splat2d;
use super::{Kernel, ProjectedScene};
use crate::raster::{Drawing, DrawingGradient, TILE};

/// Numbers in [`GradientSums`].
pub(super) const GRADIENT_SUMS: usize = 10;

/// Of one Gaussian, summed over pixels: derivative by colour (3), by depth, and, each weighted with the derivative by
/// the natural logarithm of alpha: 1, u, v, u^2, uv, v^2 (see [`Splat2d::axes`]).
pub(super) type GradientSums = [f64; GRADIENT_SUMS];

/// The sums of the visible Gaussians, front to back; zero for those that do not learn.
pub(super) fn gradient_sums(
    scene: &ProjectedScene<'_>,
    drawing: &Drawing,
    gradient: &DrawingGradient,
    trainable: Option<&[bool]>,
) -> Vec<GradientSums> {
    let totals = scene.bins.sums(GRADIENT_SUMS, scene.splats2d.len(), |index, sums| {
        if sums.is_empty() {
            return;
        }
        scene.cpu.run(BackwardPass { scene, tile: scene.tile(index), drawing, gradient, trainable, sums });
    });
    totals.as_chunks().0.to_vec()
}

/// Derivatives of the loss by the pixels of a tile.
struct PixelGradients {
    /// Derivatives of the loss by red, green, blue, summed depth and alpha.
    slopes: [Plane; 5],
    /// Loss that is still to be blended: at first that of the whole pixel, without the background.
    rest: Plane,
}

impl PixelGradients {
    fn new(
        scene: &ProjectedScene<'_>,
        tile: &Tile<'_>,
        drawing: &Drawing,
        gradient: &DrawingGradient,
    ) -> Self {
        let width = scene.view.width() as usize;
        let background = scene.settings.background;
        let mut pixels = Self { slopes: [Plane::ZERO; 5], rest: Plane::ZERO };
        for row in 0..tile.size[1] {
            let first = (tile.origin[1] + row) * width + tile.origin[0];
            for column in 0..tile.size[0] {
                let pixel = first + column;
                let left = drawing.transmittance[pixel];
                let [red, green, blue] = gradient.colour[pixel];
                let by_depth = gradient.depth_sum_m[pixel];
                // The background shows through 1 - alpha: its part of the loss is a loss by alpha.
                let by_alpha = gradient.alpha[pixel]
                    - (red * background[0] + green * background[1] + blue * background[2]);
                let blended: [f32; 3] = std::array::from_fn(|channel| {
                    drawing.colour[pixel][channel] - left * background[channel]
                });
                let rest = red * blended[0]
                    + green * blended[1]
                    + blue * blended[2]
                    + by_depth * drawing.depth_sum_m[pixel]
                    + by_alpha * (1.0 - left);
                for (plane, slope) in pixels.slopes.iter_mut().zip([red, green, blue, by_depth, by_alpha]) {
                    *plane.at_mut(column, row) = slope;
                }
                *pixels.rest.at_mut(column, row) = rest;
            }
        }
        pixels
    }
}

struct BackwardPass<'a> {
    scene: &'a ProjectedScene<'a>,
    tile: Tile<'a>,
    drawing: &'a Drawing,
    gradient: &'a DrawingGradient,
    /// By index of a Gaussian; none: all are.
    trainable: Option<&'a [bool]>,
    /// [`GRADIENT_SUMS`] for each Gaussian of the tile.
    sums: &'a mut [f32],
}

impl Kernel for BackwardPass<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let zero = f32x8::splat(simd, 0.0);
        let PixelGradients { slopes, mut rest } =
            PixelGradients::new(self.scene, &self.tile, self.drawing, self.gradient);
        let mut visitor = BackwardVisitor {
            slopes: &slopes,
            rest: &mut rest,
            alpha_max: self.scene.limits.alpha_max,
            left_edge: self.tile.origin[0],
            trainable: self.trainable,
            is_trainable: true,
            axis_swap: None,
            shown: [zero; 4],
            running: [zero; GRADIENT_SUMS],
            sums: self.sums,
        };
        blend_tile(simd, self.tile, self.scene.limits, &mut self.tile.transmittance(), &mut visitor);
    }
}

/// From the (u, v) of [`blend_tile`] to those of a Gaussian that lies along the rows.
struct AxisSwap<S: Simd> {
    cos: f32x8<S>,
    sin: f32x8<S>,
    /// The turned v of all columns: of the left half of the tile, of the right half.
    columns: [f32x8<S>; 2],
}

impl<S: Simd> AxisSwap<S> {
    /// None for most Gaussians.
    #[inline(always)]
    fn new(simd: S, splat2d: &Splat2d, left_edge: usize) -> Option<Self> {
        if !splat2d.is_row_aligned() {
            return None;
        }
        let [xx, xy, yy] = splat2d.conic_factor;
        let turned = splat2d.axes().conic_factor[2];
        let column = |half: usize, lane: usize| {
            // In f64: what is left of u and v has no digits for the place along the Gaussian.
            (turned * ((left_edge + half * LANES + lane) as f64 - splat2d.mean[0])) as f32
        };
        let half = |half: usize| {
            let mut lanes = [0.0; LANES];
            for (lane, value) in lanes.iter_mut().enumerate() {
                *value = column(half, lane);
            }
            f32x8::simd_from(simd, lanes)
        };
        Some(Self {
            cos: f32x8::splat(simd, (turned / xx) as f32),
            sin: f32x8::splat(simd, (-turned * xy / (xx * yy)) as f32),
            columns: [half(0), half(1)],
        })
    }
}

struct BackwardVisitor<'a, S: Simd> {
    /// See [`PixelGradients`].
    slopes: &'a [Plane; 5],
    rest: &'a mut Plane,
    alpha_max: f32,
    /// First column of the tile.
    left_edge: usize,
    /// See [`BackwardPass`].
    trainable: Option<&'a [bool]>,
    /// Whether the current Gaussian does.
    is_trainable: bool,
    axis_swap: Option<AxisSwap<S>>,
    /// Red, green, blue, depth of the current Gaussian.
    shown: [f32x8<S>; 4],
    running: [f32x8<S>; GRADIENT_SUMS],
    sums: &'a mut [f32],
}

impl<S: Simd> Visitor<S> for BackwardVisitor<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, splat2d: &Splat2d) {
        let [red, green, blue] = splat2d.colour;
        self.shown = [
            f32x8::splat(simd, red),
            f32x8::splat(simd, green),
            f32x8::splat(simd, blue),
            f32x8::splat(simd, splat2d.depth),
        ];
        self.is_trainable = self.trainable.is_none_or(|trainable| trainable[splat2d.index as usize]);
        self.axis_swap = AxisSwap::new(simd, splat2d, self.left_edge);
        self.running = [f32x8::splat(simd, 0.0); GRADIENT_SUMS];
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: BlendStep<S>) {
        // Derivative by this Gaussian's weight.
        let mut by_weight = self.slopes[4].load(simd, group);
        for channel in 0..4 {
            by_weight = self.slopes[channel].load(simd, group).mul_add(self.shown[channel], by_weight);
        }
        let shown = step.weight * by_weight;
        let behind = self.rest.load(simd, group) - shown;
        self.rest.store(group, behind);
        if !self.is_trainable {
            return;
        }
        for channel in 0..4 {
            let slope = self.slopes[channel].load(simd, group);
            self.running[channel] = step.weight.mul_add(slope, self.running[channel]);
        }
        let alpha = step.alpha;
        let lost = behind * (alpha / (f32x8::splat(simd, 1.0) - alpha));
        let open = step.open & alpha.simd_lt(self.alpha_max);
        let by_log_alpha = open.select(shown - lost, f32x8::splat(simd, 0.0));
        let (u, v) = match &self.axis_swap {
            None => (step.u, f32x8::splat(simd, step.v)),
            Some(axis_swap) => {
                let u = axis_swap.cos.mul_sub(f32x8::splat(simd, step.v), axis_swap.sin * step.u);
                (u, axis_swap.columns[group / TILE % 2])
            }
        };
        let (along, across) = (by_log_alpha * u, by_log_alpha * v);
        self.running[4] += by_log_alpha;
        self.running[5] += along;
        self.running[6] += across;
        self.running[7] = along.mul_add(u, self.running[7]);
        self.running[8] = along.mul_add(v, self.running[8]);
        self.running[9] = across.mul_add(v, self.running[9]);
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, entry: usize) {
        let sums = &mut self.sums[entry * GRADIENT_SUMS..][..GRADIENT_SUMS];
        for (sum, running) in sums.iter_mut().zip(self.running) {
            // In a fixed order, the same on all machines with these instructions.
            let (low, high) = running.split();
            let halves = low + high;
            *sum = (halves[0] + halves[2]) + (halves[1] + halves[3]);
        }
    }
}
