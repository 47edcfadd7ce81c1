//! The field itself: built, asked, and derived.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::gaussians::{BadValue, Gaussians};

use super::DeformError;
use super::bounds::Bounds;
use super::config::DeformConfig;
use super::grid::{Grid, GridAt, Plane};
use super::network::{Activations, Network, Scratch, SlicesMut};
use super::offsets::Offsets;

/// Rows of a block: enough for the matrix products to run at full speed, few enough for its intermediate results to
/// stay in a cache of 1 MiB.
const BLOCK_ROWS: usize = 256;

/// Most lists of partial sums that a gradient is collected in. A constant, not the number of threads: sums would
/// come out differently with other cuts.
const MOST_LANES: usize = 16;

/// How the parameters of Gaussians change with time.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformationField {
    config: DeformConfig,
    bounds: Bounds,
    pub(super) grid: Grid,
    pub(super) network: Network,
}

/// Derivatives of a loss by all parameters of a field.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldGradients {
    pub(super) grid: Grid,
    pub(super) network: Network,
}

/// Every parameter once, as lists in a fixed order; planes and layers apart, since they learn at different rates.
#[derive(Debug)]
pub struct Parameters<List> {
    /// Planes: level after level, six each.
    pub planes: Vec<List>,
    /// Weights and biases: of the first layer, then head after head.
    pub layers: Vec<List>,
}

/// What [`DeformationField::backward`] needs of a forward pass: 4 kB per row with the sizes of
/// [`DeformConfig::dynerf`]. Reused, it keeps its memory.
#[derive(Debug, Default)]
pub struct Trace {
    time: f32,
    positions: Vec<[f32; 3]>,
    blocks: Vec<Activations>,
    /// Room for the gradients of the samples.
    samples: Vec<f32>,
}

/// How the layers begin. Planes begin alike: uniform in 0.1..0.5 in space, 1 in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Init {
    /// As 4DGaussians: weights uniform by Xavier's rule, biases uniform within one over the root of the inputs. The
    /// untrained field then moves all Gaussians by almost the same 0.1 to 0.2 units, which has to be unlearned.
    Foreign,
    /// The same, but the last layer of each head is zero: the untrained field changes nothing.
    Identity,
}

impl Init {
    /// Fills planes and layers; the same seed gives the same numbers.
    fn fill(self, grid: &mut Grid, network: &mut Network, seed: u64) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for plane in grid.planes_mut() {
            if plane.has_time {
                plane.texels.fill(1.0);
            } else {
                plane.texels.fill_with(|| random.random_range(0.1..0.5));
            }
        }
        for layer in network.layers_mut() {
            let (inputs, outputs) = (layer.inputs() as f32, layer.outputs() as f32);
            let weight = (6.0 / (inputs + outputs)).sqrt();
            let bias = 1.0 / inputs.sqrt();
            layer.weight.fill_with(|| random.random_range(-weight..weight));
            layer.bias.fill_with(|| random.random_range(-bias..bias));
        }
        if self == Self::Identity {
            for [_, last] in &mut network.heads {
                last.weight.fill(0.0);
                last.bias.fill(0.0);
            }
        }
    }
}

impl DeformationField {
    /// An untrained field.
    ///
    /// # Errors
    /// A configuration that cannot be ([`DeformConfig::validate`]).
    pub fn new(config: DeformConfig, bounds: Bounds, init: Init, seed: u64) -> Result<Self, DeformError> {
        let mut field = Self::zeros(config, bounds)?;
        init.fill(&mut field.grid, &mut field.network, seed);
        Ok(field)
    }

    pub(super) fn zeros(config: DeformConfig, bounds: Bounds) -> Result<Self, DeformError> {
        config.validate()?;
        Ok(Self { grid: Grid::zeros(&config), network: Network::zeros(&config), config, bounds })
    }

    /// Sizes and switches.
    pub fn config(&self) -> &DeformConfig {
        &self.config
    }

    /// The box that the planes resolve.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Offsets of Gaussians with these canonical centres (metres) at a time from 0 to 1.
    ///
    /// # Errors
    /// A position that is not finite and a time outside the clip; an offset that is not finite, which says that the
    /// parameters have diverged.
    pub fn offsets(&self, positions: &[[f32; 3]], time: f32) -> Result<Offsets, DeformError> {
        self.answered(positions, time, |grid, outputs| {
            let blocks = positions.par_chunks(BLOCK_ROWS).zip(outputs);
            blocks.for_each_init(Activations::default, |block, (positions, outputs)| {
                self.evaluate(grid, positions, block, outputs);
            });
        })
    }

