//! The planes of a HexPlane: their shapes, their place in memory, and how a list of rows is looked up in them and
//! its gradient spread back.

use rayon::prelude::*;

use super::bounds::Bounds;
use super::config::DeformConfig;
use super::sample::{FACTORS, LevelAt, scatter_add};

/// The two axes of each plane of a level, of x, y, z, t = 0, 1, 2, 3: the first runs along a row of texels.
pub(super) const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

/// Place of each pair's sample among the factors of a feature: planes in space come first there.
const FACTOR_OF_PAIR: [usize; FACTORS] = [0, 1, 3, 2, 4, 5];

/// Samples of a function of two of the four axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plane {
    /// Texels along the first axis of the pair.
    pub(crate) columns: usize,
    /// Texels along the second axis of the pair: time, where the pair has it.
    pub(crate) rows: usize,
    /// Numbers of a texel.
    pub(crate) channels: usize,
    /// Whether the second axis is time.
    pub(crate) has_time: bool,
    /// Row after row; the channels of a texel are adjacent, since they are always read together.
    pub(crate) texels: Vec<f32>,
}

impl Plane {
    pub(super) fn texel(&self, column: usize, row: usize) -> &[f32] {
        let start = (row * self.columns + column) * self.channels;
        &self.texels[start..start + self.channels]
    }

    pub(super) fn texel_mut(&mut self, column: usize, row: usize) -> &mut [f32] {
        let start = (row * self.columns + column) * self.channels;
        &mut self.texels[start..start + self.channels]
    }
}

/// All planes, or their gradient.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    /// Six planes a level, in the order of [`PAIRS`].
    pub(crate) levels: Vec<[Plane; 6]>,
    channels: usize,
}

impl Grid {
    pub(super) fn zeros(config: &DeformConfig) -> Self {
        let channels = config.channels;
        let plane = |axes: [usize; 4], pair: usize| {
            let (first, second) = PAIRS[pair];
            let (columns, rows) = (axes[first], axes[second]);
            let texels = vec![0.0; columns * rows * channels];
            Plane { columns, rows, channels, has_time: second == 3, texels }
        };
        let level = |&multiplier: &u32| {
            let axes = config.axes(multiplier);
            std::array::from_fn(|pair| plane(axes, pair))
        };
        Self { levels: config.multires.iter().map(level).collect(), channels }
    }

    pub(crate) fn planes(&self) -> impl Iterator<Item = &Plane> {
        self.levels.iter().flatten()
    }

    pub(crate) fn planes_mut(&mut self) -> impl Iterator<Item = &mut Plane> {
        self.levels.iter_mut().flatten()
    }

    /// The planes as far as one time needs them.
    pub(super) fn at(&self, time_coordinate: f32) -> GridAt<'_> {
        let levels = self.levels.iter().map(|planes| LevelAt::new(planes, time_coordinate)).collect();
        GridAt { levels, channels: self.channels }
    }
}

/// All planes with their time axis fixed.
pub(super) struct GridAt<'a> {
    levels: Vec<LevelAt<'a>>,
    channels: usize,
}

impl GridAt<'_> {
    /// Numbers that a row is described by.
    pub(super) fn features(&self) -> usize {
        self.levels.len() * self.channels
    }

    /// Numbers per row in what [`Self::backward`] hands to [`Self::scatter_add`].
    pub(super) fn sample_gradients(&self) -> usize {
        self.features() * FACTORS
    }

    /// Features of each position: the product over the six planes of a level, level after level.
    pub(super) fn features_of(&self, bounds: &Bounds, positions: &[[f32; 3]], features: &mut [f32]) {
        for (&position, features) in positions.iter().zip(features.chunks_exact_mut(self.features())) {
            let coordinates = bounds.coordinates(position);
            for (level, features) in self.levels.iter().zip(features.chunks_exact_mut(self.channels)) {
                level.product(coordinates, features);
            }
        }
    }

    /// From the gradient of the features to those of the positions and of every plane's sample at each position.
    pub(super) fn backward(
        &self,
        bounds: &Bounds,
        positions: &[[f32; 3]],
        feature_gradients: &[f32],
        position_gradients: &mut [[f32; 3]],
        sample_gradients: &mut [f32],
    ) {
        let rows = positions.iter().zip(position_gradients);
        let gradients = feature_gradients.chunks_exact(self.features());
        let samples = sample_gradients.chunks_exact_mut(self.sample_gradients());
        for (((&position, slope), upstream), samples) in rows.zip(gradients).zip(samples) {
            let coordinates = bounds.coordinates(position);
            let mut along = [0.0; 3];
            let upstream = upstream.chunks_exact(self.channels);
            let samples = samples.chunks_exact_mut(self.channels * FACTORS);
            for ((level, upstream), samples) in self.levels.iter().zip(upstream).zip(samples) {
                level.backward(coordinates, upstream, samples, &mut along);
            }
            *slope = std::array::from_fn(|axis| along[axis] * bounds.scale()[axis]);
        }
    }

    /// Adds every sample's gradient to the texels that it was read from.
    ///
    /// One task per plane goes over the rows in their order, so that no two tasks write to a plane and sums are taken in
    /// one order.
    pub(super) fn scatter_add(
        &self,
        bounds: &Bounds,
        positions: &[[f32; 3]],
        sample_gradients: &[f32],
        into: &mut Grid,
    ) {
        let stride = self.sample_gradients();
        let planes =
            into.levels.iter_mut().zip(&self.levels).enumerate().flat_map(|(index, (planes, level))| {
                let place = move |factor| (index * FACTORS + factor) * self.channels;
                let task = move |(plane, factor)| (level, factor, place(factor), plane);
                planes.iter_mut().zip(FACTOR_OF_PAIR).map(task)
            });
        planes.collect::<Vec<_>>().into_par_iter().for_each(|(level, factor, start, plane)| {
            let rows = positions.iter().zip(sample_gradients.chunks_exact(stride));
            let rows = rows.map(|(&at, row)| (bounds.coordinates(at), &row[start..start + self.channels]));
            scatter_add(level, factor, rows, plane);
        });
    }
}
