//! The inner loop: the Gaussians of one tile over its pixels, front to back.
//!
//! Owns the order of the tests, once for all that is done with weights ([`Visitor`]). A tile is 32 groups of 8
//! pixels side by side: group g holds columns 8 (g / 16) to 8 (g / 16) + 7 of row g mod 16.
//!
//! What runs per pixel has no `map` over arrays of vectors: such closures are compiled without the wide instructions
//! and called.

use fearless_simd::{Select as _, f32x8, mask32x8, prelude::*};

use super::pixel_mask::TileMask;
use super::projection::Splat2d;
use crate::raster::{RasterSettings, TILE};

/// Pixels that are computed at once.
pub(super) const LANES: usize = 8;
/// Groups of pixels in a tile.
pub(super) const GROUPS: usize = TILE * TILE / LANES;

/// By how much the ellipse is widened in which pixels are looked at, in units of the exponent in base 2: more than
/// its rounding errors, so that no pixel is missed that passes the test of alpha.
const SLACK: f64 = 1e-3;

/// One number for each pixel of a tile.
#[derive(Debug, Clone)]
#[repr(C, align(32))]
pub(super) struct Plane(pub(super) [[f32; LANES]; GROUPS]);

impl Plane {
    pub(super) const ZERO: Self = Self([[0.0; LANES]; GROUPS]);

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, group: usize) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.0[group])
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, group: usize, values: f32x8<S>) {
        values.store_array(&mut self.0[group]);
    }

    #[inline(always)]
    pub(super) fn add_product<S: Simd>(&mut self, simd: S, group: usize, a: f32x8<S>, b: f32x8<S>) {
        let sum = a.mul_add(b, self.load(simd, group));
        self.store(group, sum);
    }

    /// The number of the pixel in `column` and `row` of the tile.
    pub(super) fn at(&self, column: usize, row: usize) -> f32 {
        self.0[column / LANES * TILE + row][column % LANES]
    }

    pub(super) fn at_mut(&mut self, column: usize, row: usize) -> &mut f32 {
        &mut self.0[column / LANES * TILE + row][column % LANES]
    }
}

/// The thresholds of blending.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) alpha_min: f32,
    pub(super) alpha_max: f32,
    pub(super) transmittance_min: f32,
    /// Base 2: how far alpha may fall from 1 until it is too small, and a little more.
    pub(super) span: f32,
}

impl Limits {
    pub(super) fn new(settings: &RasterSettings) -> Self {
        Self {
            alpha_min: settings.alpha_min,
            alpha_max: settings.alpha_max,
            transmittance_min: settings.transmittance_min,
            span: (SLACK - f64::from(settings.alpha_min).log2()) as f32,
        }
    }
}

/// The part of a picture that one call of [`blend_tile`] covers.
#[derive(Clone, Copy)]
pub(super) struct Tile<'a> {
    /// Visible Gaussians, front to back.
    pub(super) splats2d: &'a [Splat2d],
    /// Those of this tile.
    pub(super) ranks: &'a [u32],
    /// Upper left pixel: column, row.
    pub(super) origin: [usize; 2],
    /// Pixels of the tile that lie in the picture: columns, rows.
    pub(super) size: [usize; 2],
    /// Those that are drawn.
    pub(super) mask: &'a TileMask,
}

impl Tile<'_> {
    /// Transmittance before anything is blended; pixels that are not drawn are finished from the start.
    pub(super) fn transmittance(&self) -> Plane {
        let mut plane = Plane([[-1.0; LANES]; GROUPS]);
        for (row, mask) in self.mask.iter().enumerate() {
            for column in (0..TILE).filter(|column| mask >> column & 1 == 1) {
                *plane.at_mut(column, row) = 1.0;
            }
        }
        plane
    }

    /// A bit for each group with a pixel that is drawn.
    fn groups(&self) -> u32 {
        self.mask.iter().enumerate().fold(0, |groups, (row, mask)| {
            let [left, right] = [mask & 0xff, mask >> LANES].map(|half| u32::from(half != 0));
            groups | left << row | right << (TILE + row)
        })
    }
}

/// One Gaussian over one group of pixels.
pub(super) struct BlendStep<S: Simd> {
    /// 0 where it is too small to be blended.
    pub(super) alpha: f32x8<S>,
    /// Transmittance in front; negative where the pixel is finished.
    pub(super) before: f32x8<S>,
    /// Where the pixel is not finished.
    pub(super) open: mask32x8<S>,
    /// Blend weight, 0 where nothing is blended.
    pub(super) weight: f32x8<S>,
    /// Offset from the Gaussian's centre, whitened (see [`Splat2d::conic_factor`]).
    pub(super) u: f32x8<S>,
    /// The same for all pixels of a row.
    pub(super) v: f32,
}