    /// As [`Self::offsets`], and `trace` then holds what the derivative needs.
    ///
    /// # Errors
    /// As [`Self::offsets`]; the trace is then one of no rows.
    pub fn trace(
        &self,
        positions: &[[f32; 3]],
        time: f32,
        trace: &mut Trace,
    ) -> Result<Offsets, DeformError> {
        trace.positions.clear();
        let offsets = self.answered(positions, time, |grid, outputs| {
            trace.blocks.resize_with(outputs.len(), Activations::default);
            let blocks = positions.par_chunks(BLOCK_ROWS).zip(outputs).zip(&mut trace.blocks);
            blocks.for_each(|((positions, outputs), block)| self.evaluate(grid, positions, block, outputs));
        })?;
        trace.positions.extend_from_slice(positions);
        trace.time = time;
        Ok(offsets)
    }

    /// Offsets of zero that `fill` writes, block by block.
    fn answered(
        &self,
        positions: &[[f32; 3]],
        time: f32,
        fill: impl FnOnce(&GridAt<'_>, Vec<SlicesMut<'_>>),
    ) -> Result<Offsets, DeformError> {
        self.check(positions, time)?;
        let mut offsets = self.config.zeros(positions.len());
        let blocks = positions.len().div_ceil(BLOCK_ROWS);
        fill(&self.grid_at(time), self.config.blocks_mut(&mut offsets, BLOCK_ROWS, blocks));
        match offsets.bad_value_of(self.config.outputs()) {
            Some(BadValue { field, index, value }) => Err(DeformError(format!(
                "row {index}: the offset of `{field}` is {value}: the parameters of the field have diverged; go back \
                 to an earlier checkpoint or train with lower learning rates"
            ))),
            None => Ok(offsets),
        }
    }

    /// The Gaussians at a time: those that `dynamic` names are changed by their offsets, the others stay.
    ///
    /// # Errors
    /// As [`Self::offsets`] and [`Gaussians::add_rows`].
    pub fn deformed(
        &self,
        canonical: &Gaussians,
        dynamic: &[u32],
        time: f32,
    ) -> Result<Gaussians, DeformError> {
        let count = canonical.len();
        let position = |(row, &index): (usize, &u32)| {
            canonical.means.get(index as usize).copied().ok_or_else(|| DeformError::row(row, index, count))
        };
        let positions: Vec<_> = dynamic.iter().enumerate().map(position).collect::<Result<_, _>>()?;
        let mut gaussians = canonical.clone();
        gaussians.add_rows(&self.offsets(&positions, time)?, dynamic)?;
        Ok(gaussians)
    }

    /// Gradients of zero.
    pub fn zero_gradients(&self) -> FieldGradients {
        FieldGradients { grid: Grid::zeros(&self.config), network: self.network.zeros_like() }
    }

