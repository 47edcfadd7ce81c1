//! How a field learns: picture by picture from masks, or Gaussian by Gaussian from labels.
//!
//! Results have the same bytes for any number of threads: Gaussians are cut into blocks of a fixed size, and what is
//! summed over them is summed in a fixed order.

use std::sync::Arc;

use l4d_splat::optimise::{Adam, Group, GroupUpdate, LearningRate};
use l4d_splat::splats::Splats;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::active::{Rows, steep, visible};
use super::encoding::Places;
use super::network::{Collapsed, Ends, Network, Scratch};
use super::objective::{cross_entropy, divergence};
use super::settings::{DistilSettings, FieldSettings};
use super::{BLOCK_ROWS, Field, init};
use crate::lift::canvas::Canvas;
use crate::lift::error::LiftError;
use crate::lift::evidence::{Evidence, Picture};
use crate::lift::labels::Labels;
use crate::lift::progress::{Phase, Reporter};
use crate::lift::tree::Tree;

/// Lists of partial sums that a gradient is collected in, at most. A constant, not the number of threads: sums would
/// come out differently with other cuts.
const MOST_LANES: usize = 8;
/// Pixels whose losses are summed by one task.
const PIXELS: usize = 4096;

/// A field that explains the evidence.
pub(in crate::lift) fn learn(
    canvas: &Canvas<'_>,
    evidence: &Evidence,
    settings: &FieldSettings,
    report: &mut Reporter<'_>,
) -> Result<Field, LiftError> {
    settings.check()?;
    report.expect(settings.iterations as usize);
    let footage = Footage::new(canvas, evidence)?;
    let mut lesson = Lesson::new(footage, settings)?;
    for iteration in 0..settings.iterations {
        report.step(Phase::Learning)?;
        let loss = lesson.step(canvas, settings, iteration)?;
        report.loss(loss);
    }
    Ok(Field { network: lesson.learner.network, read_out: settings.read_out })
}

/// A field that says of each Gaussian at each clip time what labels say.
pub(in crate::lift) fn distil(
    canvas: &Canvas<'_>,
    labels: &Labels,
    settings: &DistilSettings,
    report: &mut Reporter<'_>,
) -> Result<Field, LiftError> {
    settings.field.check()?;
    report.expect(settings.field.iterations as usize);
    let means = &canvas.model.gaussians.means;
    let members: Vec<Vec<bool>> = labels.times.iter().map(|&time| labels.layer(time).members).collect();
    let inside: Vec<Vec<u32>> = members.iter().map(|members| places_of(members)).collect();
    let mut learner = Learner::new(means, &settings.field)?;
    let mut random = ChaCha8Rng::seed_from_u64(settings.field.seed ^ 1);
    let mut rows = Rows::new(means.len());
    for iteration in 0..settings.field.iterations {
        report.step(Phase::Learning)?;
        if means.is_empty() || labels.times.is_empty() {
            continue;
        }
        let time = random.random_range(0..labels.times.len());
        rows.clear();
        for turn in 0..settings.rows {
            // Half of them from the answer, which is a small part of the scene.
            let within = &inside[time];
            let row = if turn % 2 == 0 && !within.is_empty() {
                within[random.random_range(0..within.len())]
            } else {
                random.random_range(0..means.len() as u32)
            };
            rows.place(row);
        }
        let logits = learner.logits(labels.times[time], &rows.list);
        let (bias, share) = (f64::from(learner.network.bias()), 1.0 / rows.list.len() as f64);
        let (mut loss, mut bias_slope) = (0.0, 0.0);
        let told = logits.iter().zip(&rows.list).map(|(&logit, &row)| {
            let (one, slope) = cross_entropy(f64::from(logit) + bias, members[time][row as usize]);
            loss += share * one;
            bias_slope += share * slope;
            (share * slope) as f32
        });
        let slopes: Vec<f32> = told.collect();
        learner.descend(&rows.list, &slopes, bias_slope as f32, iteration)?;
        report.loss(loss);
    }
    Ok(Field { network: learner.network, read_out: settings.field.read_out })
}

fn places_of(members: &[bool]) -> Vec<u32> {
    (0..members.len() as u32).filter(|&row| members[row as usize]).collect()
}

/// Everything about the pictures that stays while the field learns.
pub(super) struct Footage<'a> {
    /// Clip times, each with the model's state and, once they were needed, the neighbours of all Gaussians.
    times: Vec<Time>,
    pictures: Vec<Shot<'a>>,
    means: &'a [[f32; 3]],
}

struct Time {
    time: f32,
    splats: Arc<Splats>,
    neighbours: Option<Vec<u32>>,
}

struct Shot<'a> {
    picture: Picture<'a>,
    /// Index of its time.
    time: usize,
    /// The mask, row-major.
    inside: Vec<bool>,
    /// Gaussians that show in it, once it was needed.
    visible: Option<Vec<u32>>,
}