/// What is done with the weights.
pub(super) trait Visitor<S: Simd> {
    /// A Gaussian that may show in the tile.
    fn begin(&mut self, simd: S, splat2d: &Splat2d);
    /// One group of pixels of that Gaussian.
    fn blend(&mut self, simd: S, group: usize, step: BlendStep<S>);
    /// All groups of that Gaussian have been visited: its position in the tile's list.
    fn end(&mut self, simd: S, entry: usize);
}

/// Terms of a Gaussian that are the same along a row of pixels.
struct RowTerms {
    /// Whitened offset u at the left edge of the tile.
    u: [f32; TILE],
    v: [f32; TILE],
    /// Exponent of alpha in base 2 where u is 0.
    crest: [f32; TILE],
    /// Groups in which alpha can be large enough.
    touched: u32,
}

impl RowTerms {
    /// Also returns the change of u from a pixel to its right neighbour.
    #[inline(always)]
    fn new<S: Simd>(simd: S, splat2d: &Splat2d, origin: [usize; 2], span: f32) -> (Self, f32) {
        let [xx, xy, yy] = splat2d.conic_factor;
        let dx = origin[0] as f64 - splat2d.mean[0];
        let dy = origin[1] as f64 - splat2d.mean[1];
        // In f64 up to the tile's corner: within the tile all terms are small again.
        let (corner_u, corner_v) = ((xx * dx + xy * dy) as f32, (yy * dy) as f32);
        let (across, down_u, down_v) = (xx as f32, xy as f32, yy as f32);
        let splat = |value| f32x8::splat(simd, value);
        let mut rows = Self { u: [0.0; TILE], v: [0.0; TILE], crest: [0.0; TILE], touched: 0 };
        for first in [0, LANES] {
            let y = f32x8::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]) + first as f32;
            let u = y.mul_add(splat(down_u), splat(corner_u));
            let v = y.mul_add(splat(down_v), splat(corner_v));
            let crest = splat(splat2d.log_opacity) - v * v;
            // NaN, and so no comparison is true, where the row passes by the ellipse.
            let reach = (crest + span).sqrt();
            let touched = |from: f32, to: f32| {
                let enters = (u + across * from).simd_le(reach);
                let leaves = (u + across * to).simd_ge(-reach);
                (enters & leaves).to_bitmask() as u32
            };
            rows.touched |= touched(0.0, 7.0) << first | touched(8.0, 15.0) << (TILE + first);
            u.store_slice(&mut rows.u[first..first + LANES]);
            v.store_slice(&mut rows.v[first..first + LANES]);
            crest.store_slice(&mut rows.crest[first..first + LANES]);
        }
        (rows, across)
    }
}

/// Blends the Gaussians of a tile into its pixels, front to back, and shows every step to the visitor. `transmittance` starts as [`Tile::transmittance`]; a finished pixel ends with the sign turned.
#[inline(always)]
pub(super) fn blend_tile<S: Simd, V: Visitor<S>>(
    simd: S,
    tile: Tile<'_>,
    limits: Limits,
    transmittance: &mut Plane,
    visitor: &mut V,
) {
    let mut groups = tile.groups();
    let zero = f32x8::splat(simd, 0.0);
    let one = f32x8::splat(simd, 1.0);
    let left_columns = f32x8::simd_from(simd, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    let right_columns = left_columns + LANES as f32;
    for (entry, &rank) in tile.ranks.iter().enumerate() {
        let splat2d = &tile.splats2d[rank as usize];
        let (rows, across) = RowTerms::new(simd, splat2d, tile.origin, limits.span);
        let mut touched = rows.touched & groups;
        if touched == 0 {
            continue;
        }
        let slopes = [left_columns * across, right_columns * across];
        visitor.begin(simd, splat2d);
        while touched != 0 {
            let group = touched.trailing_zeros() as usize % GROUPS;
            touched &= touched - 1;
            let row = group % TILE;
            let u = slopes[group / TILE] + rows.u[row];
            let fall = u.mul_sub(u, f32x8::splat(simd, rows.crest[row]));
            let peak = super::exp2::exp2_negative(simd, fall).min(limits.alpha_max);
            let alpha = peak.simd_ge(limits.alpha_min).select(peak, zero);
            let before = transmittance.load(simd, group);
            let after = before * (one - alpha);
            let open = after.simd_ge(limits.transmittance_min);
            let weight = open.select(alpha * before, zero);
            let left = open.select(after, -before.abs());
            transmittance.store(group, left);
            visitor.blend(simd, group, BlendStep { alpha, before, open, weight, u, v: rows.v[row] });
            if left.simd_lt(zero).to_bitmask() == 0xff {
                groups &= !(1 << group);
            }
        }
        visitor.end(simd, entry);
        if groups == 0 {
            break;
        }
    }
}
