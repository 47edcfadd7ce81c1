//! How a network begins: weights of phi uniform by Xavier's rule (SA4D), all else as PyTorch's layers begin, uniform
//! within one over the root of the inputs.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::encoding::{PLACE, TIME};
use super::network::Network;

/// An untrained network; the same seed gives the same numbers.
pub(super) fn network(width: usize, features: usize, seed: u64) -> Network {
    let mut network = Network::zeros(width, features);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut fill = |list: &mut [f32], bound: f32| list.fill_with(|| random.random_range(-bound..bound));
    let xavier = |inputs: usize, outputs: usize| (6.0 / (inputs + outputs) as f32).sqrt();
    let one_over_root = |inputs: usize| 1.0 / (inputs as f32).sqrt();
    let inputs = PLACE + TIME;
    fill(&mut network.from_place, xavier(inputs, width));
    fill(&mut network.from_time, xavier(inputs, width));
    fill(&mut network.first_bias, one_over_root(inputs));
    for (weight, bias) in &mut network.hidden {
        fill(weight, xavier(width, width));
        fill(bias, one_over_root(width));
    }
    fill(&mut network.last, xavier(width, features));
    fill(&mut network.last_bias, one_over_root(width));
    fill(&mut network.decoder, one_over_root(features));
    fill(&mut network.decoder_bias, one_over_root(features));
    network
}
