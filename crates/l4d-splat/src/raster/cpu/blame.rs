//! Backward over pixels: how much of a picture's error each Gaussian is to blame for, as sums over its pixels.
//!
//! Front to back like the drawing itself. What lies behind a Gaussian is worth what the whole pixel is worth less
//! what has been blended so far: nothing is divided by a transmittance, and one number a pixel is carried along.

use fearless_simd::{Select as _, f32x8, prelude::*};

use super::lens::Footprint;
use super::walk::{LANES, Plane, Step, Tile, Visitor, walk};
use super::{Kernel, Scene};
use crate::raster::{Drawing, DrawingGradient, TILE};

/// Numbers in [`Moments`].
pub(super) const MOMENTS: usize = 10;

/// Of one Gaussian, summed over pixels: derivative by colour (3), by depth, and, each weighted with the derivative by
/// the natural logarithm of alpha: 1, u, v, u^2, uv, v^2 (see [`Footprint::axes`]).
pub(super) type Moments = [f64; MOMENTS];

/// The moments of the visible Gaussians, front to back; zero for those that do not learn.
pub(super) fn moments(
    scene: &Scene<'_>,
    drawing: &Drawing,
    gradient: &DrawingGradient,
    learning: Option<&[bool]>,
) -> Vec<Moments> {
    let totals = scene.bins.sums(MOMENTS, scene.footprints.len(), |index, sums| {
        if sums.is_empty() {
            return;
        }
        scene.cpu.run(Blame { scene, tile: scene.tile(index), drawing, gradient, learning, sums });
    });
    totals.as_chunks().0.to_vec()
}

/// What the pixels of a tile want.
struct Wishes {
    /// Derivatives of the loss by red, green, blue, summed depth and alpha.
    slopes: [Plane; 5],
    /// Loss that is still to be blended: at first that of the whole pixel, without the background.
    rest: Plane,
}

impl Wishes {
    fn new(scene: &Scene<'_>, tile: &Tile<'_>, drawing: &Drawing, gradient: &DrawingGradient) -> Self {
        let width = scene.view.width() as usize;
        let background = scene.settings.background;
        let mut wishes = Self { slopes: [Plane::ZERO; 5], rest: Plane::ZERO };
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
                for (plane, slope) in wishes.slopes.iter_mut().zip([red, green, blue, by_depth, by_alpha]) {
                    *plane.at_mut(column, row) = slope;
                }
                *wishes.rest.at_mut(column, row) = rest;
            }
        }
        wishes
    }
}

struct Blame<'a> {
    scene: &'a Scene<'a>,
    tile: Tile<'a>,
    drawing: &'a Drawing,
    gradient: &'a DrawingGradient,
    /// By index of a Gaussian; all do without it.
    learning: Option<&'a [bool]>,
    /// [`MOMENTS`] for each Gaussian of the tile.
    sums: &'a mut [f32],
}

impl Kernel for Blame<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let zero = f32x8::splat(simd, 0.0);
        let Wishes { slopes, mut rest } = Wishes::new(self.scene, &self.tile, self.drawing, self.gradient);
        let mut judge = Judge {
            slopes: &slopes,
            rest: &mut rest,
            alpha_max: self.scene.limits.alpha_max,
            left_edge: self.tile.origin[0],
            learning: self.learning,
            learns: true,
            turn: None,
            shown: [zero; 4],
            running: [zero; MOMENTS],
            sums: self.sums,
        };
        let groups = self.tile.groups();
        let mut transmittance = self.tile.transmittance();
        walk(simd, self.tile, self.scene.limits, &mut transmittance, groups, &mut judge);
    }
}

/// From the (u, v) of the walk to those of a Gaussian that lies along the rows.
struct Turn<S: Simd> {
    cos: f32x8<S>,
    sin: f32x8<S>,
    /// The turned v of all columns: of the left half of the tile, of the right half.
    columns: [f32x8<S>; 2],
}

impl<S: Simd> Turn<S> {
    /// None for most Gaussians.
    #[inline(always)]
    fn new(simd: S, footprint: &Footprint, left_edge: usize) -> Option<Self> {
        if !footprint.lies() {
            return None;
        }
        let [xx, xy, yy] = footprint.whitening;
        let turned = footprint.axes().whitening[2];
        let column = |half: usize, lane: usize| {
            // In f64: what is left of u and v of the walk has no digits for the place along the Gaussian.
            (turned * ((left_edge + half * LANES + lane) as f64 - footprint.mean[0])) as f32
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

struct Judge<'a, S: Simd> {
    /// See [`Wishes`].
    slopes: &'a [Plane; 5],
    rest: &'a mut Plane,
    alpha_max: f32,
    /// First column of the tile.
    left_edge: usize,
    /// See [`Blame`].
    learning: Option<&'a [bool]>,
    /// Whether the current Gaussian does.
    learns: bool,
    turn: Option<Turn<S>>,
    /// Red, green, blue, depth of the current Gaussian.
    shown: [f32x8<S>; 4],
    running: [f32x8<S>; MOMENTS],
    sums: &'a mut [f32],
}

impl<S: Simd> Visitor<S> for Judge<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, _entry: usize, footprint: &Footprint) {
        let [red, green, blue] = footprint.colour;
        self.shown = [
            f32x8::splat(simd, red),
            f32x8::splat(simd, green),
            f32x8::splat(simd, blue),
            f32x8::splat(simd, footprint.depth),
        ];
        self.learns = self.learning.is_none_or(|learning| learning[footprint.index as usize]);
        self.turn = Turn::new(simd, footprint, self.left_edge);
        self.running = [f32x8::splat(simd, 0.0); MOMENTS];
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: Step<S>) {
        // What a unit of this Gaussian's light is worth.
        let mut worth = self.slopes[4].load(simd, group);
        for channel in 0..4 {
            worth = self.slopes[channel].load(simd, group).mul_add(self.shown[channel], worth);
        }
        let shown = step.weight * worth;
        let behind = self.rest.load(simd, group) - shown;
        self.rest.store(group, behind);
        if !self.learns {
            return;
        }
        for channel in 0..4 {
            let slope = self.slopes[channel].load(simd, group);
            self.running[channel] = step.weight.mul_add(slope, self.running[channel]);
        }
        let alpha = step.alpha;
        let lost = behind * (alpha / (f32x8::splat(simd, 1.0) - alpha));
        let open = step.open & alpha.simd_lt(self.alpha_max);
        let blame = open.select(shown - lost, f32x8::splat(simd, 0.0));
        let (u, v) = match &self.turn {
            None => (step.u, f32x8::splat(simd, step.v)),
            Some(turn) => {
                let u = turn.cos.mul_sub(f32x8::splat(simd, step.v), turn.sin * step.u);
                (u, turn.columns[group / TILE % 2])
            }
        };
        let (along, across) = (blame * u, blame * v);
        self.running[4] += blame;
        self.running[5] += along;
        self.running[6] += across;
        self.running[7] = along.mul_add(u, self.running[7]);
        self.running[8] = along.mul_add(v, self.running[8]);
        self.running[9] = across.mul_add(v, self.running[9]);
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, entry: usize) {
        let sums = &mut self.sums[entry * MOMENTS..][..MOMENTS];
        for (sum, running) in sums.iter_mut().zip(self.running) {
            // In a fixed order, the same on all machines with these instructions.
            let (low, high) = running.split();
            let halves = low + high;
            *sum = (halves[0] + halves[2]) + (halves[1] + halves[3]);
        }
    }
}
