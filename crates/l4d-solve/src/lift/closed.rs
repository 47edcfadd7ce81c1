//! The closed form: labels of Gaussians straight from the sums of what pixels say, without a network.
//!
//! With geometry frozen a picture of labels is linear in them, m = A s with A the blend weights. A^T m over A^T 1 is
//! the vote of the pixels that a Gaussian shows in; steps of SIRT, s += A^T (m - A s) / A^T 1, take out what a vote
//! mixes in from whatever shows in the same pixels; a graph of Gaussians that stay together carries labels to where
//! no view looked. What is there for a part of the clip is found beforehand, from how votes change with time.

mod graph;
mod states;
mod tally;
mod threshold;

use std::sync::Arc;

use l4d_splat::splats::Splats;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::{LiftError, check_ranges};
use super::evidence::{Evidence, TimeEvidence};
use super::labels::Labels;
use super::rendered_model::RenderedModel;
use graph::Graph;
use tally::Votes;

/// Times at which trajectories are compared, at most.
const TRAJECTORY_TIMES: u32 = 5;
/// Gaussians that show less than this in all pictures together have no say, pixels.
const UNSEEN: f32 = 1e-3;

/// How labels are found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClosedSettings {
    /// Steps of SIRT after the vote.
    pub steps: u32,
    /// Clip times of which the pictures are used by each step, at most; all vote.
    pub step_times: u32,
    /// How much neighbours pull on each other after each step (and after the vote); 0 for no graph.
    pub smoothness: f32,
    /// Neighbours of a Gaussian in the graph.
    pub neighbours: u32,
    /// Price of a change with time, in units of the evidence (blend weight inside the masks) of an ordinary time.
    pub change_price: f64,
    /// Clip times of which the pictures choose the threshold, at most.
    pub threshold_times: u32,
}

impl ClosedSettings {
    pub fn robust() -> Self {
        Self {
            steps: 2,
            step_times: 12,
            smoothness: 1.0,
            neighbours: 8,
            change_price: 0.1,
            threshold_times: 6,
        }
    }

    /// The vote alone.
    pub fn vote() -> Self {
        Self { steps: 0, smoothness: 0.0, ..Self::robust() }
    }

    fn check(&self) -> Result<(), LiftError> {
        check_ranges([
            ("steps", f64::from(self.steps), 0.0..=100.0, "0 to 100 steps"),
            ("step_times", f64::from(self.step_times), 1.0..=f64::MAX, "at least 1"),
            ("smoothness", f64::from(self.smoothness), 0.0..=1e6, "0 to 1e6"),
            ("neighbours", f64::from(self.neighbours), 1.0..=64.0, "1 to 64 neighbours"),
            ("change_price", self.change_price, 0.0..=1e6, "0 to 1e6"),
            ("threshold_times", f64::from(self.threshold_times), 1.0..=f64::MAX, "at least 1"),
        ])
    }
}

/// Labels that explain the evidence.
pub(super) fn labels(
    rendered: &RenderedModel<'_>,
    evidence: &Evidence,
    settings: &ClosedSettings,
) -> Result<Labels, LiftError> {
    settings.check()?;
    let instants = evidence.instants()?;
    let (mut votes, mut shapes) = (Vec::new(), Vec::new());
    for instant in &instants {
        let splats = rendered.shapes_at(instant.time)?;
        votes.push(tally::votes(rendered, &splats, instant)?);
        shapes.push(splats);
    }
    let state_of = states::states(&votes, settings.change_price);
    let step_times = step_times(&votes, &state_of, settings.step_times);
    let threshold_times = threshold_times(&instants, settings.threshold_times);
    let mut solution = Solution::new(&votes, &state_of);
    let graph = (settings.smoothness > 0.0).then(|| graph_of(&shapes, settings));
    solution.smooth(graph.as_ref(), settings.smoothness);
    for _ in 0..settings.steps {
        let (mut rests, mut seen) = (solution.zeros(), solution.zeros());
        for &time in &step_times {
            let state = state_of[time] as usize;
            let rest = tally::residual(rendered, &shapes[time], &instants[time], solution.at(time))?;
            add(&mut rests[state], &rest);
            add(&mut seen[state], &votes[time].seen);
        }
        solution.pull(&rests, &seen);
        solution.smooth(graph.as_ref(), settings.smoothness);
    }
    let mut fit = threshold::Fit::default();
    for &time in &threshold_times {
        fit.add(rendered, &shapes[time], &instants[time], solution.at(time))?;
    }
    Ok(Labels {
        times: instants.iter().map(|instant| instant.time).collect(),
        states: solution.states,
        state_of,
        threshold: fit.best(),
    })
}

