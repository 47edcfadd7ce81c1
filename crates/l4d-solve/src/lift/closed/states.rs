//! When an answer changes: the clip cut into states within which every Gaussian keeps its label.
//!
//! Knows sums of votes and nothing else. Squared error of a constant label plus a price for every change, minimised
//! exactly over all ways to cut (optimal partitioning); pieces that hold the same then become one state.

use rayon::prelude::*;

use super::tally::Votes;

/// The state of each time: numbers from 0 in the order of their first appearance.
///
/// `change_price` is what one change costs, in units of the evidence of an ordinary time at which something is seen
/// (the blend weight inside all its masks).
pub(super) fn states(votes: &[Votes], change_price: f64) -> Vec<u32> {
    let sums = Sums::new(votes);
    let evidence: Vec<f64> = sums.inside_at.iter().copied().filter(|&inside| inside > 0.0).collect();
    if evidence.is_empty() {
        return vec![0; votes.len()];
    }
    let price = change_price * evidence.iter().sum::<f64>() / evidence.len() as f64;
    merge(&sums, &cut(&sums, price), price)
}

/// Running sums over time, for the Gaussians that any mask touches.
struct Sums {
    /// For each time and Gaussian, what has been summed before it.
    inside: Vec<Vec<f64>>,
    seen: Vec<Vec<f64>>,
    /// All Gaussians together, time by time.
    inside_at: Vec<f64>,
}

impl Sums {
    fn new(votes: &[Votes]) -> Self {
        let count = votes.first().map_or(0, |votes| votes.inside.len());
        let touched: Vec<usize> =
            (0..count).filter(|&index| votes.iter().any(|votes| votes.inside[index] > 0.0)).collect();
        let running = |of: fn(&Votes) -> &[f32]| {
            let mut sums = vec![vec![0.0; touched.len()]];
            for votes in votes {
                let before = &sums[sums.len() - 1];
                let values = of(votes);
                let next = before.iter().zip(&touched).map(|(sum, &index)| sum + f64::from(values[index]));
                let next = next.collect();
                sums.push(next);
            }
            sums
        };
        let inside_at = votes.iter().map(|votes| votes.inside.iter().map(|&value| f64::from(value)).sum());
        Self {
            inside: running(|votes| &votes.inside),
            seen: running(|votes| &votes.seen),
            inside_at: inside_at.collect(),
        }
    }

    fn times(&self) -> usize {
        self.inside_at.len()
    }

    /// Squared error that is left when each Gaussian has one label over all these pieces (first time, end).
    fn error(&self, pieces: &[(usize, usize)]) -> f64 {
        let total = |sums: &[Vec<f64>], index: usize| {
            pieces.iter().map(|&(first, end)| sums[end][index] - sums[first][index]).sum::<f64>()
        };
        (0..self.inside[0].len())
            .map(|index| {
                let (inside, seen) = (total(&self.inside, index), total(&self.seen, index));
                if seen > 0.0 { inside - inside * inside / seen } else { 0.0 }
            })
            .sum()
    }
}

/// Pieces (first time, end) that cost least.
fn cut(sums: &Sums, price: f64) -> Vec<(usize, usize)> {
    let times = sums.times();
    let errors: Vec<Vec<f64>> = (0..times)
        .into_par_iter()
        .map(|first| (first + 1..=times).map(|end| sums.error(&[(first, end)])).collect())
        .collect();
    // Least cost of the first times, and where the last of their pieces begins.
    let mut best: Vec<(f64, usize)> = vec![(0.0, 0)];
    for end in 1..=times {
        let mut least = (f64::INFINITY, 0);
        for first in 0..end {
            let change = if first == 0 { 0.0 } else { price };
            let cost = best[first].0 + change + errors[first][end - first - 1];
            if cost < least.0 {
                least = (cost, first);
            }
        }
        best.push(least);
    }
    let mut pieces = Vec::new();
    let mut end = times;
    while end > 0 {
        let first = best[end].1;
        pieces.push((first, end));
        end = first;
    }
    pieces.reverse();
    pieces
}

/// Pieces of one state together, as long as that costs less than the price of a change; the closest first.
fn merge(sums: &Sums, pieces: &[(usize, usize)], price: f64) -> Vec<u32> {
    let mut states: Vec<(f64, Vec<(usize, usize)>)> =
        pieces.iter().map(|&piece| (sums.error(&[piece]), vec![piece])).collect();
    loop {
        let mut closest: Option<(f64, usize, usize, f64)> = None;
        for a in 0..states.len() {
            for b in a + 1..states.len() {
                let together = sums.error(&[states[a].1.as_slice(), states[b].1.as_slice()].concat());
                let loss = together - states[a].0 - states[b].0;
                if loss < price && closest.is_none_or(|(least, ..)| loss < least) {
                    closest = Some((loss, a, b, together));
                }
            }
        }
        let Some((_, a, b, together)) = closest else { break };
        let (_, pieces) = states.remove(b);
        states[a].1.extend(pieces);
        states[a].0 = together;
    }
    let mut state_of = vec![0; sums.times()];
    for (state, (_, pieces)) in states.iter().enumerate() {
        for &(first, end) in pieces {
            state_of[first..end].fill(state as u32);
        }
    }
    state_of
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two Gaussians, the first of the object: `inside` of it at each time, seen 10 each.
    fn votes(inside: &[f32]) -> Vec<Votes> {
        inside.iter().map(|&inside| Votes { inside: vec![inside, 0.5], seen: vec![10.0, 10.0] }).collect()
    }

    #[test]
    fn what_stays_is_one_state_even_if_one_time_is_off_by_a_bit() {
        assert_eq!(states(&votes(&[6.0, 6.5, 6.0, 4.5, 6.0]), 0.1), [0; 5]);
    }

    #[test]
    fn what_is_there_for_a_while_has_two_states_however_often_it_returns() {
        assert_eq!(states(&votes(&[6.0, 6.0, 0.0, 0.0, 6.0, 5.0, 0.0]), 0.1), [0, 0, 1, 1, 0, 0, 1]);
        assert_eq!(states(&votes(&[0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.1)[3], 1);
    }

    #[test]
    fn changes_have_their_price() {
        assert_eq!(states(&votes(&[6.0, 6.0, 0.0, 0.0]), 10.0), [0; 4]);
    }

    #[test]
    fn a_time_at_which_nothing_is_seen_joins_its_neighbours() {
        let mut votes = votes(&[6.0, 6.0, 6.0]);
        votes[1] = Votes { inside: vec![0.0, 0.5], seen: vec![0.0, 10.0] };
        assert_eq!(states(&votes, 0.1), [0; 3]);
    }

    #[test]
    fn no_evidence_is_one_state() {
        assert_eq!(states(&votes(&[0.0, 0.0])[..0], 0.1), [0; 0]);
        let nothing = vec![Votes { inside: vec![0.0], seen: vec![1.0] }; 3];
        assert_eq!(states(&nothing, 0.1), [0; 3]);
    }
}