impl<'a> Footage<'a> {
    pub(super) fn new(canvas: &Canvas<'a>, evidence: &'a Evidence) -> Result<Self, LiftError> {
        let (mut times, mut pictures) = (Vec::new(), Vec::new());
        for (time, instant) in evidence.instants()?.into_iter().enumerate() {
            let splats = canvas.shapes_at(instant.time)?;
            times.push(Time { time: instant.time, splats, neighbours: None });
            pictures.extend(instant.pictures.into_iter().map(|picture| Shot {
                picture,
                time,
                inside: picture.mask.to_bools(),
                visible: None,
            }));
        }
        Ok(Self { times, pictures, means: &canvas.model.gaussians.means })
    }
}

/// `count` neighbours a Gaussian (fewer where there are not so many Gaussians), in the deformed space; found once.
fn nearest<'n>(found: &'n mut Option<Vec<u32>>, splats: &Splats, count: usize) -> &'n [u32] {
    found.get_or_insert_with(|| {
        let nearest = Tree::new(splats.means().as_flattened(), 3).neighbours(count, true);
        nearest.iter().flatten().map(|&(_, index)| index).collect()
    })
}

/// A field on its way through the pictures.
pub(super) struct Lesson<'a> {
    footage: Footage<'a>,
    pub(super) learner: Learner,
    rows: Rows,
    random: ChaCha8Rng,
    /// Pictures still to come before all have been seen once more.
    queue: Vec<usize>,
    /// All Gaussians in some order, of which the first are drawn anew each step.
    shuffled: Vec<u32>,
}

impl<'a> Lesson<'a> {
    pub(super) fn new(footage: Footage<'a>, settings: &FieldSettings) -> Result<Self, LiftError> {
        let count = footage.means.len();
        Ok(Self {
            learner: Learner::new(footage.means, settings)?,
            rows: Rows::new(count),
            random: ChaCha8Rng::seed_from_u64(settings.seed),
            queue: Vec::new(),
            shuffled: (0..count as u32).collect(),
            footage,
        })
    }

    /// One step on the next picture; the loss before it.
    pub(super) fn step(
        &mut self,
        canvas: &Canvas<'_>,
        settings: &FieldSettings,
        iteration: u32,
    ) -> Result<f64, LiftError> {
        let picture = self.next_picture();
        let samples = self.samples(settings.sampled as usize);
        let (loss, slopes, bias_slope) = self.slopes(canvas, settings, picture, &samples)?;
        let slopes = match settings.left_out > 0.0 {
            true => self.keep_steep(&slopes, settings.left_out, picture),
            false => slopes,
        };
        self.descend(&slopes, bias_slope, iteration)?;
        Ok(loss)
    }

    /// Keeps the rows to which a picture says most, ready to learn; what it says.
    pub(super) fn keep_steep(&mut self, slopes: &[f32], left_out: f64, picture: usize) -> Vec<f32> {
        let time = self.footage.times[self.footage.pictures[picture].time].time;
        let kept = steep(slopes, left_out);
        let rows: Vec<u32> = kept.iter().map(|&place| self.rows.list[place as usize]).collect();
        self.rows.clear();
        rows.iter().for_each(|&row| {
            self.rows.place(row);
        });
        // What the backward pass goes through is that of the rows of the last evaluation.
        self.learner.logits(time, &rows);
        kept.iter().map(|&place| slopes[place as usize]).collect()
    }

    /// The gradient that [`Self::slopes`] mean.
    #[cfg(test)]
    pub(super) fn gradient(&mut self, slopes: &[f32], bias_slope: f32) -> &Network {
        self.learner.gradient(&self.rows.list, slopes, bias_slope)
    }

    /// One step of Adam down the [`Self::slopes`].
    pub(super) fn descend(
        &mut self,
        slopes: &[f32],
        bias_slope: f32,
        iteration: u32,
    ) -> Result<(), LiftError> {
        self.learner.descend(&self.rows.list, slopes, bias_slope, iteration)
    }

    /// Pictures in a new random order each time that all have been seen.
    pub(super) fn next_picture(&mut self) -> usize {
        if self.queue.is_empty() {
            self.queue = (0..self.footage.pictures.len()).collect();
            for last in (1..self.queue.len()).rev() {
                self.queue.swap(last, self.random.random_range(0..=last));
            }
        }
        self.queue.pop().unwrap_or(0)
    }

    /// Some Gaussians, each at most once.
    pub(super) fn samples(&mut self, count: usize) -> Vec<u32> {
        let count = count.min(self.shuffled.len());
        for place in 0..count {
            let other = self.random.random_range(place..self.shuffled.len());
            self.shuffled.swap(place, other);
        }
        self.shuffled[..count].to_vec()
    }