/// Times of the states in which something is meant; the labels of the others are 0 and stay so. Each state has its
/// share of `most`, but a few at least.
fn step_times(votes: &[Votes], state_of: &[u32], most: u32) -> Vec<usize> {
    const FEW: u32 = 4;
    let states = state_of.iter().max().map_or(0, |&last| last + 1);
    let mut times = Vec::new();
    for state in 0..states {
        let own: Vec<usize> = (0..votes.len()).filter(|&time| state_of[time] == state).collect();
        if own.iter().any(|&time| votes[time].inside.iter().any(|&inside| inside > 0.0)) {
            let share = u64::from(most) * own.len() as u64 / votes.len().max(1) as u64;
            let taken = (share as u32).max(FEW.min(most));
            times.extend(spread_over(own.len(), taken).into_iter().map(|index| own[index]));
        }
    }
    times
}

/// At most `most` of the times at which a mask shows something.
fn threshold_times(instants: &[TimeEvidence<'_>], most: u32) -> Vec<usize> {
    let shows = |instant: &TimeEvidence<'_>| instant.pictures.iter().any(|picture| !picture.mask.is_empty());
    let shown: Vec<usize> = (0..instants.len()).filter(|&time| shows(&instants[time])).collect();
    spread_over(shown.len(), most).into_iter().map(|index| shown[index]).collect()
}

/// At most `most` of `count` indices, ends included, evenly spread.
fn spread_over(count: usize, most: u32) -> Vec<usize> {
    let taken = count.min(most as usize);
    match taken {
        0 => Vec::new(),
        1 => vec![count / 2],
        _ => (0..taken).map(|index| index * (count - 1) / (taken - 1)).collect(),
    }
}

fn graph_of(shapes: &[Arc<Splats>], settings: &ClosedSettings) -> Graph {
    let times = spread_over(shapes.len(), TRAJECTORY_TIMES);
    let count = shapes.first().map_or(0, |splats| splats.len());
    let places: Vec<f32> = (0..count)
        .into_par_iter()
        .flat_map_iter(|index| times.iter().flat_map(move |&time| shapes[time].means()[index]))
        .collect();
    Graph::new(&places, 3 * times.len(), settings.neighbours as usize)
}

/// Labels so far.
struct Solution<'a> {
    state_of: &'a [u32],
    states: Vec<Vec<f32>>,
    /// How much each state saw of each Gaussian, pixels.
    seen: Vec<Vec<f32>>,
}

impl<'a> Solution<'a> {
    fn new(votes: &[Votes], state_of: &'a [u32]) -> Self {
        let count = votes.first().map_or(0, |votes| votes.inside.len());
        let states = state_of.iter().max().map_or(0, |&last| last as usize + 1);
        let (mut inside, mut seen) = (vec![vec![0.0; count]; states], vec![vec![0.0; count]; states]);
        for (votes, &state) in votes.iter().zip(state_of) {
            add(&mut inside[state as usize], &votes.inside);
            add(&mut seen[state as usize], &votes.seen);
        }
        for (inside, seen) in inside.iter_mut().zip(&seen) {
            for (inside, &seen) in inside.iter_mut().zip(seen) {
                *inside = if seen > UNSEEN { (*inside / seen).clamp(0.0, 1.0) } else { 0.0 };
            }
        }
        Self { state_of, states: inside, seen }
    }

    fn at(&self, time: usize) -> &[f32] {
        &self.states[self.state_of[time] as usize]
    }

    /// A zero for each state and Gaussian.
    fn zeros(&self) -> Vec<Vec<f32>> {
        self.states.iter().map(|labels| vec![0.0; labels.len()]).collect()
    }

    /// One step of SIRT: adds what the masks hold beyond the blend of the labels, by how much was seen.
    fn pull(&mut self, rests: &[Vec<f32>], seen: &[Vec<f32>]) {
        for ((labels, rests), seen) in self.states.iter_mut().zip(rests).zip(seen) {
            for ((label, rest), &seen) in labels.iter_mut().zip(rests).zip(seen) {
                if seen > UNSEEN {
                    *label = (*label + rest / seen).clamp(0.0, 1.0);
                }
            }
        }
    }

    fn smooth(&mut self, graph: Option<&Graph>, strength: f32) {
        let Some(graph) = graph else { return };
        for (labels, seen) in self.states.iter_mut().zip(&self.seen) {
            // Nothing spreads where there is nothing.
            if labels.iter().all(|&label| label == 0.0) {
                continue;
            }
            let mut visible: Vec<f32> = seen.iter().copied().filter(|&seen| seen > UNSEEN).collect();
            visible.sort_unstable_by(f32::total_cmp);
            let median = visible.get(visible.len() / 2).copied().unwrap_or(1.0);
            let trust: Vec<f32> = seen.iter().map(|&seen| seen / median).collect();
            *labels = graph.smooth(labels, &trust, strength);
        }
    }
}

fn add(sums: &mut [f32], values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}
