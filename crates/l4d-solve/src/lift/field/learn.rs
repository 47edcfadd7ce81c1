//! How a field learns, picture by picture, from masks.
//!
//! Results have the same bytes for any number of threads: Gaussians are cut into blocks of a fixed size, and what is
//! summed over them is summed in a fixed order.

use std::sync::Arc;

use l4d_splat::neighbours::Tree;
use l4d_splat::optimise::{Adam, Group, GroupUpdate, LearningRate};
use l4d_splat::splats::Splats;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::FieldSettings;
use super::encoding::Places;
use super::network::{BLOCK_ROWS, Collapsed, Ends, Network, Scratch};
use super::objective::{cross_entropy, divergence};
use crate::lift::error::LiftError;
use crate::lift::evidence::{Evidence, Picture};
use crate::lift::rendered_model::RenderedModel;

/// Lists of partial sums that a gradient is collected in, at most. A constant, not the number of threads: sums would
/// come out differently with other cuts.
const MOST_LANES: usize = 8;
/// Pixels whose losses are summed by one task.
const PIXELS: usize = 4096;

/// A field that explains the evidence.
pub(in crate::lift) fn learn(
    rendered: &RenderedModel<'_>,
    evidence: &Evidence,
    settings: &FieldSettings,
) -> Result<Network, LiftError> {
    settings.check()?;
    let mut training = Training::new(rendered, evidence, settings)?;
    for iteration in 0..settings.iterations {
        let picture = training.next_picture();
        let samples = training.samples();
        let (_, slopes) = training.slopes(picture, &samples)?;
        training.descend(&slopes, iteration)?;
    }
    Ok(training.network)
}

/// A clip time with the model's state and, once they were needed, the neighbours of all Gaussians.
struct Time {
    time: f32,
    splats: Arc<Splats>,
    neighbours: Option<Vec<u32>>,
}

struct TrainingPicture<'a> {
    picture: Picture<'a>,
    /// Index of its time.
    time: usize,
    /// The mask, row-major.
    inside: Vec<bool>,
    /// Gaussians that show in it, ascending, once it was needed. The others change neither its loss nor any
    /// derivative: leaving them out is exact.
    visible: Option<Vec<u32>>,
}

/// Derivatives of the loss by the logits of the rows of a step, and by the bias.
pub(super) struct LogitGradients {
    pub(super) rows: Vec<f32>,
    pub(super) bias: f32,
}

/// A field on its way through the pictures.
pub(super) struct Training<'a> {
    rendered: &'a RenderedModel<'a>,
    settings: &'a FieldSettings,
    times: Vec<Time>,
    pictures: Vec<TrainingPicture<'a>>,
    /// Pictures still to come before all have been seen once more.
    queue: Vec<usize>,
    /// All Gaussians in some order, of which the first are drawn anew each step.
    shuffled: Vec<u32>,
    random: ChaCha8Rng,
    rows: Rows,
    pub(super) network: Network,
    places: Places,
    adam: Adam,
    collapsed: Collapsed,
    blocks: Vec<Scratch>,
    lanes: Vec<(Network, Ends)>,
}

impl<'a> Training<'a> {
    pub(super) fn new(
        rendered: &'a RenderedModel<'a>,
        evidence: &'a Evidence,
        settings: &'a FieldSettings,
    ) -> Result<Self, LiftError> {
        let (mut times, mut pictures) = (Vec::new(), Vec::new());
        for (time, instant) in evidence.instants()?.into_iter().enumerate() {
            let splats = rendered.shapes_at(instant.time)?;
            times.push(Time { time: instant.time, splats, neighbours: None });
            pictures.extend(instant.pictures.into_iter().map(|picture| TrainingPicture {
                picture,
                time,
                inside: picture.mask.to_bools(),
                visible: None,
            }));
        }
        let (width, features) = (settings.width as usize, settings.features as usize);
        let network = Network::untrained(width, features, settings.seed);
        let lengths: Vec<usize> = network.lists.iter().map(Vec::len).collect();
        let rate = LearningRate::constant(settings.learning_rate)
            .map_err(|source| LiftError::Learning { iteration: 0, source })?;
        let means = &rendered.model.gaussians.means;
        Ok(Self {
            rendered,
            settings,
            times,
            pictures,
            queue: Vec::new(),
            shuffled: (0..means.len() as u32).collect(),
            random: ChaCha8Rng::seed_from_u64(settings.seed),
            rows: Rows::new(means.len()),
            places: Places::new(means),
            adam: Adam { groups: vec![Group::new("identity field", rate, &lengths)] },
            collapsed: Collapsed::new(&network, 0.0),
            blocks: Vec::new(),
            lanes: (0..MOST_LANES).map(|_| (Network::zeros(width, features), Ends::zeros(width))).collect(),
            network,
        })
    }

