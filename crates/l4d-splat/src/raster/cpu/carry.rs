//! Blend weights put to other uses than colour: numbers from Gaussians to pixels, and from pixels to Gaussians.

use fearless_simd::{f32x8, prelude::*};
use rayon::prelude::*;

use super::lens::Footprint;
use super::walk::{GROUPS, LANES, Plane, Step, Tile, Visitor, walk};
use super::{Kernel, Scene};
use crate::raster::{Contribution, TILE};

/// Channels carried by one walk over the tiles: bounds the memory of many channels.
const CHANNELS: usize = 16;

/// Features to pixels, `channels` each.
pub(super) fn spread(scene: &Scene<'_>, features: &[f32], channels: usize) -> Vec<f32> {
    let mut pixels = vec![0.0; scene.view.pixel_count() * channels];
    for first in (0..channels).step_by(CHANNELS) {
        let block = first..channels.min(first + CHANNELS);
        let planes: Vec<Vec<Plane>> = (0..scene.bins.len())
            .into_par_iter()
            .map(|index| {
                let mut planes = vec![Plane::ZERO; block.len()];
                let spread = Spread { planes: &mut planes, features, channels, first, index: 0 };
                scene.cpu.run(Carry { scene, tile: scene.tile(index), visitor: spread });
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
pub(super) fn gather(scene: &Scene<'_>, pixels: &[f32], channels: usize) -> Vec<f32> {
    let mut features = vec![0.0; scene.splats.len() * channels];
    for first in (0..channels).step_by(CHANNELS) {
        let block = first..channels.min(first + CHANNELS);
        let totals = scene.bins.sums(block.len(), scene.footprints.len(), |index, sums| {
            let tile = scene.tile(index);
            let held: Vec<Plane> =
                block.clone().map(|channel| held(scene, &tile, pixels, channels, channel)).collect();
            let gather = Gather { held: &held, sums, running: [[0.0; LANES]; CHANNELS] };
            scene.cpu.run(Carry { scene, tile, visitor: gather });
        });
        for (footprint, total) in scene.footprints.iter().zip(totals.chunks_exact(block.len())) {
            let feature = &mut features[footprint.index as usize * channels..][..channels];
            for (value, &total) in feature[block.clone()].iter_mut().zip(total) {
                *value = total as f32;
            }
        }
    }
    features
}

/// One channel of the pixels of a tile.
fn held(scene: &Scene<'_>, tile: &Tile<'_>, pixels: &[f32], channels: usize, channel: usize) -> Plane {
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

/// Who shows in one pixel.
pub(super) fn contributors(scene: &Scene<'_>, column: usize, row: usize) -> Vec<Contribution> {
    let tile = scene.tile(row / TILE * scene.bins.columns + column / TILE);
    let (x, y) = (column % TILE, row % TILE);
    let mut list = Vec::new();
    let record = Record { group: x / LANES * TILE + y, lane: x % LANES, index: 0, list: &mut list };
    scene.cpu.run(Carry { scene, tile, visitor: record });
    list
}

/// Work of a walk that isn't bound to instructions until it runs.
trait Bound {
    /// Groups of pixels that the visitor wants to see.
    fn groups(&self) -> u32 {
        u32::MAX
    }

    fn begin(&mut self, entry: usize, footprint: &Footprint);

    fn blend<S: Simd>(&mut self, simd: S, group: usize, weight: f32x8<S>);

    fn end(&mut self, entry: usize);
}

struct Carry<'a, B> {
    scene: &'a Scene<'a>,
    tile: Tile<'a>,
    visitor: B,
}

impl<B: Bound> Kernel for Carry<'_, B> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let groups = self.tile.groups() & self.visitor.groups();
        let mut transmittance = self.tile.transmittance();
        walk(simd, self.tile, self.scene.limits, &mut transmittance, groups, &mut Weights(&mut self.visitor));
    }
}

struct Weights<'a, B>(&'a mut B);

impl<S: Simd, B: Bound> Visitor<S> for Weights<'_, B> {
    #[inline(always)]
    fn begin(&mut self, _simd: S, entry: usize, footprint: &Footprint) {
        self.0.begin(entry, footprint);
    }

    #[inline(always)]
    fn blend(&mut self, simd: S, group: usize, step: Step<S>) {
        self.0.blend(simd, group, step.weight);
    }

    #[inline(always)]
    fn end(&mut self, _simd: S, entry: usize) {
        self.0.end(entry);
    }
}

struct Spread<'a> {
    planes: &'a mut [Plane],
    features: &'a [f32],
    channels: usize,
    first: usize,
    /// The Gaussian being blended.
    index: usize,
}

impl Bound for Spread<'_> {
    #[inline(always)]
    fn begin(&mut self, _entry: usize, footprint: &Footprint) {
        self.index = footprint.index as usize;
    }

    #[inline(always)]
    fn blend<S: Simd>(&mut self, simd: S, group: usize, weight: f32x8<S>) {
        let carried = &self.features[self.index * self.channels + self.first..];
        for (plane, &feature) in self.planes.iter_mut().zip(carried) {
            plane.add_product(simd, group, weight, f32x8::splat(simd, feature));
        }
    }

    #[inline(always)]
    fn end(&mut self, _entry: usize) {}
}

struct Gather<'a> {
    /// One plane a channel.
    held: &'a [Plane],
    /// For each Gaussian of the tile its sum of each channel.
    sums: &'a mut [f32],
    running: [[f32; LANES]; CHANNELS],
}

impl Bound for Gather<'_> {
    #[inline(always)]
    fn begin(&mut self, _entry: usize, _footprint: &Footprint) {
        self.running = [[0.0; LANES]; CHANNELS];
    }

    #[inline(always)]
    fn blend<S: Simd>(&mut self, simd: S, group: usize, weight: f32x8<S>) {
        for (running, plane) in self.running.iter_mut().zip(self.held) {
            let sum = weight.mul_add(plane.load(simd, group), f32x8::load_array_ref(simd, running));
            sum.store_array(running);
        }
    }

    #[inline(always)]
    fn end(&mut self, entry: usize) {
        let channels = self.held.len();
        for (sum, running) in self.sums[entry * channels..][..channels].iter_mut().zip(self.running) {
            *sum = running.iter().sum();
        }
    }
}

struct Record<'a> {
    group: usize,
    lane: usize,
    index: u32,
    list: &'a mut Vec<Contribution>,
}

impl Bound for Record<'_> {
    fn groups(&self) -> u32 {
        1 << (self.group % GROUPS)
    }

    #[inline(always)]
    fn begin(&mut self, _entry: usize, footprint: &Footprint) {
        self.index = footprint.index;
    }

    #[inline(always)]
    fn blend<S: Simd>(&mut self, _simd: S, _group: usize, weight: f32x8<S>) {
        let weight = weight[self.lane];
        if weight > 0.0 {
            self.list.push(Contribution { index: self.index, weight });
        }
    }

    #[inline(always)]
    fn end(&mut self, _entry: usize) {}
}
