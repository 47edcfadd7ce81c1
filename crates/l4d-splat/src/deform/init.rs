//! How a field begins before it has learned anything.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::grid::Grid;
use super::network::Network;

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
    pub(super) fn fill(self, grid: &mut Grid, network: &mut Network, seed: u64) {
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
