//! Gaussians that stay together should be labelled alike.
//!
//! Owns the graph of nearest neighbours over trajectories and the smoothing on it. Knows no pixels.

use l4d_splat::neighbours::Tree;
use rayon::prelude::*;

/// Steps of conjugate gradients at most.
const MOST_STEPS: usize = 30;
/// What is left of the residual when they end, relative.
const ENOUGH: f64 = 1e-4;

/// A weighted, undirected graph.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Graph {
    /// Edges of Gaussian i: `edges[starts[i]..starts[i + 1]]`.
    starts: Vec<usize>,
    /// The other end, and the weight, 0 to 1.
    edges: Vec<(u32, f32)>,
}

impl Graph {
    /// Of `neighbours` nearest neighbours each. `places` holds one row of coordinates a Gaussian, all times one after
    /// the other, metres: two are near if they are so at all times.
    pub(super) fn new(places: &[f32], axes: usize, neighbours: usize) -> Self {
        let nearest = Tree::new(places, axes).neighbours(neighbours, false);
        let mut distances: Vec<f32> = nearest.iter().flatten().map(|&(squared, _)| squared.sqrt()).collect();
        distances.sort_unstable_by(f32::total_cmp);
        let Some(&median) = distances.get(distances.len() / 2) else { return Self::default() };
        // Points on one spot have no distance to measure with.
        let width = f64::from(median).max(1e-9);
        let weight = |squared: f32| (-0.5 * f64::from(squared) / (width * width)).exp() as f32;
        let mut pairs: Vec<(u32, u32, f32)> = Vec::with_capacity(2 * distances.len());
        for (index, nearest) in nearest.iter().enumerate() {
            for &(squared, other) in nearest {
                let weight = weight(squared);
                pairs.extend([(index as u32, other, weight), (other, index as u32, weight)]);
            }
        }
        pairs.par_sort_unstable_by_key(|&(from, to, _)| (from, to));
        pairs.dedup_by_key(|&mut (from, to, _)| (from, to));
        let mut starts = vec![0; nearest.len() + 1];
        for &(from, ..) in &pairs {
            starts[from as usize + 1] += 1;
        }
        for index in 1..starts.len() {
            starts[index] += starts[index - 1];
        }
        Self { starts, edges: pairs.into_iter().map(|(_, to, weight)| (to, weight)).collect() }
    }

    /// The labels s that minimise sum a_i (s_i - z_i)^2 + strength * sum g_ij (s_i - s_j)^2 over edges, with z
    /// `labels` and a `trust`.
    pub(super) fn smooth(&self, labels: &[f32], trust: &[f32], strength: f32) -> Vec<f32> {
        if self.edges.is_empty() || strength == 0.0 {
            return labels.to_vec();
        }
        // Where no view is trusted the system has no unique solution; a trace of trust keeps labels where they are.
        let trust: Vec<f64> = trust.iter().map(|&trust| f64::from(trust).max(1e-6)).collect();
        let wide: Vec<f64> = labels.iter().map(|&label| f64::from(label)).collect();
        let scale: Vec<f64> = (0..labels.len())
            .map(|index| {
                let degree: f64 = self.of(index).iter().map(|&(_, weight)| f64::from(weight)).sum();
                1.0 / (trust[index] + f64::from(strength) * degree)
            })
            .collect();
        let system = |values: &[f64]| -> Vec<f64> {
            (0..values.len())
                .into_par_iter()
                .with_min_len(1024)
                .map(|index| {
                    let apart = |&(other, weight): &(u32, f32)| {
                        f64::from(weight) * (values[index] - values[other as usize])
                    };
                    let pulls: f64 = self.of(index).iter().map(apart).sum();
                    trust[index] * values[index] + f64::from(strength) * pulls
                })
                .collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut solution = wide.clone();
        let mut residual: Vec<f64> = system(&solution);
        for ((rest, trust), label) in residual.iter_mut().zip(&trust).zip(&wide) {
            *rest = trust * label - *rest;
        }
        let conditioned =
            |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&scale).map(|(r, s)| r * s).collect() };
        let mut direction = conditioned(&residual);
        let mut power = dot(&residual, &direction);
        let first = power;
        for _ in 0..MOST_STEPS {
            if power <= ENOUGH * ENOUGH * first || power <= f64::MIN_POSITIVE {
                break;
            }
            let pushed = system(&direction);
            let step = power / dot(&direction, &pushed);
            for ((value, rest), (way, pushed)) in
                solution.iter_mut().zip(&mut residual).zip(direction.iter().zip(&pushed))
            {
                *value += step * way;
                *rest -= step * pushed;
            }
            let next = conditioned(&residual);
            let stronger = dot(&residual, &next);
            for (way, next) in direction.iter_mut().zip(next) {
                *way = next + stronger / power * *way;
            }
            power = stronger;
        }
        solution.into_iter().map(|value| value as f32).collect()
    }

    fn of(&self, index: usize) -> &[(u32, f32)] {
        &self.edges[self.starts[index]..self.starts[index + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_solves_the_system_by_hand() {
        // Two points: s0 = z0 - k (s0 - s1) / a0, s1 = z1 + k (s0 - s1) / a1, with g = exp(-1/2).
        let graph = Graph::new(&[0.0, 2.0], 1, 3);
        let smooth = graph.smooth(&[1.0, 0.0], &[2.0, 1.0], 3.0);
        let pull = 3.0 * (-0.5_f32).exp();
        // 2 (s0 - 1) + pull (s0 - s1) = 0 and s1 - pull (s0 - s1) = 0.
        let apart = 1.0 / (1.0 + pull / 2.0 + pull);
        assert!((smooth[0] - smooth[1] - apart).abs() < 1e-5, "{smooth:?}");
        assert!((smooth[1] - pull * apart).abs() < 1e-5, "{smooth:?}");
    }

    #[test]
    fn what_nobody_saw_takes_the_label_of_its_neighbours() {
        let graph = Graph::new(&[0.0, 1.0, 2.0, 50.0], 1, 1);
        let smooth = graph.smooth(&[1.0, 0.0, 1.0, 0.0], &[1.0, 0.0, 1.0, 1.0], 1.0);
        assert!(smooth[1] > 0.99 && smooth[3] < 0.01, "{smooth:?}");
    }

    #[test]
    fn nothing_and_points_on_one_spot_are_fine() {
        assert!(Graph::new(&[], 3, 8).smooth(&[], &[], 1.0).is_empty());
        let graph = Graph::new(&[1.0; 6], 3, 8);
        assert_eq!(graph.smooth(&[0.25, 0.25], &[1.0, 1.0], 1.0), [0.25, 0.25]);
        assert!(graph.smooth(&[0.0, 1.0], &[1.0; 2], 1.0).iter().all(|value| value.is_finite()));
    }
}