    /// Pictures in a new random order each time that all have been seen.
    pub(super) fn next_picture(&mut self) -> usize {
        if self.queue.is_empty() {
            self.queue = (0..self.pictures.len()).collect();
            for last in (1..self.queue.len()).rev() {
                self.queue.swap(last, self.random.random_range(0..=last));
            }
        }
        self.queue.pop().unwrap_or(0)
    }

    /// Some Gaussians, each at most once.
    pub(super) fn samples(&mut self) -> Vec<u32> {
        let count = (self.settings.sampled as usize).min(self.shuffled.len());
        for place in 0..count {
            let other = self.random.random_range(place..self.shuffled.len());
            self.shuffled.swap(place, other);
        }
        self.shuffled[..count].to_vec()
    }

    /// Loss of a picture and of samples, and its derivatives by the logits of `self.rows` and by the bias.
    pub(super) fn slopes(
        &mut self,
        picture: usize,
        samples: &[u32],
    ) -> Result<(f64, LogitGradients), LiftError> {
        let Self { rendered, settings, rows, pictures, times, .. } = self;
        let training_picture = &mut pictures[picture];
        let Time { time, splats, neighbours } = &mut times[training_picture.time];
        let (time, splats, view) = (*time, Arc::clone(splats), training_picture.picture.view);
        let neighbours = nearest(neighbours, &splats, settings.neighbours as usize);
        let each = (settings.neighbours as usize).min(splats.len());
        let projected = rendered.rasterizer.prepare(&splats, view, rendered.raster)?;
        if training_picture.visible.is_none() {
            let weights = projected.gather_features(&vec![1.0; view.pixel_count()], 1)?;
            let shows = |row: &u32| weights[*row as usize] > 0.0;
            training_picture.visible = Some((0..weights.len() as u32).filter(shows).collect());
        }
        rows.clear();
        for &row in training_picture.visible.iter().flatten() {
            rows.place(row);
        }
        let shown = rows.list.len();
        let pairs: Vec<[usize; 2]> = samples
            .iter()
            .flat_map(|&sample| {
                let near = &neighbours[sample as usize * each..][..each];
                near.iter().map(move |&near| [sample, near])
            })
            .map(|pair| pair.map(|row| rows.place(row)))
            .collect();

        let logits = self.logits(time);
        let bias = self.network.bias();
        let mut carried = vec![0.0; splats.len()];
        for (&row, &logit) in self.rows.list.iter().zip(&logits).take(shown) {
            carried[row as usize] = logit;
        }
        let blend = projected.splat_features(&carried, 1)?;
        let share = self.settings.lambda_2d / view.pixel_count() as f64;
        let (mut loss, mut bias_slope, wanted) = pixels(&blend, bias, &self.pictures[picture].inside, share);
        let gathered = projected.gather_features(&wanted, 1)?;
        let mut slopes: Vec<f32> = vec![0.0; self.rows.list.len()];
        for (slope, &row) in slopes.iter_mut().zip(&self.rows.list).take(shown) {
            *slope = gathered[row as usize];
        }

        let share = self.settings.lambda_3d / pairs.len().max(1) as f64;
        for [of, from] in pairs {
            let logit = |place: usize| f64::from(logits[place]) + f64::from(bias);
            let (one, [by_of, by_from]) = divergence(logit(of), logit(from));
            loss += share * one;
            slopes[of] += (share * by_of) as f32;
            slopes[from] += (share * by_from) as f32;
            bias_slope += share * (by_of + by_from);
        }
        Ok((loss, LogitGradients { rows: slopes, bias: bias_slope as f32 }))
    }

    /// Differences of logits, without the bias, of `self.rows` at a time.
    fn logits(&mut self, time: f32) -> Vec<f32> {
        self.collapsed = Collapsed::new(&self.network, time);
        let Self { collapsed, network, places, blocks, rows, .. } = self;
        let mut logits = vec![0.0; rows.list.len()];
        let count = rows.list.len().div_ceil(BLOCK_ROWS);
        if blocks.len() < count {
            blocks.resize_with(count, Scratch::default);
        }
        rows.list.par_chunks(BLOCK_ROWS).zip(logits.par_chunks_mut(BLOCK_ROWS)).zip(blocks).for_each(
            |((rows, logits), block)| {
                collapsed.logits(network, places, rows, block, logits);
            },
        );
        logits
    }