    /// Loss of a picture and of samples; its derivatives by the logits of `self.rows` and by the bias.
    pub(super) fn slopes(
        &mut self,
        canvas: &Canvas<'_>,
        settings: &FieldSettings,
        picture: usize,
        samples: &[u32],
    ) -> Result<(f64, Vec<f32>, f32), LiftError> {
        let Self { footage, learner, rows, .. } = self;
        let shot = &mut footage.pictures[picture];
        let time = &mut footage.times[shot.time];
        let count = footage.means.len();
        let view = shot.picture.view;
        let each = (settings.neighbours as usize).min(count);
        let neighbours = nearest(&mut time.neighbours, &time.splats, settings.neighbours as usize);
        let projected = canvas.rasterizer.prepare(&time.splats, view, canvas.raster)?;
        if shot.visible.is_none() {
            let weights = projected.gather_features(&vec![1.0; view.pixel_count()], 1)?;
            shot.visible = Some(visible(&weights));
        }
        rows.clear();
        for &row in shot.visible.iter().flatten() {
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

        let logits = learner.logits(time.time, &rows.list);
        let bias = learner.network.bias();
        let mut carried = vec![0.0; count];
        for (&row, &logit) in rows.list.iter().zip(&logits).take(shown) {
            carried[row as usize] = logit;
        }
        let blend = projected.splat_features(&carried, 1)?;
        let share = settings.lambda_2d * settings.normalisation.pixels() / view.pixel_count() as f64;
        let (mut loss, mut bias_slope, wanted) = pixels(&blend, bias, &shot.inside, share);
        let gathered = projected.gather_features(&wanted, 1)?;
        let mut slopes: Vec<f32> = vec![0.0; rows.list.len()];
        for (slope, &row) in slopes.iter_mut().zip(&rows.list).take(shown) {
            *slope = gathered[row as usize];
        }

        let share = settings.lambda_3d * settings.normalisation.neighbours() / pairs.len().max(1) as f64;
        for [of, from] in pairs {
            let logit = |place: usize| f64::from(logits[place]) + f64::from(bias);
            let (one, [by_of, by_from]) = divergence(logit(of), logit(from));
            loss += share * one;
            slopes[of] += (share * by_of) as f32;
            slopes[from] += (share * by_from) as f32;
            bias_slope += share * (by_of + by_from);
        }
        Ok((loss, slopes, bias_slope as f32))
    }
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

/// Network, optimiser and the room that a step needs.
pub(super) struct Learner {
    pub(super) network: Network,
    places: Places,
    adam: Adam,
    collapsed: Option<Collapsed>,
    blocks: Vec<Scratch>,
    lanes: Vec<(Network, Ends)>,
}

impl Learner {
    pub(super) fn new(means: &[[f32; 3]], settings: &FieldSettings) -> Result<Self, LiftError> {
        let (width, features) = (settings.width as usize, settings.features as usize);
        let network = init::network(width, features, settings.seed);
        let lengths: Vec<usize> = network.lists().iter().map(|list| list.len()).collect();
        let rate = LearningRate::constant(settings.learning_rate)
            .map_err(|source| LiftError::Learning { iteration: 0, source })?;
        let groups = vec![Group::new("identity field", rate, &lengths)];
        Ok(Self {
            places: Places::new(means),
            adam: Adam { groups },
            collapsed: None,
            blocks: Vec::new(),
            lanes: (0..MOST_LANES).map(|_| (Network::zeros(width, features), Ends::zeros(width))).collect(),
            network,
        })
    }

    /// Differences of logits, without the bias, of some Gaussians at a time.
    pub(super) fn logits(&mut self, time: f32, rows: &[u32]) -> Vec<f32> {
        let collapsed = Collapsed::new(&self.network, time);
        let mut logits = vec![0.0; rows.len()];
        let count = rows.len().div_ceil(BLOCK_ROWS);
        if self.blocks.len() < count {
            self.blocks.resize_with(count, Scratch::default);
        }
        let blocks = rows.par_chunks(BLOCK_ROWS).zip(logits.par_chunks_mut(BLOCK_ROWS)).zip(&mut self.blocks);
        blocks.for_each(|((rows, logits), block)| {
            collapsed.logits(&self.network, &self.places, rows, block, logits);
        });
        self.collapsed = Some(collapsed);
        logits
    }

    /// The gradient, given the derivatives by the logits that [`Self::logits`] gave last, and that by the bias.
    pub(super) fn gradient(&mut self, rows: &[u32], slopes: &[f32], bias: f32) -> &Network {
        let Self { network, collapsed, blocks, lanes, .. } = self;
        let Some(collapsed) = collapsed else { return &lanes[0].0 };
        let count = rows.len().div_ceil(BLOCK_ROWS);
        let lane_blocks = count.div_ceil(MOST_LANES).max(1);
        let work =
            blocks[..count].par_chunks_mut(lane_blocks).zip(slopes.par_chunks(lane_blocks * BLOCK_ROWS));
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
        collapsed.finish(network, ends, bias, gradient);
        gradient
    }

    /// One step of Adam.
    pub(super) fn descend(
        &mut self,
        rows: &[u32],
        slopes: &[f32],
        bias: f32,
        iteration: u32,
    ) -> Result<(), LiftError> {
        self.gradient(rows, slopes, bias);
        let gradients = self.lanes[0].0.lists().to_vec();
        let parameters = self.network.lists_mut().into_iter().map(Vec::as_mut_slice).collect();
        self.adam
            .step(u64::from(iteration), vec![GroupUpdate { parameters, gradients }])
            .map_err(|source| LiftError::Learning { iteration, source })
    }
}
