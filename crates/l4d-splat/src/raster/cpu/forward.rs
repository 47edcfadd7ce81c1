//! Drawing: colour, transmittance and depths of all pixels.

use fearless_simd::{Select as _, f32x8, prelude::*};
use rayon::prelude::*;

use super::blend::{BlendStep, Plane, Tile, Visitor, blend_tile};
use super::projection::Splat2d;
use super::{Kernel, ProjectedScene};
use crate::raster::{DepthQuantiles, Drawing, TILE};

/// A tile's share of the picture.
struct TileImage {
    colour: [Plane; 3],
    depth_sum: Plane,
    /// Empty unless asked for.
    quantiles: Vec<Plane>,
    /// Negative where the pixel was finished.
    transmittance: Plane,
}

struct ForwardVisitor<'a, S: Simd> {
    planes: &'a mut [Plane; 3],
    depth_sum: &'a mut Plane,
    quantiles: &'a mut [Plane],
    colour: [f32x8<S>; 3],
    depth: f32x8<S>,
}

impl<S: Simd> Visitor<S> for ForwardVisitor<'_, S> {
    #[inline(always)]
    fn begin(&mut self, simd: S, splat2d: &Splat2d) {
        let [red, green, blue] = splat2d.colour;
        self.colour = [f32x8::splat(simd, red), f32x8::splat(simd, green), f32x8::splat(simd, blue)];
        self.depth = f32x8::splat(simd, splat2d.depth);
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: BlendStep<S>) {
        for channel in 0..3 {
            self.planes[channel].add_product(simd, group, step.weight, self.colour[channel]);
        }
        self.depth_sum.add_product(simd, group, step.weight, self.depth);
        // The last Gaussian with at least this transmittance in front is the one behind which it is less.
        let blended = step.weight.simd_gt(0.0);
        for (plane, level) in self.quantiles.iter_mut().zip(DepthQuantiles::LEVELS) {
            let depth = (blended & step.before.simd_ge(level)).select(self.depth, plane.load(simd, group));
            plane.store(group, depth);
        }
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, _entry: usize) {}
}

struct ForwardPass<'a> {
    scene: &'a ProjectedScene<'a>,
    tile: Tile<'a>,
    images: &'a mut TileImage,
}

impl Kernel for ForwardPass<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let zero = f32x8::splat(simd, 0.0);
        let mut visitor = ForwardVisitor {
            planes: &mut self.images.colour,
            depth_sum: &mut self.images.depth_sum,
            quantiles: &mut self.images.quantiles,
            colour: [zero; 3],
            depth: zero,
        };
        blend_tile(simd, self.tile, self.scene.limits, &mut self.images.transmittance, &mut visitor);
    }
}

pub(super) fn draw(scene: &ProjectedScene<'_>) -> Drawing {
    let images: Vec<TileImage> = (0..scene.bins.len())
        .into_par_iter()
        .map(|index| {
            let tile = scene.tile(index);
            let mut images = TileImage {
                colour: [Plane::ZERO; 3],
                depth_sum: Plane::ZERO,
                quantiles: vec![Plane::ZERO; if scene.settings.quantiles { 3 } else { 0 }],
                transmittance: tile.transmittance(),
            };
            scene.cpu.run(ForwardPass { scene, tile, images: &mut images });
            images
        })
        .collect();
    assemble(scene, &images)
}

/// Tiles to rows of pixels.
fn assemble(scene: &ProjectedScene<'_>, images: &[TileImage]) -> Drawing {
    let width = scene.view.width() as usize;
    let pixels = scene.view.pixel_count();
    let [red, green, blue] = scene.settings.background;
    let mut colour = vec![[0.0; 3]; pixels];
    let mut transmittance = vec![0.0; pixels];
    let mut alpha = vec![0.0; pixels];
    let mut depth_sum_m = vec![0.0; pixels];
    (
        colour.par_chunks_mut(width),
        transmittance.par_chunks_mut(width),
        alpha.par_chunks_mut(width),
        depth_sum_m.par_chunks_mut(width),
    )
        .into_par_iter()
        .enumerate()
        .with_min_len(TILE)
        .for_each(|(row, (colour, transmittance, alpha, depth_sum))| {
            let tiles = &images[row / TILE * scene.bins.columns..];
            for (column, colour) in colour.iter_mut().enumerate() {
                let tile = &tiles[column / TILE];
                let (x, y) = (column % TILE, row % TILE);
                let left = tile.transmittance.at(x, y).abs();
                let [r, g, b] = &tile.colour;
                *colour = [r.at(x, y) + left * red, g.at(x, y) + left * green, b.at(x, y) + left * blue];
                transmittance[column] = left;
                alpha[column] = 1.0 - left;
                depth_sum[column] = tile.depth_sum.at(x, y);
            }
        });
    let quantiles = scene.settings.quantiles.then(|| {
        let [near_m, median_m, far_m] = [0, 1, 2].map(|which| quantile(scene, images, which));
        DepthQuantiles { near_m, median_m, far_m }
    });
    Drawing {
        width: scene.view.width(),
        height: scene.view.height(),
        colour,
        alpha,
        transmittance,
        depth_sum_m,
        quantiles,
    }
}

fn quantile(scene: &ProjectedScene<'_>, images: &[TileImage], which: usize) -> Vec<f32> {
    let width = scene.view.width() as usize;
    let level = DepthQuantiles::LEVELS[which];
    let mut depths = vec![0.0; scene.view.pixel_count()];
    depths.par_chunks_mut(width).enumerate().with_min_len(TILE).for_each(|(row, depths)| {
        let tiles = &images[row / TILE * scene.bins.columns..];
        for (column, depth) in depths.iter_mut().enumerate() {
            let tile = &tiles[column / TILE];
            let (x, y) = (column % TILE, row % TILE);
            let reached = tile.transmittance.at(x, y).abs() < level;
            *depth = if reached { tile.quantiles[which].at(x, y) } else { f32::INFINITY };
        }
    });
    depths
}