    /// The gradient that the derivatives of the last [`Self::slopes`] mean.
    pub(super) fn gradient(&mut self, slopes: &LogitGradients) -> &Network {
        let Self { network, collapsed, blocks, lanes, .. } = self;
        let count = slopes.rows.len().div_ceil(BLOCK_ROWS);
        let lane_blocks = count.div_ceil(MOST_LANES).max(1);
        let work =
            blocks[..count].par_chunks_mut(lane_blocks).zip(slopes.rows.par_chunks(lane_blocks * BLOCK_ROWS));
        let used = work.len().max(1);
        for (gradient, ends) in lanes.iter_mut().take(used) {
            gradient.clear();
            ends.clear();
        }
        work.zip(lanes.par_iter_mut()).for_each(|((blocks, slopes), (gradient, ends))| {
            for (block, slopes) in blocks.iter_mut().zip(slopes.chunks(BLOCK_ROWS)) {
                collapsed.backward(network, block, slopes, gradient, ends);
            }
        });
        let (first, others) = lanes.split_at_mut(1);
        for (gradient, ends) in others.iter().take(used - 1) {
            first[0].0.add(gradient);
            first[0].1.add(ends);
        }
        let (gradient, ends) = &mut first[0];
        collapsed.finish(network, ends, slopes.bias, gradient);
        gradient
    }

    /// One step of Adam down the derivatives of the last [`Self::slopes`].
    pub(super) fn descend(&mut self, slopes: &LogitGradients, iteration: u32) -> Result<(), LiftError> {
        self.gradient(slopes);
        let gradients = self.lanes[0].0.lists.iter().map(Vec::as_slice).collect();
        let parameters = self.network.lists.iter_mut().map(Vec::as_mut_slice).collect();
        self.adam
            .step(u64::from(iteration), vec![GroupUpdate { parameters, gradients }])
            .map_err(|source| LiftError::Learning { iteration, source })
    }
}

/// `count` neighbours a Gaussian (fewer where there are not so many Gaussians), in the deformed space; found once.
fn nearest<'n>(found: &'n mut Option<Vec<u32>>, splats: &Splats, count: usize) -> &'n [u32] {
    found.get_or_insert_with(|| {
        let nearest = Tree::new(splats.means().as_flattened(), 3).neighbours(count, true);
        nearest.iter().flatten().map(|&(_, index)| index).collect()
    })
}

/// Cross-entropy of all pixels times `share`, its derivative by the bias, and those by the pixels' logits.
fn pixels(blend: &[f32], bias: f32, inside: &[bool], share: f64) -> (f64, f64, Vec<f32>) {
    let mut wanted = vec![0.0; blend.len()];
    let sums: Vec<(f64, f64)> = blend
        .par_chunks(PIXELS)
        .zip(inside.par_chunks(PIXELS))
        .zip(wanted.par_chunks_mut(PIXELS))
        .map(|((blend, inside), wanted)| {
            let mut sums = (0.0, 0.0);
            for ((&blend, &inside), wanted) in blend.iter().zip(inside).zip(wanted) {
                let (loss, slope) = cross_entropy(f64::from(blend) + f64::from(bias), inside);
                sums.0 += loss;
                sums.1 += slope;
                *wanted = (share * slope) as f32;
            }
            sums
        })
        .collect();
    let loss = sums.iter().map(|sums| sums.0).sum::<f64>();
    let slope = sums.iter().map(|sums| sums.1).sum::<f64>();
    (share * loss, share * slope, wanted)
}

/// Rows of one step without repetition, and where each Gaussian stands among them.
#[derive(Debug)]
struct Rows {
    /// The Gaussians, in the order in which they were first asked for.
    list: Vec<u32>,
    places: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Rows {
    fn new(gaussians: usize) -> Self {
        Self { list: Vec::new(), places: vec![ABSENT; gaussians] }
    }

    fn clear(&mut self) {
        for &row in &self.list {
            self.places[row as usize] = ABSENT;
        }
        self.list.clear();
    }

    /// Where a Gaussian stands; a new one is added.
    fn place(&mut self, gaussian: u32) -> usize {
        let place = &mut self.places[gaussian as usize];
        if *place == ABSENT {
            *place = self.list.len() as u32;
            self.list.push(gaussian);
        }
        *place as usize
    }
}
