//! Feature splatting and its transpose: numbers from Gaussians to pixels, and from pixels to Gaussians.

use fearless_simd::{f32x8, prelude::*};
use rayon::prelude::*;

use super::blend::{BlendStep, LANES, Plane, Tile, Visitor, blend_tile};
use super::projection::Splat2d;
use super::{Kernel, ProjectedScene};
use crate::raster::TILE;

/// Channels per pass over the tiles: bounds the memory of many channels.
const CHANNELS: usize = 16;

/// Features to pixels, `channels` each.
pub(super) fn splat_features(scene: &ProjectedScene<'_>, features: &[f32], channels: usize) -> Vec<f32> {
    let mut pixels = vec![0.0; scene.view.pixel_count() * channels];
    for first in (0..channels).step_by(CHANNELS) {
        let block = first..channels.min(first + CHANNELS);
        let planes: Vec<Vec<Plane>> = (0..scene.bins.len())
            .into_par_iter()
            .map(|index| {
                let mut planes = vec![Plane::ZERO; block.len()];
                let (tile, planes_mut) = (scene.tile(index), planes.as_mut_slice());
                scene.cpu.run(SplatFeatures {
                    scene,
                    tile,
                    planes: planes_mut,
                    features,
                    channels,
                    first,
                    index: 0,
                });
                planes
            })
            .collect();
        let row_length = scene.view.width() as usize * channels;
        pixels.par_chunks_mut(row_length).enumerate().for_each(|(row, values)| {
            let tiles = &planes[row / TILE * scene.bins.columns..];
            for (column, pixel) in values.chunks_exact_mut(channels).enumerate() {
                for (value, plane) in pixel[block.clone()].iter_mut().zip(&tiles[column / TILE]) {
                    *value = plane.at(column % TILE, row % TILE);
                }
            }
        });
    }
    pixels
}

/// Pixels to Gaussians, `channels` each.
pub(super) fn gather_features(scene: &ProjectedScene<'_>, pixels: &[f32], channels: usize) -> Vec<f32> {
    let mut features = vec![0.0; scene.splats.len() * channels];
    for first in (0..channels).step_by(CHANNELS) {
        let block = first..channels.min(first + CHANNELS);
        let totals = scene.bins.sums(block.len(), scene.splats2d.len(), |index, sums| {
            let tile = scene.tile(index);
            let planes: Vec<Plane> =
                block.clone().map(|channel| channel_plane(scene, &tile, pixels, channels, channel)).collect();
            let running = [[0.0; LANES]; CHANNELS];
            scene.cpu.run(GatherFeatures { scene, tile, planes: &planes, sums, running });
        });
        for (splat2d, total) in scene.splats2d.iter().zip(totals.chunks_exact(block.len())) {
            let feature = &mut features[splat2d.index as usize * channels..][..channels];
            for (value, &total) in feature[block.clone()].iter_mut().zip(total) {
                *value = total as f32;
            }
        }
    }
    features
}

/// One channel of the pixels of a tile.
fn channel_plane(
    scene: &ProjectedScene<'_>,
    tile: &Tile<'_>,
    pixels: &[f32],
    channels: usize,
    channel: usize,
) -> Plane {
    let width = scene.view.width() as usize;
    let mut plane = Plane::ZERO;
    for row in 0..tile.size[1] {
        let first = (tile.origin[1] + row) * width + tile.origin[0];
        for column in 0..tile.size[0] {
            *plane.at_mut(column, row) = pixels[(first + column) * channels + channel];
        }
    }
    plane
}

struct SplatFeatures<'a> {
    scene: &'a ProjectedScene<'a>,
    tile: Tile<'a>,
    planes: &'a mut [Plane],
    features: &'a [f32],
    channels: usize,
    first: usize,
    /// The Gaussian being blended.
    index: usize,
}

impl Kernel for SplatFeatures<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        blend_tile(simd, self.tile, self.scene.limits, &mut self.tile.transmittance(), &mut self);
    }
}

impl<S: Simd> Visitor<S> for SplatFeatures<'_> {
    #[inline(always)]
    fn begin(&mut self, _simd: S, splat2d: &Splat2d) {
        self.index = splat2d.index as usize;
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: BlendStep<S>) {
        let values = &self.features[self.index * self.channels + self.first..];
        for (plane, &feature) in self.planes.iter_mut().zip(values) {
            plane.add_product(simd, group, step.weight, f32x8::splat(simd, feature));
        }
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, _entry: usize) {}
}

struct GatherFeatures<'a> {
    scene: &'a ProjectedScene<'a>,
    tile: Tile<'a>,
    /// One plane per channel.
    planes: &'a [Plane],
    /// For each Gaussian of the tile its sum of each channel.
    sums: &'a mut [f32],
    running: [[f32; LANES]; CHANNELS],
}

impl Kernel for GatherFeatures<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        blend_tile(simd, self.tile, self.scene.limits, &mut self.tile.transmittance(), &mut self);
    }
}

impl<S: Simd> Visitor<S> for GatherFeatures<'_> {
    #[inline(always)]
    fn begin(&mut self, _simd: S, _footprint: &Splat2d) {
        self.running = [[0.0; LANES]; CHANNELS];
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: BlendStep<S>) {
        for (running, plane) in self.running.iter_mut().zip(self.planes) {
            let sum = step.weight.mul_add(plane.load(simd, group), f32x8::load_array_ref(simd, running));
            sum.store_array(running);
        }
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, entry: usize) {
        let channels = self.planes.len();
        for (sum, running) in self.sums[entry * channels..][..channels].iter_mut().zip(self.running) {
            *sum = running.iter().sum();
        }
    }
}