    /// From the gradient of the offsets to those of the field's parameters, which are added to `gradients`, and those
    /// of the positions, which are returned (without the share that the Gaussians' centres have by themselves).
    ///
    /// # Errors
    /// Lists that do not fit the rows of the trace, and a gradient that is not finite; `gradients` is then unchanged.
    pub fn backward(
        &self,
        trace: &mut Trace,
        upstream: &Offsets,
        gradients: &mut FieldGradients,
    ) -> Result<Vec<[f32; 3]>, DeformError> {
        self.config.check_lengths(upstream, trace.positions.len())?;
        if let Some(BadValue { field, index, value }) = upstream.bad_value_of(self.config.outputs()) {
            return Err(DeformError(format!(
                "row {index}: the gradient of `{field}` is {value}: the loss or the rasterizer before it has diverged"
            )));
        }
        let Trace { time, positions, blocks, samples } = trace;
        let grid = self.grid_at(*time);
        // Rows without gradient are skipped: most Gaussians are outside of a picture or behind others.
        let rows = self.config.nonzero_rows(upstream, positions.len());
        let at: Vec<[f32; 3]> = rows.iter().map(|&row| positions[row as usize]).collect();
        let mut slopes = vec![[0.0; 3]; rows.len()];
        samples.resize(rows.len() * grid.sample_gradients(), 0.0);

        let blocks = blocks.as_slice();
        let lane_rows = rows.len().div_ceil(BLOCK_ROWS).div_ceil(MOST_LANES).max(1) * BLOCK_ROWS;
        let lanes: Vec<Network> = (rows.par_chunks(lane_rows), at.par_chunks(lane_rows))
            .into_par_iter()
            .zip(slopes.par_chunks_mut(lane_rows))
            .zip(samples.par_chunks_mut(lane_rows * grid.sample_gradients()))
            .map(|(((rows, at), slopes), samples)| {
                let mut sums = self.network.zeros_like();
                let (mut block, mut scratch) = (Activations::default(), Scratch::default());
                let mut features = Vec::new();
                let parts = rows.chunks(BLOCK_ROWS).zip(at.chunks(BLOCK_ROWS));
                let parts = parts.zip(slopes.chunks_mut(BLOCK_ROWS));
                for (((rows, at), slopes), samples) in
                    parts.zip(samples.chunks_mut(BLOCK_ROWS * grid.sample_gradients()))
                {
                    self.network.gather(blocks, BLOCK_ROWS, rows, &mut block);
                    let outputs = upstream.rows(self.config.sh_coefficients, rows);
                    features.resize(block.features.len(), 0.0);
                    self.network.backward(&block, outputs.flat(), &mut sums, &mut scratch, &mut features);
                    grid.backward(&self.bounds, at, &features, slopes, samples);
                }
                sums
            })
            .collect();
        for lane in &lanes {
            gradients.network.add(lane);
        }
        grid.scatter_add(&self.bounds, &at, samples, &mut gradients.grid);
        let mut all = vec![[0.0; 3]; positions.len()];
        for (&row, slope) in rows.iter().zip(slopes) {
            all[row as usize] = slope;
        }
        Ok(all)
    }

    /// All parameters, to be changed; lists are in the order of [`FieldGradients::lists`].
    pub fn parameters_mut(&mut self) -> Parameters<&mut [f32]> {
        Parameters {
            planes: self.grid.planes_mut().map(|plane| plane.texels.as_mut_slice()).collect(),
            layers: self.network.layers_mut().flat_map(|layer| layer.lists_mut()).collect(),
        }
    }

    pub(crate) fn planes(&self) -> impl Iterator<Item = &Plane> {
        self.grid.planes()
    }

    fn grid_at(&self, time: f32) -> GridAt<'_> {
        self.grid.at(self.config.time_axis.coordinate(time))
    }

    fn evaluate(
        &self,
        grid: &GridAt<'_>,
        positions: &[[f32; 3]],
        block: &mut Activations,
        outputs: SlicesMut<'_>,
    ) {
        block.features.resize(positions.len() * grid.features(), 0.0);
        grid.features_of(&self.bounds, positions, &mut block.features);
        self.network.forward(block, outputs);
    }

    fn check(&self, positions: &[[f32; 3]], time: f32) -> Result<(), DeformError> {
        if !(0.0..=1.0).contains(&time) {
            return Err(DeformError(format!(
                "time is {time}: must be from 0 (first frame) to 1 (last frame)"
            )));
        }
        let is_finite = |position: &[f32; 3]| position.iter().all(|value| value.is_finite());
        match positions.iter().position(|position| !is_finite(position)) {
            Some(row) => Err(DeformError::position(row, positions[row])),
            None => Ok(()),
        }
    }
}

impl FieldGradients {
    /// All derivatives; lists are in the order of [`DeformationField::parameters_mut`].
    pub fn lists(&self) -> Parameters<&[f32]> {
        Parameters {
            planes: self.grid.planes().map(|plane| plane.texels.as_slice()).collect(),
            layers: self.network.layers().flat_map(|layer| layer.lists()).collect(),
        }
    }

    pub(crate) fn planes_mut(&mut self) -> impl Iterator<Item = &mut Plane> {
        self.grid.planes_mut()
    }

    /// Sets all derivatives to zero, for the next step.
    pub fn clear(&mut self) {
        for plane in self.grid.planes_mut() {
            plane.texels.fill(0.0);
        }
        for list in self.network.layers_mut().flat_map(|layer| layer.lists_mut()) {
            list.fill(0.0);
        }
    }
}
